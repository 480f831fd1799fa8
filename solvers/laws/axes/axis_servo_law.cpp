#include "solvers/laws/axes/axis_servo_law.h"

#include <algorithm>
#include <cmath>

#include "solvers/laws/axes/axis_motor_law.h"

namespace taut {
namespace {

/// Slope of a spring and damper beyond the midpoint rule, so that what is stiffer than the step resolves
/// comes to rest at its target.
double excess_of(double stiffness, double h, double effective_mass) {
  return std::max(0.0, h * h * stiffness - effective_mass);
}

}  // namespace

/// What there is at the rate of the tangent.
ImpulseLine AxisServoLaw::at_present() const {
  if (!(bound > 0)) return {};
  const double there = line.at(tangent.rate);
  if (std::abs(there) <= bound) return line;
  return {std::copysign(bound, there), 0};
}

/// `available`: the impulse that it has.
bool AxisServoLaw::take(const ImpulseLine& whole, double available) {
  line = whole, bound = available;
  if (std::isfinite(line.level) && std::isfinite(line.slope)) return true;
  release();
  return false;
}

bool AxisServoLaw::set(const AxisStage& stage) {
  const bool second = stage.step.in(Kick::kSecond);  // whose bound is that of the first
  if (!second) release();
  if (!stage.p.motor || !stage.p.motor->has_gains()) return true;
  return second                         ? set_second_kick(stage)
         : stage.step.in(Kick::kSingle) ? set_single_kick(stage)
                                        : set_first_kick(stage);
}

/// The error x = θ − r has the mean rate u = w − ṙ: −h/2 k (x₀ + h/2 u) − h/2 d u − η u.
bool AxisServoLaw::set_first_kick(const AxisStage& stage) {
  const AxisMotor& motor = *stage.p.motor;
  const double h = stage.step.h, kick = 0.5 * h;
  const MotionPoint target = target_at(motor, stage.step.end_time);
  const double own = target.rate - kick * target.acceleration;
  const double x0 = motor.stiffness > 0 ? stage.start.theta - (target.value - h * own) : 0;
  excess = 0.25 * excess_of(motor.stiffness, h, stage.start.effective_mass);
  const double spring = kick * motor.stiffness, damping = kick * motor.damping;
  const double slope = kick * spring + damping + excess;
  return take({slope * own - spring * x0, slope}, kick * available_force(motor, stage.rate));
}

/// The second kick gives again what the first has, but for what stands for an end that is not resolved, which
/// is against the rate of the error there, as is a damper that would reverse it.
void AxisServoLaw::finish_first_kick(const AxisProperties& p, const AxisStart&, double w) {
  if (!p.motor || !p.motor->has_gains()) return;
  given_ = line.at(w);
  mean_ = w;
  tangent.start(w);
}

bool AxisServoLaw::set_second_kick(const AxisStage& stage) {
  const AxisMotor& motor = *stage.p.motor;
  const double h = stage.step.h, kick = 0.5 * h, damping = kick * motor.damping;
  const MotionPoint target = target_at(motor, stage.step.end_time);
  const double u = mean_ - (target.rate - kick * target.acceleration);
  const bool implicit = damping > stage.start.effective_mass;
  const double slope = excess + (implicit ? damping : 0);
  return take({given_ + slope * (u + target.rate), slope}, bound);
}

bool AxisServoLaw::set_single_kick(const AxisStage& stage) {
  const AxisMotor& motor = *stage.p.motor;
  const double h = stage.step.h, vartheta = stage.step.vartheta, effective_mass = stage.start.effective_mass;
  const MotionPoint target = target_at(motor, stage.step.end_time);
  const double own = target.rate - h * target.acceleration;  // at the start
  const double u0 = stage.start.rate - own;
  const double start = target.value - h * (target.rate - 0.5 * h * target.acceleration);
  const double x0 = motor.stiffness > 0 ? stage.start.theta - start : 0;
  const double damping = h * motor.damping;
  const double later = (1 - vartheta) * damping <= effective_mass ? vartheta : 1 - effective_mass / damping;
  const double spring = h * motor.stiffness;
  excess = (1 - vartheta * vartheta) * excess_of(motor.stiffness, h, effective_mass);
  const double slope = vartheta * vartheta * h * spring + excess + later * damping;
  const double level = -spring * (x0 + vartheta * (1 - vartheta) * h * u0) - (1 - later) * damping * u0;
  return take({level + slope * target.rate, slope}, h * available_force(motor, stage.start.rate));
}

bool AxisServoLaw::move(const AxisProperties& p, const AxisStep&, const AxisStart& start, double w,
                        double rate_tolerance) {
  if (!p.motor || !p.motor->has_gains()) return false;
  const double there = held(w), given = at_present().at(w);
  const double size = std::max(std::abs(there), std::abs(given));
  if (std::abs(there - given) <= tangent_tolerance(size, rate_tolerance, start.effective_mass)) return false;
  tangent.move(w, rate_tolerance);
  return true;
}

}  // namespace taut
