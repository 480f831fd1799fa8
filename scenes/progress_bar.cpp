#include "scenes/progress_bar.h"

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

std::string progress_line(std::int64_t done, std::int64_t steps, double seconds) {
  constexpr int kWidth = 30;
  const double part = steps > 0 ? static_cast<double>(done) / static_cast<double>(steps) : 1;
  const int filled = std::clamp(static_cast<int>(part * kWidth), 0, kWidth);
  const double rate = seconds > 0 ? static_cast<double>(done) / seconds : 0;
  char text[160];
  std::snprintf(text, sizeof text, "[%s%s] %3d %%  %lld/%lld steps  %.4g steps/s",
                std::string(filled, '#').c_str(), std::string(kWidth - filled, '.').c_str(),
                static_cast<int>(100 * part), static_cast<long long>(done), static_cast<long long>(steps),
                rate);
  std::string line = text;
  if (rate > 0) line += "  " + clock_time(static_cast<double>(steps - done) / rate) + " left";
  return line;
}

ProgressBar::ProgressBar(std::int64_t steps, bool wanted)
    : steps_(steps), visible_(wanted && isatty(STDERR_FILENO) != 0), start_(Clock::now()) {}

ProgressBar::~ProgressBar() { finish(); }

void ProgressBar::update(std::int64_t done) {
  if (!visible_) return;
  const auto now = Clock::now();
  if (now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  std::fprintf(stderr, "\r%s\033[K", progress_line(done, steps_, seconds).c_str());
  std::fflush(stderr);
}

void ProgressBar::finish() {
  if (visible_ && drawn_ != Clock::time_point{}) std::fputs("\r\033[K", stderr);
  visible_ = false;
}

}  // namespace taut
