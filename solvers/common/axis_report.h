#pragma once

#include <optional>
#include <string_view>

#include "solvers/common/energy_ledger.h"

namespace taut {

/// A quantity along one axis by what gave it; forces and impulses are positive towards larger θ.
struct AxisImpulse {
  double motor = 0, friction = 0, limit = 0, spring = 0;  ///< friction: Coulomb's; limit: rigid
  double damping = 0;        ///< dampers of springs and soft limits, and viscous friction
  double elastic_limit = 0;  ///< limits with compliance, but for their dampers

  double total() const;                               ///< sum
  AxisImpulse& operator+=(const AxisImpulse& other);  ///< adds each part
};

/// A part of it.
struct AxisPart {
  double AxisImpulse::*part;             ///< the member
  std::string_view column;               ///< of probes, which add the parts of one column
  double EnergyLedger::*term = nullptr;  ///< where its work goes; null: into energy that is stored
};
/// All of them.
inline constexpr AxisPart kAxisParts[] = {
    {&AxisImpulse::motor, "motor", &EnergyLedger::motors},
    {&AxisImpulse::friction, "friction", &EnergyLedger::friction},
    {&AxisImpulse::limit, "limit", &EnergyLedger::limits},
    {&AxisImpulse::spring, "spring"},
    {&AxisImpulse::damping, "damping", &EnergyLedger::damping},
    {&AxisImpulse::elastic_limit, "limit"},
};

inline double AxisImpulse::total() const {
  double sum = 0;
  for (const auto& [part, column, term] : kAxisParts) sum += this->*part;
  return sum;
}
inline AxisImpulse& AxisImpulse::operator+=(const AxisImpulse& other) {
  for (const auto& [part, column, term] : kAxisParts) this->*part += other.*part;
  return *this;
}

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
