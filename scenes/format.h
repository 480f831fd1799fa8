#pragma once

#include <cstdio>
#include <string>

namespace taut {

/// What printf makes of the values, cut off after 511 characters.
std::string format(const char* pattern, auto... values) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

}  // namespace taut
