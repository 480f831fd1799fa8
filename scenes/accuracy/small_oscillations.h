#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/world/world.h"

namespace taut {

/// A natural motion about an equilibrium: all twists proportional to `shape` cos(ω t).
struct Mode {
  double omega = 0;              ///< [rad/s]
  std::vector<Twist> shape;      ///< one entry per body, xᵀ M x = 1
  std::vector<Wrench> momentum;  ///< M times the shape: modes are orthogonal to it
};

/// All modes with ω > 0 of a world at rest in equilibrium, slowest first, from the generalised eigenvalue
/// problem  Zᵀ K Z x = ω² Zᵀ M Z x  with dense matrices: Z spans the null space of J, and
/// K = −∂(f + Jᵀλ)/∂q at fixed λ by central differences.
std::vector<Mode> natural_modes(const World& world);

}  // namespace taut
