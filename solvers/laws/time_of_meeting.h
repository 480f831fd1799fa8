#pragma once

namespace taut {

struct MeetingTuning {
  /// Times of impact looked for in one step, of axes and of contacts each; more happen with their sub-step.
  /// Chosen.  Half: a ball of a marble run sinks in deeper.
  static constexpr int kMostImpacts = 16;
  /// Bisections for the time of one: to round-off.
  static constexpr int kBisections = 60;
};

/// When a gap closes that begins with a rate and changes with a mean rate in h, if the rate is linear in
/// time: the root of  gap + rate s + (mean − rate) s²/h = 0  in (0, h] [s]; h if there is none.
inline double time_of_meeting(double gap, double rate, double mean, double h) {
  const auto gap_at = [&](double s) { return gap + rate * s + (mean - rate) * s * s / h; };
  double low = 0, high = h;
  if (gap_at(high) >= 0) return h;
  for (int i = 0; i < MeetingTuning::kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (gap_at(middle) > 0 ? low : high) = middle;
  }
  return high;
}

}  // namespace taut
