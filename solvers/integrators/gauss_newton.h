#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "solvers/integrators/body_moves.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// Gauss–Newton on positions alone, in the mass metric, a least move of the bodies in each step:
///
///     q ← q ⊕ (−M⁻¹ Jᵀ S⁺ φ),   all of it at q                               (solvers/integrators, Eq. 6)
///
/// It converges quadratically, also along directions that the rows hold weakly, where a fixed J does not.
/// What is closed, how far, and when it is given up is for its caller:
///
///     ask(δ)        δ = −φ of the present poses; false: they are left as they are
///     factorize()   the factor of S there; false likewise
///     solve(δ)      δ ← S⁺ δ
///
/// No body turns by more than `longest_turn` [rad] in a step, and none is made that is not finite.  `at`
/// looks at `poses`; `delta` and `move` are room for an entry a row and a body.  @returns how many steps were
/// made.
template <typename Ask, typename Factorize, typename Solve>
int gauss_newton(ConstraintSystem& system, const Configuration& at, std::span<Pose> poses,
                 double longest_turn, std::span<double> delta, std::span<Wrench> move, const Ask& ask,
                 const Factorize& factorize, const Solve& solve) {
  int steps = 0;
  for (; ask(delta); ++steps) {
    system.linearize(at);
    system.set_mass(poses);
    if (!factorize()) break;
    solve(delta);
    system.rows().apply_transpose(system.jacobian(), delta, move);
    const double turn = largest_turn(system.mass(), move, poses);
    if (!std::isfinite(turn)) break;
    move_bodies(system.mass(), move, std::min(1.0, longest_turn / std::max(turn, 1e-300)), poses);
  }
  return steps;
}

}  // namespace taut
