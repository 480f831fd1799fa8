#include "scenes/program/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace taut {
namespace {

std::string clock_time(double seconds) {
  const auto s = static_cast<long long>(std::ceil(std::min(seconds, 1e9)));
  char text[32];
  if (s < 3600)
    std::snprintf(text, sizeof text, "%lld:%02lld", s / 60, s % 60);
  else
    std::snprintf(text, sizeof text, "%lld:%02lld:%02lld", s / 3600, s / 60 % 60, s % 60);
  return text;
}

}  // namespace

std::string progress_line(std::int64_t done, std::int64_t steps, double dt, double seconds, const Gap& gap) {
  constexpr int kWidth = 20;
  const double part = steps > 0 ? static_cast<double>(done) / static_cast<double>(steps) : 1;
  const int filled = std::clamp(static_cast<int>(part * kWidth), 0, kWidth);
  const double rate = seconds > 0 ? static_cast<double>(done) / seconds : 0;
  char text[200];
  std::snprintf(text, sizeof text, "[%s%s] %3d %%  t = %.4g s  %.4g steps/s",
                std::string(filled, '#').c_str(), std::string(kWidth - filled, '.').c_str(),
                static_cast<int>(100 * part), static_cast<double>(done) * dt, rate);
  std::string line = text;
  if (rate > 0) line += "  " + clock_time(static_cast<double>(steps - done) / rate) + " left";
  std::snprintf(text, sizeof text, "  gap %.1e m", gap.metres);
  line += text;
  if (gap.radians > 0) std::snprintf(text, sizeof text, " %.1e rad", gap.radians), line += text;
  return line;
}

ProgressBar::ProgressBar(std::int64_t steps, double dt, bool wanted)
    : steps_(steps), dt_(dt), visible_(wanted && isatty(STDERR_FILENO) != 0), start_(Clock::now()) {}

ProgressBar::~ProgressBar() { finish(); }

void ProgressBar::update(std::int64_t done, const Gap& gap) {
  if (!visible_) return;
  const auto now = Clock::now();
  if (now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  std::fprintf(stderr, "\r%s\033[K", progress_line(done, steps_, dt_, seconds, gap).c_str());
  std::fflush(stderr);
}

void ProgressBar::finish() {
  if (visible_ && drawn_ != Clock::time_point{}) std::fputs("\r\033[K", stderr);
  visible_ = false;
}

}  // namespace taut
