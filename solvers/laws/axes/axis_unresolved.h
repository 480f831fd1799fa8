#pragma once

#include <span>

#include "solvers/laws/axes/axis_law.h"
#include "solvers/laws/axes/axis_table.h"

namespace taut {

class ConstraintSystem;

/// Finds springs and soft limits of axes that are too stiff for a step of h, and the excess of each over the
/// midpoint rule, AxisSpringLaw::excess; at the start of the step, with the system where its impulses act.
/// (solvers/laws, "Axes")
///
/// The midpoint rule keeps the energy of a spring as long as S_rr is the same in both kicks.  Elsewhere
/// directions and levers turn with the bodies, and λ²(S₁ − S₀)/2 is work that no potential returns: where
/// h²k > m, so that λ is as large as the momentum, a part (S₁ − S₀)/S of the spring's energy in each step.
/// The excess η of (solvers/laws, Eq. 3) is a force from nearer the end of the step in the first kick and an
/// implicit damper in the second.  For h²k/m → ∞ both eigenvalues of a step tend to 0, and with S constant
/// the energy changes by
///
///     −Σ (2 η w² + η θ̇₁²) − ½ (η θ̇₁)ᵀ S (η θ̇₁) ≤ 0,
///
/// so that η may differ from step to step and from axis to axis.  Its second bound lets an axis that is
/// stretched by d ≥ d₁ return by no more than d₁, however short the step: the midpoint rule would go as far
/// beyond the rest, and Newton's method does not follow bodies around within a step.  η acts on rates alone,
/// so what rests on such a spring has no velocity.  What η takes is recorded as integration.  Where the
/// effective mass is constant (one freedom against a fixed body, springs between centres) the midpoint rule
/// stays.
///
/// @returns whether some of those of Moreau–Jean, `single_kick`, need the end of the step (ϑ = 1).
bool find_unresolved(const AxisTable& table, std::span<AxisLaw> axes, double h, ConstraintSystem& system,
                     bool single_kick);

}  // namespace taut
