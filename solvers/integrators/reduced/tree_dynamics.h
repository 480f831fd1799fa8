#pragma once

#include <memory>
#include <span>

#include "core/world/world.h"

namespace taut {

/// The motion of a world in reduced coordinates, with no S in it.  What acts along axes is left out.
///
/// The joints of body b with its parent p have the rows J_p a_p + J_b a_b + γ = 0, which leave
///
///     a_b = X a_p + c + N u̇,    X = −J_b⁺ J_p,   c = −J_b⁺ γ,   N = null space of J_b     (1)
///
/// where a = (ω̇, v̇) in world axes about the centre of mass and u are the joints' own speeds.  Joints that
/// close loops, or have more than two bodies, are cut: their rows have multipliers of their own, c in all.
/// (solvers/integrators, "Reduced coordinates")
class TreeDynamics {
 public:
  /// How accelerations are found.
  enum class Method {
    kRecursive,  ///< from the leaves to the roots and back, articulated bodies in O(n) [Featherstone2008];
                 ///< with c rows of loops O(c n + c³)
    kLagrangian,  ///< Lagrange's equations H u̇ = Gᵀ (f − M a₀), H = Gᵀ M G, a = G u̇ + a₀: dense, O(n³)
  };

  /// For states of this world with the topology and masses that it has now; it is not needed any more then.
  explicit TreeDynamics(const World& world);
  ~TreeDynamics();
  TreeDynamics(const TreeDynamics&) = delete;
  TreeDynamics& operator=(const TreeDynamics&) = delete;

  /// (1), without c, at a state.  What follows refers to that.
  void linearize(const State& state);
  /// Number of speeds u, of which joints that are cut leave fewer.
  int freedoms() const;
  /// V̇ of all bodies under these wrenches, one a body; 0 for fixed ones.
  void accelerate(const State& state, std::span<const Wrench> forces, Method method,
                  std::span<Twist> accelerations);
  /// Forces λ [N, N·m] of the equality rows of a joint, in their order, that make the last accelerations: Jᵀλ
  /// is the wrench of the joint on its bodies.
  std::span<const double> multipliers(JointId joint) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taut
