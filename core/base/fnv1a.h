#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

namespace taut {

/// The hash FNV-1a of 64 bits, http://www.isthe.com/chongo/tech/comp/fnv: no protection from malice, but from
/// everything that happens to a file.
class Fnv1a {
 public:
  void add(unsigned char byte) { hash_ = (hash_ ^ byte) * 1099511628211u; }
  void add(std::string_view bytes) {
    for (const char c : bytes) add(static_cast<unsigned char>(c));
  }
  /// The bits, so that −0 is not 0.
  void add(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int shift = 0; shift < 64; shift += 8) add(static_cast<unsigned char>(bits >> shift));
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 14695981039346656037u;
};

}  // namespace taut
