#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace taut {

/// A line on stderr with the part done, the rate and the time left, redrawn ten times a second at most.  It
/// stays silent if stderr is not a terminal.
class ProgressBar {
 public:
  ProgressBar(std::int64_t steps, bool wanted);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::int64_t done);
  /// Wipes the line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  std::int64_t steps_;
  bool visible_;
  Clock::time_point start_, drawn_{};
};

/// "[#####.....]  50 %  120/240 steps  1200 steps/s  0:01 left", as drawn by the bar.
std::string progress_line(std::int64_t done, std::int64_t steps, double seconds);

}  // namespace taut
