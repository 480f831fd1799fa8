#include "scenes/support/printable.h"

#include <algorithm>
#include <cstddef>

#include "scenes/support/format.h"

namespace taut {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

unsigned byte_of(std::string_view text, std::size_t i) {
  return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
}

/// Bytes that a character with this first one has; 0: none begins so.
std::size_t length_by_first(unsigned first) {
  if (first < 0x80) return 1;
  if (first < 0xC2) return 0;
  return first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
}

/// Not what the first bytes of several stand for: it has a shorter form, is half a pair of UTF-16, is above
/// U+10FFFF, or is U+FFFE or U+FFFF.
bool is_forbidden(unsigned first, unsigned second, unsigned third) {
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool surrogate = first == 0xED && second >= 0xA0;
  const bool beyond = first > 0xF4 || (first == 0xF4 && second >= 0x90);
  const bool no_character = first == 0xEF && second == 0xBF && third >= 0xBE;
  return overlong || surrogate || beyond || no_character;
}

/// Bytes of the character that the text begins with; 0: it is none [RFC 3629].
std::size_t character_length(std::string_view text) {
  const unsigned first = byte_of(text, 0);
  const std::size_t length = length_by_first(first);
  if (length <= 1) return length;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte_of(text, i) & 0xC0) != 0x80) return 0;
  return is_forbidden(first, byte_of(text, 1), byte_of(text, 2)) ? 0 : length;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const auto first = static_cast<unsigned char>(text.front());
    if (length == 0)
      result += kReplacement;
    else if (first < 0x20 || first == 0x7F)
      result += {'\xE2', '\x90', static_cast<char>(first == 0x7F ? 0xA1 : 0x80 + first)};
    else
      result += text.substr(0, length);
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return result;
}

std::string gnuplot_quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = byte >= 0x20 && byte != 0x7F && c != '"' && c != '\\' && c != '`';
    quoted += plain ? std::string(1, c) : format("\\%03o", byte);
  }
  return quoted + '"';
}

}  // namespace taut
