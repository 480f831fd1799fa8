#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace taut {

/// What printf makes of the values, cut off after 511 characters.
std::string format(const char* pattern, auto... values) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

/// "a, b and 3 more": the names of the first items, and how many there are beyond `most`.
std::string first_of(const auto& items, std::size_t most, auto name_of) {
  std::string text;
  for (std::size_t i = 0; i < items.size() && i < most; ++i) text += (i > 0 ? ", " : "") + name_of(items[i]);
  if (items.size() > most) text += " and " + std::to_string(items.size() - most) + " more";
  return text;
}

}  // namespace taut
