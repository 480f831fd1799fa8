#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace taut {

/// [RFC 4648], with padding and without line breaks.  (The libraries at hand have it only as a by-product.)
std::string base64(std::string_view bytes);
/// The bytes; none if the text is not such.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace taut
