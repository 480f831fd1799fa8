#pragma once

#include <bit>
#include <cstring>
#include <string>

/// Numbers as little-endian bytes, as all files here have them.
namespace taut {

static_assert(std::endian::native == std::endian::little, "recordings are copied from memory as they are");

template <typename Number>
void append_little(std::string& bytes, Number value) {
  char text[sizeof value];
  std::memcpy(text, &value, sizeof value);
  bytes.append(text, sizeof value);
}

template <typename Number>
Number read_little(const char* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

}  // namespace taut
