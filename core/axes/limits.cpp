#include "core/axes/limits.h"

#include <algorithm>
#include <sstream>

#include "core/base/check.h"

namespace taut {

double beyond(const AxisLimits& limits, double theta) {
  return theta > limits.upper ? theta - limits.upper : std::min(0.0, theta - limits.lower);
}

double limit_energy(const AxisLimits& limits, double theta) {
  if (limits.compliance == 0) return 0;
  const double stretch = beyond(limits, theta);
  return 0.5 * stretch * stretch / limits.compliance;
}

double AxisLimits::energy(double theta) const { return limit_energy(*this, theta); }

std::string AxisLimits::start_problem(double theta, double tolerance) const {
  const bool low = theta < lower - tolerance;
  if (compliance > 0 || (!low && !(theta > upper + tolerance))) return {};
  std::ostringstream message;
  message << "starts at " << theta << ", " << (low ? "below its lower limit " : "above its upper limit ")
          << (low ? lower : upper);
  return message.str();
}

void AxisLimits::check(std::string_view axis) const {
  using detail::of_axis;
  if (lower > upper)
    fail(of_axis("lower limit", axis), "must not exceed the upper limit " + std::to_string(upper), lower);
  if (compliance > 0 && restitution > 0)
    fail(of_axis("restitution", axis), "must be 0 beside a compliance", restitution);
  if (compliance == 0 && damping > 0) fail(of_axis("limit damping", axis), "needs a compliance", damping);
}

}  // namespace taut
