#pragma once

#include "solvers/friction/best_impulses.h"

namespace taut {

/// Interior points on  z = Dᵀ(W r + q) + |z_T| n,  r = D y,  y ∘ z → 0, with the slip |z_T| linearised like
/// all else; predictor and corrector [Mehrotra1992].  Returns the impulses that were nearest to the laws;
/// ends at 1e-6, from where Newton goes on.                                        (solvers/friction, Eq. 5)
Eigen::VectorXd interior_point(const ScaledFriction& problem, BestImpulses& best);

/// The equations of interior_point() with their right sides and the smoothing of |z_T| times τ, from the
/// start, which meets them with τ = 1, to τ → 0: a curve that is followed by its length, so that it may turn
/// back in τ.
///                                                   (solvers/friction, "Path of last resort")
Eigen::VectorXd follow_path(const ScaledFriction& problem, BestImpulses& best);

}  // namespace taut
