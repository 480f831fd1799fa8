#pragma once

#include "core/state/axis.h"
#include "solvers/laws/axis_part_law.h"

namespace taut {

/// Its force has no bound at any speed.
bool is_unbounded(const AxisMotor& motor);

/// Motor of one axis in a stage.  (solvers/laws, "Axes")
/// Its stages are false for a trajectory that is not finite, since a law cannot have a breakpoint that is not
/// a number; the motor is left out then.
struct AxisMotorLaw : AxisBoxLaw<&AxisImpulse::motor> {
  /// To the target of the end of the step, by the mean rate.
  bool set_position(const AxisStage& stage);
  /// The rate of the target, and what θ₁ is off by in another step.
  bool set_velocity(const AxisStage& stage);
  /// As in the velocity stage, with the target and θ₀ of the start.
  bool set_single_kick(const AxisStage& stage);
  void report(AxisReport& report, const AxisProperties& p, double w) const {
    report.saturated = p.motor && !on_step(w, at);
  }
  template <typename AnyArchive>
  void transfer(AnyArchive& archive) {
    archive(at, bound);
  }

 private:
  void set_bound(const AxisMotor& motor, double time, double rate);
  bool aim(const AxisMotor& motor, double rate);
};

}  // namespace taut
