#pragma once

#include <optional>

#include "scenes/accuracy/reference_case.h"
#include "solvers/simulator/simulator.h"

namespace taut::reference {

/// What the contacts of a pair gave over the last step, mean forces, world axes.
struct PairContact {
  Vec3 normal_on_b = Vec3::Zero();    ///< [N]
  Vec3 friction_on_b = Vec3::Zero();  ///< [N]
  double normal_sum = 0;              ///< of the magnitudes of all points [N]
  Vec3 moment = Vec3::Zero();         ///< Σ normal force × place [N·m]
  bool sliding = false;               ///< one that bears slides at the end of the step
  std::optional<double> impact_time;  ///< of the last impact in the step [s]

  Vec3 centre() const { return moment / normal_sum; }  ///< of pressure [m]
};

PairContact pair_contact(const Simulator& simulator, const Pair& pair);

}  // namespace taut::reference
