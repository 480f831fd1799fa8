#pragma once

namespace taut {

/// Constants of the ladder that stages go down, and of what counts as solved.  Without a unit: parts and
/// counts.  Chosen, where nothing else is said.  What half and twice of each change is in
/// benchmarks/results/tuning.md, and here where it breaks something or is more than twice the work of a
/// scene.  (solvers/complementarity, "Ladder", "Natural residual")
struct StageTuning {
  /// Solves more where contacts met their laws within a tolerance of rates only.  One
  /// less: bodies that come to rest after an impact are solved inexactly.
  static constexpr int kExactSolves = 2;
  /// Part of the tolerances of positions, over h, and of velocities up to which rates of a stage count as
  /// right.  Twice: 3 times the factorisations of a card house, and a pile that falls asleep
  /// sinks in deeper.
  static constexpr double kRatePart = 0.1;

  // What is met, beside the natural residual.
  /// Impulses on a level of their law are right to this part of the largest.
  static constexpr double kLevelTolerance = 1e-9;
  /// How many times what round-off of poses and twists makes of rates is let be where contacts are off their
  /// laws.
  static constexpr double kNoises = 10;

  // Warm start.
  /// Impulses that are off their laws by no more than ContactSolverTuning::kNear are mended by so many
  /// sweeps, if that is enough.
  static constexpr int kWarmStartSweeps = 50;

  // Active set.
  /// More solves of a stage, because friction let go or velocities were not yet exact.
  static constexpr int kMaxAxisSolves = 40;
  /// Bounded rows from which on an active set that stalls is not descended from: the bodies are faster.
  static constexpr int kManyRows = 60;

  // Through the bodies.
  /// Solves of a stage, because friction let go or the load that it grows by has changed.
  static constexpr int kMaxRenewals = 40;
  /// Without contacts Newton's method starts where the laws are off by no more than this part, for so many
  /// steps: then it has few rows to put on other segments.
  static constexpr double kNewtonRange = 1e-5;
  static constexpr int kFewSteps = 8;
  /// What that leaves where positions were looked at again: round-off.
  static constexpr double kExactTolerance = 1e-13;
  /// Newton steps where those of the step before were not enough.
  static constexpr int kReducedSteps = 300;

  // Messages.
  /// Part of the largest impulse that those who jam have.
  static constexpr double kJamShare = 1e-3;
  /// Culprits at most, and the part of the first one's residual that the others have.
  static constexpr int kMostCulprits = 4;
  static constexpr double kCulpritShare = 0.01;
};

}  // namespace taut
