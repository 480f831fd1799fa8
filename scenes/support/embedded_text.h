#pragma once

#include <span>
#include <string_view>

namespace taut {

/// A file of the sources that the build puts into the program (cmake/embed_text.cmake).
struct EmbeddedText {
  std::string_view name;  ///< without folder
  std::string_view text;
};

/// The text of that name; empty if there is none.
inline std::string_view text_of(std::span<const EmbeddedText> texts, std::string_view name) {
  for (const EmbeddedText& each : texts)
    if (each.name == name) return each.text;
  return {};
}

}  // namespace taut
