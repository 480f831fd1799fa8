#include "solvers/laws/axes/axis_winch_law.h"

#include "solvers/laws/axes/axis_motor_law.h"

namespace taut {

/// The length at the end of the step.
/// @returns its rate there.
double AxisWinchLaw::wind(const AxisStage& stage) {
  const AxisMotor& motor = *stage.p.motor;
  const double h = stage.step.h, from = stage.start.let_out;
  const MotionPoint target = target_at(motor, stage.step.end_time);
  double rate = target.rate, change = h * rate;
  if (motor.mode != AxisMotor::Mode::kVelocity) {
    const double left = target.value - from, most = motor.max_speed;
    change = std::clamp(left, -h * most, h * most);
    rate = change == left ? std::clamp(rate, -most, most) : change / h;
  }
  length = from + change;
  const double shortest = stage.p.limits ? stage.p.limits->lower : -kUnlimited;
  if (!(length < shortest)) return rate;
  length = shortest;
  return 0;
}

bool AxisWinchLaw::set_position(const AxisStage& stage) {
  release();
  if (!stage.p.motor || !stage.p.motor->pulls_only) return true;
  const double rate = wind(stage);
  back = 0;
  at = (length - stage.start.theta) / stage.step.h;
  if (!std::isfinite(at) || !std::isfinite(rate)) return at = 0, false;
  bound = 0.5 * stage.step.h * available_force(*stage.p.motor, std::abs(rate));
  return true;
}

bool AxisWinchLaw::set_velocity(const AxisStage& stage) {
  if (!stage.p.motor || !stage.p.motor->pulls_only) return true;
  const double rate = wind(stage);
  const bool taut = stage.theta >= length - LawTuning::kTouch;
  at = taut ? rate : kUnreachedRate;
  // Both kicks together are the impulse that must not push.
  back = taut ? std::max(0.0, -stage.first_kick.motor) : 0;
  if (std::isfinite(rate)) return true;
  at = bound = 0;
  return false;
}

bool AxisWinchLaw::set_single_kick(const AxisStage& stage) {
  release();
  if (!stage.p.motor || !stage.p.motor->pulls_only) return true;
  const double rate = wind(stage);
  back = 0;
  at = stage.theta >= 0.5 * (stage.start.let_out + length) - LawTuning::kTouch ? rate : kUnreachedRate;
  if (!std::isfinite(at) || !std::isfinite(length)) return at = 0, false;
  bound = stage.step.h * available_force(*stage.p.motor, std::abs(rate));
  return true;
}

}  // namespace taut
