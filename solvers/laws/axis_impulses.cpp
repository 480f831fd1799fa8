#include <algorithm>
#include <cmath>

#include "solvers/laws/axis_forces.h"

// What axes ask of a step of Moreau–Jean.  (solvers/integrators, "Moreau–Jean")
namespace taut {

void AxisForces::impulse_laws(double weight, std::span<const double> theta, std::span<RowLaw> laws) {
  weight_ = weight;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Axis& axis = axes_[i];
    const AxisProperties& p = properties(i);
    first_kick_[i] = {};
    if (released_[i]) {
      laws[rows_[i].row] = RowLaw::none();
      continue;
    }
    add_springs(axis, p);
    axis.friction_force = axis.motor_force = axis.friction_at = 0;
    if (p.friction) {
      const bool held = axis.stuck && !axis.broken;
      axis.friction_force = h_ * (held ? p.friction->static_friction : p.friction->dynamic_friction) +
                            p.friction->per_load * axis.load;
    }
    axis.lower_at = -kNever, axis.upper_at = kNever;
    axis.lower_back = axis.upper_back = 0;
    if (is_rigid_limit(i)) set_impacts(axis, *p.limits, theta[rows_[i].row]);
    if (p.motor) {
      const AxisMotor& m = *p.motor;
      const bool follows = m.mode == AxisMotor::Mode::kTrajectory;
      const MotionPoint aim = follows ? m.trajectory(end_time_ - h_) : MotionPoint{m.target};
      axis.motor_force = h_ * motor_force(m, axis.rate0);
      axis.motor_at = m.mode == AxisMotor::Mode::kVelocity
                          ? m.target
                          : std::clamp(aim.rate + (aim.value - axis.theta0) / h_, -m.max_speed, m.max_speed);
      require_finite_target(axis);
    }
    laws[rows_[i].row] = law_of(axis, p);
  }
}

/// Springs at θ₀ + ϑ h ((1 − ϑ) θ̇₀ + ϑ w), limits with compliance and tables by what they do on the way, and
/// dampers against (1 − ϑ) θ̇₀ + ϑ w.
void AxisForces::add_springs(Axis& axis, const AxisProperties& p) const {
  axis.spring_level = axis.spring_slope = axis.limit_level = axis.limit_slope = 0;
  double damping = p.friction ? p.friction->viscous : 0;
  Tangent damper, limit_damper;
  if (p.spring) {
    const Tangent spring = spring_tangent(axis, *p.spring, axis.tangent_at);
    axis.spring_level = spring.level, axis.spring_slope = spring.slope;
    damping += p.spring->damping;
    if (p.spring->damping_table) damper = damper_tangent(axis, *p.spring, axis.tangent_at);
  }
  if (has_soft_limit(p)) {
    const Tangent limit = limit_tangent(axis, *p.limits, axis.tangent_at);
    axis.limit_level = limit.level, axis.limit_slope = limit.slope;
    limit_damper = limit_damper_tangent(axis, *p.limits, axis.tangent_at);
  }
  axis.soft_limit = axis.limit_level;
  axis.damping_level = -h_ * (1 - weight_) * damping * axis.rate0 + damper.level + limit_damper.level;
  axis.damping_slope = weight_ * h_ * damping + damper.slope + limit_damper.slope;
}

/// Newton's law of impact for a limit that is passed at `theta`.
void AxisForces::set_impacts(Axis& axis, const AxisLimits& limits, double theta) const {
  const double bounce = -limits.restitution * axis.rate0;
  const bool at_lower = theta <= limits.lower + kTouch, at_upper = theta >= limits.upper - kTouch;
  if (at_lower) axis.lower_at = bounce;
  if (at_upper) axis.upper_at = bounce;
  if (at_lower && at_upper) axis.lower_at = axis.upper_at = 0;  // locked between both
}

}  // namespace taut
