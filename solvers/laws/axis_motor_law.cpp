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

void AxisMotorLaw::set_bound(const AxisMotor& motor, double time, double rate) {
  const double available =
      motor.force_of_speed ? motor.force_of_speed->held(std::abs(rate)) : motor.max_force;
  bound = time * std::min(available, motor.max_force);
}

bool AxisMotorLaw::aim_position(const AxisMotor& motor, const AxisStep& step, double theta0) {
  return aim(motor, (target_at(motor, step.end_time).value - theta0) / step.h);
}

bool AxisMotorLaw::aim_velocity(const AxisMotor& motor, const AxisStep& step, double theta1) {
  const MotionPoint target = target_at(motor, step.end_time);
  const double left = target.value - theta1, back = std::abs(left) <= kTouch ? 0 : left / step.h;
  return aim(motor, target.rate + back);
}

bool AxisMotorLaw::aim_single_kick(const AxisMotor& motor, const AxisStep& step, double theta0) {
  const MotionPoint target = target_at(motor, step.end_time - step.h);
  return aim(motor, target.rate + (target.value - theta0) / step.h);
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
