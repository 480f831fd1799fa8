#pragma once

#include <cmath>
#include <limits>

#include "core/axes/axis.h"
#include "solvers/laws/axes/axis_part_law.h"

namespace taut {

/// Its force has no bound at any speed, and it keeps its target exactly.
bool is_unbounded(const AxisMotor& motor);
/// It has a bounded force, with which it must brake in time.
bool has_to_brake(const AxisMotor& motor);
/// It must know how heavy its axis is: it has to brake, or gains that the step does not resolve for two
/// bodies by themselves.
bool needs_effective_mass(const AxisMotor& motor, const AxisStep& step, const AxisStart& start);
/// Target of a motor, with its rate; a velocity is the rate.
MotionPoint target_at(const AxisMotor& motor, double time);
/// What it can give at this speed and at all that are lower [N·m or N].
double available_force(const AxisMotor& motor, double speed);

/// Motor of one axis in a stage that keeps its target.  (solvers/laws/axes, "Exact motors that brake")
/// set() is false for a trajectory that is not finite, since a law cannot have a breakpoint that is not
/// a number; the motor is left out then.
struct AxisMotorLaw : AxisBoxLaw<&AxisImpulse::motor> {
  /// Of the last sub-step, from which the load of this one is known: change of the rate over its length
  /// [rad/s² or m/s²], and the mean force of the motor.
  double acceleration = 0, force = 0;
  /// How far the target was from the end of that [rad or m].
  double left = std::numeric_limits<double>::infinity();

  void begin(const AxisProperties&, const AxisStep& step, const AxisStart&) { length_ = step.h; }
  /// It has brought its axis to its target.
  bool has_arrived() const { return std::abs(left) <= LawTuning::kTouch; }
  bool set(const AxisStage& stage);
  void finish(AxisReport&, const AxisEnd& end) {
    acceleration = end.rate_change / length_;
    force = end.impulse.motor / length_;
  }
  void report(AxisReport& report, const AxisProperties& p, double w) const {
    if (p.motor && keeps_target(*p.motor)) report.saturated = !on_step(w, at);
  }
  template <typename AnyArchive>
  void transfer(AnyArchive& archive) {
    archive(at, bound, acceleration, force, left);
  }

  /// It is no servo and no winch, which have laws of their own.
  static bool keeps_target(const AxisMotor& motor) { return !motor.has_gains() && !motor.pulls_only; }

 private:
  double rate_in_first_kick(const AxisStage& stage) const;
  double rate_in_second_kick(const AxisStage& stage);
  double rate_in_single_kick(const AxisStage& stage);
  void set_bound(const AxisMotor& motor, double time, double rate);
  bool aim(const AxisMotor& motor, double rate);
  double braking(const AxisStage& stage, const MotionPoint& target, double way) const;

  double length_ = 0;  ///< of the sub-step [s]
};

}  // namespace taut
