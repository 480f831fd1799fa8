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

/// Constants of the Newton methods of the rungs: γ and ρ as in FrictionNewton, and counts.  Chosen.  What
/// half and twice of each change is in benchmarks/results/tuning.md.
struct RungNewtonTuning {
  /// γ, in units of the mean diagonal of a block.
  static constexpr double kGamma = 30;
  /// ρ at first, and in rounds.
  static constexpr double kRho = 1e-6, kRhoOfRounds = 1e-4;
  /// Steps at most: on the way, in rounds, and at the end.  kStepsOfRounds: half leaves a pile of rocks
  /// inexact.
  static constexpr int kFewSteps = 8, kStepsOfRounds = 10, kStepsAtEnd = 20;
  /// Steps over which |G| may grow.
  static constexpr int kMemory = 10;
  /// Steps that bring nothing: on the way, in rounds, and at the end.  kIdleOfRounds: half leaves a pile of
  /// rocks inexact.
  static constexpr int kFewIdle = 4, kIdleOfRounds = 8, kIdleAtEnd = 6;
};

/// Between sweeps, with one γ or another.
inline constexpr FrictionNewton kNewtonOfRounds{.gamma = RungNewtonTuning::kGamma,
                                                .rho = RungNewtonTuning::kRhoOfRounds,
                                                .steps = RungNewtonTuning::kStepsOfRounds,
                                                .memory = RungNewtonTuning::kMemory,
                                                .patience = RungNewtonTuning::kIdleOfRounds};
/// From a guess that is near, and now and then on the way of a rung, which goes on where this does not end
/// soon.
inline constexpr FrictionNewton kNewtonOnTheWay{.gamma = RungNewtonTuning::kGamma,
                                                .rho = RungNewtonTuning::kRho,
                                                .steps = RungNewtonTuning::kFewSteps,
                                                .memory = RungNewtonTuning::kMemory,
                                                .patience = RungNewtonTuning::kFewIdle};
/// Where an interior point or a path has ended.
inline constexpr FrictionNewton kNewtonAtEnd{.gamma = RungNewtonTuning::kGamma,
                                             .rho = RungNewtonTuning::kRho,
                                             .steps = RungNewtonTuning::kStepsAtEnd,
                                             .memory = RungNewtonTuning::kMemory,
                                             .patience = RungNewtonTuning::kIdleAtEnd};

}  // namespace taut
