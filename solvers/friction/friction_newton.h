#pragma once

#include "solvers/friction/best_impulses.h"

namespace taut {

/// Semismooth Newton on
///     G(r) = r − A(r − γ u),   A(x) = (max(0, x_n), x_t cut off at μ max(0, x_n)) (solvers/friction, Eq. 4)
/// [AlartCurnier1991], whose steps are those of W + ρ 1, which bounds them where W is singular.
struct FrictionNewton {
  double gamma = 1;   ///< of (4), in units of the mean diagonal of a block
  double rho = 1e-6;  ///< at first; falls with full steps, grows with failed ones
  int steps = 20;     ///< at most
  int memory = 4;     ///< |G| may grow over that of so many steps before
  int patience = 6;   ///< steps that bring nothing; then it ends

  /// From r on, until `best` is met to a hundredth of its accuracy or nothing is gained.  Returns the last
  /// iterate.
  Eigen::VectorXd solve(const ScaledFriction& problem, Eigen::VectorXd r, BestImpulses& best) const;
};

}  // namespace taut
