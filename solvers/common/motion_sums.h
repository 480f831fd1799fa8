#pragma once

#include <span>

#include "core/state/state.h"
#include "solvers/common/step_report.h"

namespace taut {

/// Kinetic energy, momentum and angular momentum about the origin of bodies that move with twists V and have
/// momenta p = M V (zero for fixed ones):  Σ ½ p·V,  Σ p_v,  Σ x × p_v + p_ω.
inline void sum_motion(const State& state, std::span<const Wrench> momenta, StepReport& report) {
  double energy = 0;
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  for (std::size_t b = 0; b < momenta.size(); ++b) {
    const Wrench& p = momenta[b];
    const Twist& V = state.twists[b];
    energy += 0.5 * dot(p, V);
    linear += p.force;
    angular += state.poses[b].p.cross(p.force) + p.torque;
  }
  report.kinetic_energy = energy;
  report.linear_momentum = linear;
  report.angular_momentum = angular;
}

}  // namespace taut
