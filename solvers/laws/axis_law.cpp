#include "solvers/laws/axis_law.h"

#include <algorithm>
#include <cmath>

namespace taut {

RowLaw AxisLaw::sum(const AxisProperties& p) {
  RowLaw law = RowLaw::viscous(springs.slope());
  law.level[0] = springs.level();
  if (friction.bound > 0) law = law + RowLaw::box(-friction.bound, friction.bound, friction.at);
  if (motor.bound > 0) {
    // A motor of any force stops at a limit.
    if (std::isinf(motor.bound)) motor.at = std::clamp(motor.at, limits.lower_at, limits.upper_at);
    law = law + RowLaw::box(-motor.bound, motor.bound, motor.at);
  }
  return p.limits && !has_soft_limit(p) ? limits.add_to(law, *p.limits) : law;
}

/// Springs, dampers and levels are known from w; on a step of the law the rest goes to friction as far as it
/// reaches, then to the motor, then to the limit.
AxisImpulse AxisLaw::share(double lambda, double w) const {
  AxisImpulse impulse;
  impulse.elastic_limit = springs.limit.at(w);
  impulse.spring = springs.spring.at(w);
  impulse.damping = springs.damper.at(w);
  double rest = lambda - impulse.spring - impulse.damping - impulse.elastic_limit;
  const auto take = [&](double at, double bound) {
    const double given = on_step(w, at) ? std::clamp(rest, -bound, bound) : w < at ? bound : -bound;
    return bound > 0 ? given : 0;
  };
  // What is known for certain first.
  const bool on_limit = limits.holds(w), on_motor = on_step(w, motor.at);
  if (!on_limit) rest -= impulse.limit = limits.upper_back - limits.lower_back;
  if (!on_motor) rest -= impulse.motor = take(motor.at, motor.bound);
  rest -= impulse.friction = take(friction.at, friction.bound);
  if (on_motor) rest -= impulse.motor = take(motor.at, motor.bound);
  if (on_limit) impulse.limit = rest;
  return impulse;
}

}  // namespace taut
