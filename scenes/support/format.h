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

/// "1 joint", "2 joints", "3 bodies".
inline std::string counted(long long number, const std::string& one, const std::string& more) {
  return std::to_string(number) + ' ' + (number == 1 ? one : more);
}
inline std::string counted(long long number, const std::string& one) {
  return counted(number, one, one + 's');
}

/// What is said of a model of others where its notices are not listed: "2 kinds of things in a.xml are not,
/// or not as they are, in the scene; "
inline std::string notices_in_short(std::size_t number, const std::string& file) {
  return counted(static_cast<long long>(number), "kind of thing", "kinds of things") + " in " + file +
         (number == 1 ? " is not, or not as it is" : " are not, or not as they are") + ", in the scene; ";
}

/// "a, b and 3 more": the names of the first items, and how many there are beyond `most`.
std::string first_of(const auto& items, std::size_t most, auto name_of) {
  std::string text;
  for (std::size_t i = 0; i < items.size() && i < most; ++i) text += (i > 0 ? ", " : "") + name_of(items[i]);
  if (items.size() > most) text += " and " + std::to_string(items.size() - most) + " more";
  return text;
}

}  // namespace taut
