#pragma once

#include <cstdint>
#include <string>

#include "core/base/clock.h"
#include "core/world/diagnostics.h"

namespace taut {

/// A line on stderr with the part done, simulated time, rate, time left and present joint gap, redrawn ten
/// times a second at most.  It stays silent if stderr is not a terminal.
class ProgressBar {
 public:
  /// @param dt of a step [s]
  ProgressBar(std::int64_t steps, double dt, bool wanted);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::int64_t done, const Gap& gap);
  /// Wipes the line.
  void finish();

 private:
  std::int64_t steps_;
  double dt_;
  bool visible_;
  Clock::time_point start_, drawn_{};
};

/// "[#####.....]  50 %  t = 0.5 s  1200 steps/s  0:01 left  gap 3.1e-12 m", as drawn by the bar.
std::string progress_line(std::int64_t done, std::int64_t steps, double dt, double seconds, const Gap& gap);

}  // namespace taut
