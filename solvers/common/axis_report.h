#pragma once

#include <optional>

namespace taut {

/// A quantity along one axis by what gave it; forces and impulses are positive towards larger θ.
struct AxisImpulse {
  double motor = 0, friction = 0, limit = 0, spring = 0;  ///< friction: Coulomb's; limit: rigid
  double damping = 0;        ///< dampers of springs and soft limits, and viscous friction
  double elastic_limit = 0;  ///< limits with compliance, but for their dampers
  double total() const { return motor + friction + limit + spring + damping + elastic_limit; }  ///< sum
  AxisImpulse& operator+=(const AxisImpulse& other) {  ///< adds each part
    motor += other.motor, friction += other.friction, limit += other.limit;
    spring += other.spring, damping += other.damping, elastic_limit += other.elastic_limit;
    return *this;
  }
};

/// What acted along an axis over a step.
struct AxisReport {
  AxisImpulse force;                  ///< mean over the step [N·m or N]
  AxisImpulse work;                   ///< on the bodies [J]
  AxisImpulse power;                  ///< mean over the step [W]
  bool stuck = false;                 ///< friction holds the axis where it is
  bool saturated = false;             ///< the motor gives all it has and does not reach its target
  bool at_limit = false;              ///< a limit holds the axis
  std::optional<double> impact_time;  ///< of the last impact at a limit in the step [s]
};

}  // namespace taut
