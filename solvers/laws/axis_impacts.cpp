#include "solvers/laws/axis_impacts.h"

#include <algorithm>
#include <cmath>

#include "solvers/laws/time_of_meeting.h"

namespace taut {
namespace {

/// Slower impacts do not move others [m/s or rad/s].
constexpr double kJolt = 1e-6;

/// When the axis gets to the limit; h if it does not.
double crossing(const AxisLimits& limits, bool at_lower, const AxisStart& start, double w, double h) {
  const double sign = at_lower ? 1 : -1;
  const double gap = sign * (start.theta - (at_lower ? limits.lower : limits.upper));
  return time_of_meeting(gap, sign * start.rate, sign * w, h);
}

}  // namespace

void AxisImpacts::clear() {
  std::fill(impacts_.begin(), impacts_.end(), AxisImpact{});
  count_ = 0;
}

bool AxisImpacts::seek(const AxisTable& table, std::span<const AxisLaw> axes, std::span<const double> w) {
  if (!table.any_rigid_limit() || count_ >= kMostImpacts) return false;
  bool any = false;
  for (std::size_t i = 0; i < impacts_.size(); ++i) {
    AxisImpact& impact = impacts_[i];
    if (!table.has_rigid_limit(i) || impact.spent || impact.stage != AxisImpact::Stage::kNone) continue;
    const AxisLimits& limits = *table.properties(i).limits;
    if (limits.restitution == 0 && !plastic_) continue;
    for (bool at_lower : {true, false}) {
      if (!in_flight(limits, axes[i].start.theta, at_lower)) continue;
      if (!on_step(w[table.row(i)], at_lower ? axes[i].limits.lower_at : axes[i].limits.upper_at)) continue;
      impact.stage = AxisImpact::Stage::kSought;
      impact.at_lower = at_lower;
      any = true;
    }
  }
  if (any) ++count_;
  return any;
}

double AxisImpacts::first(const AxisTable& table, std::span<const AxisLaw> axes, std::span<const double> w,
                          double h) const {
  double first = h;
  for (std::size_t i = 0; i < impacts_.size(); ++i)
    if (impacts_[i].sought())
      first = std::min(first, crossing(*table.properties(i).limits, impacts_[i].at_lower, axes[i].start,
                                       w[table.row(i)], h));
  return first;
}

void AxisImpacts::take(double until, const AxisTable& table, std::span<const AxisLaw> axes,
                       std::span<const double> w, double h) {
  for (std::size_t i = 0; i < impacts_.size(); ++i) {
    AxisImpact& impact = impacts_[i];
    if (impact.stage == AxisImpact::Stage::kNone)
      continue;  // one that was due goes on to be if it comes first
    const double mean = w[table.row(i)], rate0 = axes[i].start.rate;
    const double s = crossing(*table.properties(i).limits, impact.at_lower, axes[i].start, mean, h);
    impact.stage = s <= until ? AxisImpact::Stage::kDue : AxisImpact::Stage::kNone;
    impact.rate = rate0 + 2 * (mean - rate0) * s / h;
  }
}

void AxisImpacts::forget(bool for_good) {
  for (AxisImpact& impact : impacts_) {
    if (for_good && impact.stage != AxisImpact::Stage::kNone) impact.spent = true;
    impact.stage = AxisImpact::Stage::kNone;
  }
}

bool AxisImpacts::any(const AxisTable& table, std::span<const AxisLaw> axes,
                      std::span<const double> theta1) const {
  if (!table.any_rigid_limit()) return false;
  for (std::size_t i = 0; i < impacts_.size(); ++i) {
    if (!table.has_rigid_limit(i)) continue;
    const AxisLimits& limits = *table.properties(i).limits;
    const double theta = theta1[table.row(i)], rate0 = axes[i].start.rate;
    if (impacts_[i].due() || (theta <= limits.lower + kTouch && rate0 < -kJolt) ||
        (theta >= limits.upper - kTouch && rate0 > kJolt))
      return true;
  }
  return false;
}

void AxisImpacts::finish(const AxisTable& table, std::span<const AxisLaw> axes, std::span<const double> w,
                         double time, std::span<AxisReport> reports) {
  const auto stops = [&](std::size_t i, bool at_lower) {
    return on_step(w[table.row(i)], at_lower ? axes[i].limits.lower_at : axes[i].limits.upper_at) &&
           in_flight(*table.properties(i).limits, axes[i].start.theta, at_lower);
  };
  struck_ = false;
  for (std::size_t i = 0; i < impacts_.size(); ++i) {
    AxisImpact& impact = impacts_[i];
    if (impact.due() || (table.has_rigid_limit(i) && (stops(i, true) || stops(i, false)))) {
      reports[i].impact_time = time;
      struck_ = true;
    }
    if (impact.due()) impact.spent = true;
    impact.stage = AxisImpact::Stage::kNone;
  }
}

}  // namespace taut
