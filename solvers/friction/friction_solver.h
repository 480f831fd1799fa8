#pragma once

#include <array>
#include <optional>

#include "solvers/friction/friction_problem.h"

namespace taut {

/// What is asked of solve_friction().
struct FrictionSettings {
  double accuracy = 1e-8;  ///< of FrictionErrors; positive
};

/// How a problem ended.
enum class FrictionStatus {
  kSolved,      ///< to the accuracy
  kNoSolution,  ///< none exists: `certificate` shows it
  kInexact,     ///< no rung met the laws; `errors` says by how much
};

/// Rungs of the ladder, in their order.                                   (solvers/friction, "Rungs")
enum class FrictionRung { kGuess, kSweeps, kInteriorPoint, kManySweeps, kPath };
/// Their names, as in reports.
inline constexpr std::array<const char*, 5> kFrictionRungNames{"guess", "sweeps", "interior point",
                                                               "many sweeps", "path"};

/// What solve_friction() has found, and what that took.
struct FrictionResult {
  FrictionStatus status = FrictionStatus::kInexact;  ///< how it ended
  Eigen::VectorXd r;                                 ///< impulses, in the rows of the problem
  FrictionErrors errors;                             ///< of r
  FrictionRung rung = FrictionRung::kGuess;          ///< the one whose impulses these are
  std::array<int, 5> tried{};                        ///< how often each rung was tried
  int factorisations = 0;                            ///< of Newton's and of interior points' matrices
  int sweeps = 0;                                    ///< over all blocks
  double seconds = 0;                                ///< of wall time
  /// d with W d = 0, d_N ≥ 0, d_T = 0 and d·q < 0, where there is no solution: normals that close however
  /// large the impulses.
  std::optional<Eigen::VectorXd> certificate;
};

/// Impulses r that meet equalities, Signorini's and Coulomb's law together.
/// `guess`: impulses near by, as those of the step before.
/// @throws std::invalid_argument naming what of the problem has another size, is not finite or negative; if
/// the guess has another size or is not finite; or if a setting is out of range.
FrictionResult solve_friction(const FrictionProblem& problem, const FrictionSettings& settings = {},
                              const Eigen::VectorXd* guess = nullptr);

}  // namespace taut
