#pragma once

#include <span>

#include "solvers/integrators/body_moves.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// Right-hand side of the acceleration equation, of which multipliers [N or N·m] are the solution:
///
///     S λ = −(γ + J V̇),   V̇ = M⁻¹ (f − ω × Iω) of the bodies without joints
///
/// at a state at which the system is linearised.  `accelerations` get V̇, an entry a body, `rates` J V̇, an
/// entry a row.
inline void acceleration_right_side(const ConstraintSystem& system, const State& state,
                                    std::span<const Wrench> forces, std::span<Twist> accelerations,
                                    std::span<double> rates, std::span<double> right) {
  free_accelerations(system.mass(), state, forces, accelerations);
  system.rows().bias(state, state.twists, right);
  system.rows().apply(system.jacobian(), accelerations, rates);
  for (std::size_t r = 0; r < right.size(); ++r) right[r] = -(right[r] + rates[r]);
}

}  // namespace taut
