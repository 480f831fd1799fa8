#pragma once

#include <string>
#include <string_view>

namespace taut {

/// A name for formats that take no control characters, as XML: they become their pictures, U+2400 … U+2421,
/// and what is not UTF-8 or no character becomes U+FFFD.
std::string printable(std::string_view text);

/// These bytes as a string of gnuplot, quoted: what would end it or be run is an octal number.
std::string gnuplot_quoted(std::string_view text);

}  // namespace taut
