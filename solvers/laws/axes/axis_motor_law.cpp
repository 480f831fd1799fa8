#include "solvers/laws/axes/axis_motor_law.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

struct AxisMotorTuning {
  /// Of what a motor can give, at least this part counts when it brakes, whatever the load.  Chosen.
  static constexpr double kLeastBraking = 0.05;
};

/// The largest mean rate of a step of h of which the end lets the way be kept with this deceleration: what is
/// left, h w less, is then at least (w − a h/2)²/2a.
double mean_rate_to_stop(double way, double deceleration, double h) {
  const double in_a_step = 0.5 * deceleration * h * h;
  return way <= in_a_step ? way / h : std::sqrt(2 * deceleration * way) - 0.5 * deceleration * h;
}

/// The largest rate at the end of a stage from which a motor still stops in time, by the mean (1 − ϑ) u₀ + ϑ
/// u.
double end_rate_to_stop(double way, double deceleration, double h, double vartheta, double u0) {
  const double per_step = vartheta * h * deceleration;
  const double left = std::max(0.0, way - (1 - vartheta) * h * u0);
  return std::sqrt(per_step * per_step + 2 * deceleration * left) - per_step;
}

/// `rate`, but towards its target by no more than `most` faster than `own`.
double no_faster(double rate, double own, double most) {
  return std::abs(rate - own) <= most ? rate : own + std::copysign(most, rate - own);
}

}  // namespace

bool is_unbounded(const AxisMotor& motor) {
  return std::isinf(motor.max_force) && !motor.force_of_speed && !motor.has_gains();
}

bool has_to_brake(const AxisMotor& motor) {
  return motor.mode != AxisMotor::Mode::kVelocity && AxisMotorLaw::keeps_target(motor) &&
         !is_unbounded(motor);
}

bool needs_effective_mass(const AxisMotor& motor, const AxisStep& step, const AxisStart& start) {
  if (motor.has_gains()) return step.h * step.h * motor.stiffness > start.effective_mass;
  return has_to_brake(motor);
}

MotionPoint target_at(const AxisMotor& motor, double time) {
  switch (motor.mode) {
    case AxisMotor::Mode::kTrajectory:
      return motor.trajectory(time);
    case AxisMotor::Mode::kPosition:
      return {motor.target};
    default:
      return {0, motor.target};
  }
}

double available_force(const AxisMotor& motor, double speed) {
  if (!motor.force_of_speed) return motor.max_force;
  double least = std::min(motor.force_of_speed->held(speed), motor.force_of_speed->held(0));
  for (const Curve::Point& p : motor.force_of_speed->points())
    if (p.x < speed) least = std::min(least, p.y);
  return std::min(least, motor.max_force);
}

/// For a kick of length `time` at this rate.
void AxisMotorLaw::set_bound(const AxisMotor& motor, double time, double rate) {
  const double available =
      motor.force_of_speed ? motor.force_of_speed->held(std::abs(rate)) : motor.max_force;
  bound = time * std::min(available, motor.max_force);
}

bool AxisMotorLaw::set(const AxisStage& stage) {
  const AxisStep& step = stage.step;
  const bool second = step.in(Kick::kSecond);  // whose bound is that of the first
  if (!second) bound = 0;
  if (!stage.p.motor || !keeps_target(*stage.p.motor)) return true;
  const AxisMotor& motor = *stage.p.motor;
  const bool first = step.in(Kick::kFirst);
  if (!second) set_bound(motor, step.kick_time(), first ? stage.rate : stage.start.rate);
  return aim(motor, first    ? rate_in_first_kick(stage)
                    : second ? rate_in_second_kick(stage)
                             : rate_in_single_kick(stage));
}

/// To the target of the end of the step, by the mean rate.
double AxisMotorLaw::rate_in_first_kick(const AxisStage& stage) const {
  const double h = stage.step.h;
  const MotionPoint target = target_at(*stage.p.motor, stage.step.end_time);
  const double rate = (target.value - stage.start.theta) / h;
  // Against a target that moves on as at the end of the step.
  const double own = target.rate - 0.5 * h * target.acceleration, way = std::abs(rate - own) * h;
  if (!(way > LawTuning::kTouch && has_to_brake(*stage.p.motor))) return rate;
  const double deceleration = braking(stage, target, rate - own);
  return deceleration > 0 ? no_faster(rate, own, mean_rate_to_stop(way, deceleration, h)) : rate;
}

/// The rate of the target, and what θ₁ is off by in another step.
double AxisMotorLaw::rate_in_second_kick(const AxisStage& stage) {
  const MotionPoint target = target_at(*stage.p.motor, stage.step.end_time);
  left = target.value - stage.theta;
  const double rate = target.rate + (has_arrived() ? 0 : left / stage.step.h);
  if (has_arrived() || !has_to_brake(*stage.p.motor)) return rate;
  const double deceleration = braking(stage, target, left);
  if (!(deceleration > 0)) return rate;
  return no_faster(rate, target.rate, std::sqrt(2 * deceleration * std::abs(left)));
}

/// As in the second, with the target and θ₀ of the start.
double AxisMotorLaw::rate_in_single_kick(const AxisStage& stage) {
  const double h = stage.step.h;
  const MotionPoint target = target_at(*stage.p.motor, stage.step.end_time - h);
  left = target.value - stage.start.theta;
  const double rate = target.rate + left / h;
  if (has_arrived() || !has_to_brake(*stage.p.motor)) return rate;
  const double deceleration = braking(stage, target, left);
  if (!(deceleration > 0)) return rate;
  const double towards = std::copysign(1.0, left) * (stage.start.rate - target.rate);
  return no_faster(rate, target.rate,
                   end_rate_to_stop(std::abs(left), deceleration, h, stage.step.vartheta, towards));
}

/// Deceleration against the target, coming on along `way`, that the motor can give by itself beside the load:
/// what it had to bear in the last sub-step counts where it drives the axis on, since what helps to brake may
/// end.
double AxisMotorLaw::braking(const AxisStage& stage, const MotionPoint& target, double way) const {
  const double effective_mass = stage.start.effective_mass;
  const double own = available_force(*stage.p.motor, std::abs(stage.start.rate)) / effective_mass;
  const double load = acceleration - force / effective_mass - target.acceleration;
  const double deceleration =
      std::max(AxisMotorTuning::kLeastBraking * own, own - std::max(0.0, std::copysign(1.0, way) * load));
  return std::isfinite(deceleration) ? deceleration : 0;
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
