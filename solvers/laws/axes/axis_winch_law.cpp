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

bool AxisWinchLaw::set(const AxisStage& stage) {
  const bool second = stage.step.in(Kick::kSecond);  // whose bound is that of the first
  if (!second) release();
  if (!stage.p.motor || !stage.p.motor->pulls_only) return true;
  const double rate = wind(stage);
  at = rate_to_hold(stage, rate);
  // Both kicks together are the impulse that must not push.
  back = second && at == rate ? std::max(0.0, -stage.first_kick.motor) : 0;
  if (!std::isfinite(at) || !std::isfinite(rate) || !std::isfinite(length)) return at = bound = 0, false;
  if (!second) bound = stage.step.kick_time() * available_force(*stage.p.motor, std::abs(rate));
  return true;
}

/// In the first kick what leads to the length, and then `rate`, where the rope is taut: at q₁, or in the
/// middle of a step with one kick.
double AxisWinchLaw::rate_to_hold(const AxisStage& stage, double rate) const {
  const AxisStep& step = stage.step;
  if (step.in(Kick::kFirst)) return (length - stage.start.theta) / step.h;
  const double there = step.in(Kick::kSingle) ? 0.5 * (stage.start.let_out + length) : length;
  return stage.theta >= there - LawTuning::kTouch ? rate : kUnreachedRate;
}

}  // namespace taut
