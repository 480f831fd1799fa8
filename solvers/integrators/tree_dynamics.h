#pragma once

#include <memory>
#include <vector>

#include "core/world/world.h"

namespace taut {

/// Accelerations of a world whose joints form trees, in reduced coordinates: references for the multipliers,
/// with no S and no λ in them.
///
/// Joint k of body b and its parent p, with the rows J_p a_p + J_b a_b + γ = 0, leaves
///
///     a_b = X a_p + c + S u̇,    X = −J_b⁺ J_p,   c = −J_b⁺ γ,   S = null space of J_b (1)
///
/// where a = (ω̇, v̇) in world axes about the centre of mass and u are the joint's own speeds.
/// (solvers/integrators, "Reduced coordinates")
class TreeDynamics {
 public:
  /// The world must live on, with the topology that it has.
  /// @throws std::invalid_argument for a joint that closes a loop or has more than two bodies, is soft, or
  /// has limits, a motor, friction or a spring on an axis.
  explicit TreeDynamics(const World& world);
  ~TreeDynamics();

  /// Number of speeds u.
  int freedoms(const State& state) const;
  /// V̇ of all bodies, 0 for fixed ones, by recursion from the leaves to the roots and back: articulated
  /// bodies in O(n) [Featherstone2008]; b adds Xᵀ (I − I S (Sᵀ I S)⁻¹ Sᵀ I) X to the inertia I of its parent.
  std::vector<Twist> recursive(const State& state) const;
  /// V̇ of all bodies by Lagrange's equations H u̇ = Gᵀ (f − M a₀), H = Gᵀ M G dense, a = G u̇ + a₀: O(n³).
  std::vector<Twist> lagrangian(const State& state) const;

 private:
  class Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace taut
