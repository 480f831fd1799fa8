#pragma once

#include <chrono>

namespace taut {

using Clock = std::chrono::steady_clock;

/// Wall time [s].
inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace taut
