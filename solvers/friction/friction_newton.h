#pragma once

#include "solvers/friction/best_impulses.h"

namespace taut {

/// γ and ρ in units of the mean diagonal of a block; counts of steps.
struct FrictionNewtonWays {
  static constexpr double kGammaOfGuess = 1;  ///< near a solution
  static constexpr double kGammaOfRung = 30;  ///< from where sweeps, an interior point or a path have ended
  static constexpr double kRho = 1e-6, kRhoOfRound = 1e-4;                       ///< at first
  static constexpr int kSteps = 20, kStepsOfRound = 10, kStepsOfGuess = 8;       ///< at most
  static constexpr int kMemory = 10, kMemoryOfGuess = 4;                         ///< steps
  static constexpr int kPatience = 6, kPatienceOfRound = 8, kPatienceOfTry = 4;  ///< idle steps
};

/// Semismooth Newton on
///     G(r) = r − A(r − γ u),   A(x) = (max(0, x_n), x_t cut off at μ max(0, x_n)) (solvers/friction, Eq. 4)
/// [AlartCurnier1991], whose steps are those of W + ρ 1, which bounds them where W is singular.
struct FrictionNewton {
  double gamma;  ///< of (4), in units of the mean diagonal of a block
  double rho;    ///< at first; falls with full steps, grows with failed ones
  int steps;     ///< at most
  int memory;    ///< |G| may grow over that of so many steps before
  int patience;  ///< steps that bring nothing; then it ends

  /// From a guess that is near, or is given up soon.
  static constexpr FrictionNewton from_guess() {
    using Ways = FrictionNewtonWays;
    return {Ways::kGammaOfGuess, Ways::kRho, Ways::kStepsOfGuess, Ways::kMemoryOfGuess, Ways::kPatienceOfTry};
  }
  /// As the end of a rung.
  static constexpr FrictionNewton at_end() {
    using Ways = FrictionNewtonWays;
    return {Ways::kGammaOfRung, Ways::kRho, Ways::kSteps, Ways::kMemory, Ways::kPatience};
  }
  /// Now and then on the way of a rung, which goes on where this does not end soon.
  static constexpr FrictionNewton on_the_way() {
    using Ways = FrictionNewtonWays;
    return {Ways::kGammaOfRung, Ways::kRho, Ways::kStepsOfGuess, Ways::kMemory, Ways::kPatienceOfTry};
  }
  /// Between sweeps.
  static constexpr FrictionNewton in_rounds(double gamma) {
    using Ways = FrictionNewtonWays;
    return {gamma, Ways::kRhoOfRound, Ways::kStepsOfRound, Ways::kMemory, Ways::kPatienceOfRound};
  }

  /// From r on, until `best` is met to a hundredth of its accuracy or nothing is gained.  Returns the last
  /// iterate.
  Eigen::VectorXd solve(const ScaledFriction& problem, Eigen::VectorXd r, BestImpulses& best) const;
};

}  // namespace taut
