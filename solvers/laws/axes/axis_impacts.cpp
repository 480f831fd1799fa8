#include "solvers/laws/axes/axis_impacts.h"

#include <algorithm>

namespace taut {
namespace {

struct AxisImpactsTuning {
  /// Slower impacts do not move others [m/s or rad/s].  Chosen.
  static constexpr double kJolt = 1e-6;
};

}  // namespace

void AxisImpacts::clear() {
  std::fill(impacts_.begin(), impacts_.end(), AxisImpact{});
  count_ = 0;
}

/// Away from this limit, where it began, a rate stops axis i at it.
bool AxisImpacts::stops(std::size_t i, bool at_lower, std::span<const double> w) const {
  const AxisLimitLaw& law = axes_[i].limits;
  return in_flight(*table_.properties(i).limits, axes_[i].start.theta, at_lower) &&
         on_step(w[table_.row(i)], at_lower ? law.lower_at : law.upper_at);
}

bool AxisImpacts::let_through(std::size_t i, std::span<const double> /*lambda*/, std::span<const double> w) {
  if (!table_.has_rigid_limit(i)) return false;
  if (table_.properties(i).limits->restitution == 0 && !plastic_) return false;
  const bool at_upper = stops(i, false, w);
  if (!at_upper && !stops(i, true, w)) return false;
  impacts_[i].at_lower = !at_upper;
  return true;
}

double AxisImpacts::meeting(std::size_t i, std::span<const double> w, double h) const {
  const AxisLimits& limits = *table_.properties(i).limits;
  const AxisStart& start = axes_[i].start;
  const double sign = impacts_[i].at_lower ? 1 : -1;
  const double gap = sign * (start.theta - (impacts_[i].at_lower ? limits.lower : limits.upper));
  return time_of_meeting(gap, sign * start.rate, sign * w[table_.row(i)], h);
}

void AxisImpacts::set_meeting(std::size_t i, double time, std::span<const double> w, double h) {
  const double mean = w[table_.row(i)], rate0 = axes_[i].start.rate;
  impacts_[i].rate = rate0 + 2 * (mean - rate0) * time / h;
}

/// Axis i, at θ or due to strike, moves on into its limit.
bool AxisImpacts::runs_into_limit(int i, double theta, double rate) const {
  if (table_.released(i)) return false;
  const AxisLimits& limits = *table_.properties(i).limits;
  return (rate < -AxisImpactsTuning::kJolt && is_struck(limits, impacts_[i], theta, true)) ||
         (rate > AxisImpactsTuning::kJolt && is_struck(limits, impacts_[i], theta, false));
}

bool AxisImpacts::any_unlocated(std::span<const double> theta1) const {
  const auto strikes = [&](int i) {
    return !impacts_[i].due() && runs_into_limit(i, theta1[table_.row(i)], axes_[i].start.rate);
  };
  return std::any_of(table_.limited().begin(), table_.limited().end(), strikes);
}

bool AxisImpacts::any_due() const {
  return std::any_of(table_.limited().begin(), table_.limited().end(),
                     [&](int i) { return impacts_[i].due(); });
}

bool AxisImpacts::come_together(std::span<const double> theta1, std::span<const double> w) const {
  const auto strikes = [&](int i) {
    return table_.has_rigid_limit(i) && runs_into_limit(i, theta1[table_.row(i)], w[table_.row(i)]);
  };
  return std::any_of(table_.limited().begin(), table_.limited().end(), strikes);
}

void AxisImpacts::finish(std::span<const double> w, double time, std::span<AxisReport> reports) {
  struck_ = false;
  for (std::size_t i = 0; i < impacts_.size(); ++i) {
    AxisImpact& impact = impacts_[i];
    if (impact.due() || (table_.has_rigid_limit(i) && (stops(i, true, w) || stops(i, false, w)))) {
      reports[i].impact_time = time;
      struck_ = true;
    }
    impact.forget(impact.due());
  }
}

}  // namespace taut
