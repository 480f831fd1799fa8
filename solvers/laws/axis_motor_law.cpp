#include "solvers/laws/axis_motor_law.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

/// Target of a motor and its rate.
MotionPoint target_at(const AxisMotor& motor, double time) {
  return motor.mode == AxisMotor::Mode::kTrajectory ? motor.trajectory(time) : MotionPoint{motor.target};
}

}  // namespace

bool is_unbounded(const AxisMotor& motor) { return std::isinf(motor.max_force) && !motor.force_of_speed; }

/// For a kick of length `time` at this rate.
void AxisMotorLaw::set_bound(const AxisMotor& motor, double time, double rate) {
  const double available =
      motor.force_of_speed ? motor.force_of_speed->held(std::abs(rate)) : motor.max_force;
  bound = time * std::min(available, motor.max_force);
}

bool AxisMotorLaw::set_position(const AxisStage& stage) {
  bound = 0;
  if (!stage.p.motor) return true;
  const AxisMotor& motor = *stage.p.motor;
  set_bound(motor, 0.5 * stage.step.h, stage.rate);
  return aim(motor, (target_at(motor, stage.step.end_time).value - stage.start.theta) / stage.step.h);
}

bool AxisMotorLaw::set_velocity(const AxisStage& stage) {
  if (!stage.p.motor) return true;
  const MotionPoint target = target_at(*stage.p.motor, stage.step.end_time);
  const double left = target.value - stage.theta, back = std::abs(left) <= kTouch ? 0 : left / stage.step.h;
  return aim(*stage.p.motor, target.rate + back);
}

bool AxisMotorLaw::set_single_kick(const AxisStage& stage) {
  bound = 0;
  if (!stage.p.motor) return true;
  const AxisMotor& motor = *stage.p.motor;
  set_bound(motor, stage.step.h, stage.start.rate);
  const MotionPoint target = target_at(motor, stage.step.end_time - stage.step.h);
  return aim(motor, target.rate + (target.value - stage.start.theta) / stage.step.h);
}

/// To keep its own target rate, or this one.
bool AxisMotorLaw::aim(const AxisMotor& motor, double rate) {
  at = motor.mode == AxisMotor::Mode::kVelocity ? motor.target
                                                : std::clamp(rate, -motor.max_speed, motor.max_speed);
  if (std::isfinite(at)) return true;
  at = bound = 0;
  return false;
}

}  // namespace taut
