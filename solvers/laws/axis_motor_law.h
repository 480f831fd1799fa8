#pragma once

#include "core/state/axis.h"
#include "solvers/laws/axis_step.h"

namespace taut {

/// Its force has no bound at any speed.
bool is_unbounded(const AxisMotor& motor);

/// Motor of one axis in a stage: |λ| ≤ `bound` against w − `at`.  (solvers/laws, "Axes")
/// The functions that aim are false for a trajectory that is not finite, since a law cannot have a
/// breakpoint that is not a number; the motor is left out then.
struct AxisMotorLaw {
  double at = 0;     ///< rate that it keeps [rad/s or m/s]
  double bound = 0;  ///< impulse; 0: none [N·m·s or N·s]

  /// For a kick of length `time` at this rate.
  void set_bound(const AxisMotor& motor, double time, double rate);
  /// Position stage: to the target of the end of the step, by the mean rate.
  bool aim_position(const AxisMotor& motor, const AxisStep& step, double theta0);
  /// Velocity stage: the rate of the target, and what θ₁ is off by in another step.
  bool aim_velocity(const AxisMotor& motor, const AxisStep& step, double theta1);
  /// Moreau–Jean: as in the velocity stage, with the target and θ₀ of the start.
  bool aim_single_kick(const AxisMotor& motor, const AxisStep& step, double theta0);

 private:
  bool aim(const AxisMotor& motor, double rate);
};

}  // namespace taut
