#pragma once

#include <time.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace taut::benchmarks {

/// Processor time of this thread, or with CLOCK_PROCESS_CPUTIME_ID of all of them [s].
inline double cpu_seconds(clockid_t clock = CLOCK_THREAD_CPUTIME_ID) {
  timespec t;
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Processor time of a call [s].
template <typename Function>
double cpu_seconds_of(Function&& function) {
  const double start = cpu_seconds();
  function();
  return cpu_seconds() - start;
}

/// 0 if there are no values; the upper one of the middle two if their number is even.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return values.empty() ? 0.0 : *middle;
}

}  // namespace taut::benchmarks
