#pragma once

namespace taut {

/// Constants of the methods for stages with contacts beside those of ContactNewtonTuning.  Without a unit:
/// parts of the largest impulse, and counts.  Chosen, where nothing else is said.  What half and twice of
/// each change is in benchmarks/results/tuning.md, and here where it is more than twice the work of a scene.
/// (solvers/complementarity, "Ladder", "Islands")
struct ContactSolverTuning {
  /// The last impulses, if they do not meet their laws, are mended where they are off by no more than this
  /// part.
  static constexpr double kNear = 1e-3;
  /// Contacts whose guess is further off than kNear are first swept so often, or until no impulse changes by
  /// more than that part of the largest.  A sweep costs 1/8 of a Newton step.  Measured on piles of 40 to 100
  /// bodies, a wall and a tank: 300, 150, 75, 40, 20 and no sweeps take 15.2, 11.7, 10.1, 9.6, 10.7 and 17.5
  /// s (solvers/HISTORY.md, "Complementarity").  Twice: 2.4 times the back-solves of a card house, a quarter
  /// of those of a wall.
  static constexpr int kFirstSweeps = 50;
  static constexpr double kSwept = 1e-10;
  /// Σ over S_rr where contacts are locked: impulses that mend what dependent rows contradict each other by
  /// are at most so many times larger.  Half and twice: 3.5 and 2.8 times the factorisations of a card
  /// house.
  static constexpr double kLockedSoftness = 1e-2;
  /// Sweeps where Newton's method was not enough.
  static constexpr int kLastSweeps = 1000;
  /// Newton steps in which contacts that stick are to find a division of the load that holds them.
  static constexpr int kStepsToHold = 150;
  /// More solves because static friction let go.
  static constexpr int kMaxSolves = 40;
  /// Rows of islands beyond the largest one from which on threads pay.
  static constexpr int kRowsForThreads = 120;
};

}  // namespace taut
