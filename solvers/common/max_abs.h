#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace taut {

/// Largest magnitude; infinite if any value is not a number.
///
/// Without their sign bit doubles are ordered like integers, those that are not numbers behind infinity; four
/// maxima run side by side.
inline double max_abs(std::span<const double> values) {
  std::uint64_t largest[4] = {};
  const auto magnitude = [&](std::size_t i) {
    return std::bit_cast<std::uint64_t>(values[i]) & ~(std::uint64_t{1} << 63);
  };
  std::size_t i = 0;
  for (; i + 4 <= values.size(); i += 4)
    for (std::size_t k = 0; k < 4; ++k) largest[k] = std::max(largest[k], magnitude(i + k));
  for (; i < values.size(); ++i) largest[0] = std::max(largest[0], magnitude(i));
  const double all =
      std::bit_cast<double>(std::max(std::max(largest[0], largest[1]), std::max(largest[2], largest[3])));
  return std::isnan(all) ? std::numeric_limits<double>::infinity() : all;
}

}  // namespace taut
