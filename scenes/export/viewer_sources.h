#pragma once

#include <string_view>

namespace taut {

/// The text of a file of scenes/export/viewer, which the build puts into the program; empty if there is none.
std::string_view viewer_source(std::string_view name);

}  // namespace taut
