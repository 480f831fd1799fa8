#pragma once

#include "solvers/friction/best_impulses.h"

namespace taut {

/// Semismooth Newton on
///     G(r) = r − A(r − γ u),   A(x) = (max(0, x_n), x_t cut off at μ max(0, x_n)) (solvers/friction, Eq. 4)
/// [AlartCurnier1991], whose steps are those of W + ρ 1, which bounds them where W is singular.
struct FrictionNewton {
  double gamma;  ///< of (4), in units of the mean diagonal of a block
  double rho;    ///< at first; falls with full steps, grows with failed ones
  int steps;     ///< at most
  int memory;    ///< |G| may grow over that of so many steps before
  int patience;  ///< steps that bring nothing; then it ends

  /// From r on, until `best` is met to a hundredth of its accuracy or nothing is gained.  Returns the last
  /// iterate.
  Eigen::VectorXd solve(const ScaledFriction& problem, Eigen::VectorXd r, BestImpulses& best) const;
};

/// From a guess that is near, or is given up soon.
inline constexpr FrictionNewton kNewtonFromGuess{
    .gamma = 1, .rho = 1e-6, .steps = 8, .memory = 4, .patience = 4};
/// Between sweeps, with one γ or another.
inline constexpr FrictionNewton kNewtonOfRounds{
    .gamma = 30, .rho = 1e-4, .steps = 10, .memory = 10, .patience = 8};
/// Now and then on the way of a rung, which goes on where this does not end soon.
inline constexpr FrictionNewton kNewtonOnTheWay{
    .gamma = 30, .rho = 1e-6, .steps = 8, .memory = 10, .patience = 4};
/// Where an interior point or a path has ended.
inline constexpr FrictionNewton kNewtonAtEnd{
    .gamma = 30, .rho = 1e-6, .steps = 20, .memory = 10, .patience = 6};

}  // namespace taut
