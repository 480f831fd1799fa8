#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace taut {

/// Largest magnitude; infinite if any value is not a number.
inline double max_abs(std::span<const double> values) {
  double largest = 0;
  for (double v : values) {
    if (std::isnan(v)) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, std::abs(v));
  }
  return largest;
}

}  // namespace taut
