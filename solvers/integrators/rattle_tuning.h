#pragma once

namespace taut {

/// Constants of RATTLE's two projections.  Without a unit: parts and counts.  Chosen, unless something else
/// is said.  What half and twice of each change is in benchmarks/results/tuning.md. (solvers/integrators,
/// "RATTLE", "Weak directions")
struct RattleTuning {
  // Newton's method on positions.
  /// An iteration that leaves more than this part of the gap is slow: the factor is made anew, or other means
  /// are tried.  Twice: 5 times the position solves where a body of 5 t hangs on one of 1e-7 kg.
  static constexpr double kSlowNewton = 0.6;
  /// One that makes the gap so many times larger is given up at once.
  static constexpr double kDiverging = 10;
  /// With dependent rows positions count as closed only if no body is further than this part of the size of
  /// the whole system from where its joints want it: a weakly held direction hides a long way behind a small
  /// gap.
  static constexpr double kFarOpen = 1e-9;
  /// Gaps below this [m or rad] may be closed by moving the bodies, without an impulse.
  static constexpr double kMendable = 1e-6;

  // The tension limit.
  /// Multipliers off their prediction by more than this part of the largest are checked against the limit
  /// before they are accepted.
  static constexpr double kSurprise = 0.25;
  /// How many times the limit a step may then be: the limit itself has a safety factor of about 3 against
  /// instability at ω h = 2.
  static constexpr double kLeeway = 1.5;

  // Limits, friction and contacts.
  /// Part of the position tolerance that many axes with friction leave alone.
  static constexpr double kSlack = 0.25;
  /// Solves beyond max_newton_iterations, in which laws come to their segments.
  static constexpr int kMoreSolves = 4;
  /// After so many solves, gaps that surfaces open as they turn are closed if they are to so many times the
  /// tolerance: many contacts that wedge a body share their load anew in each solve, by what laws are met to.
  /// kLateCurved: half lets piles sink in deeper.
  static constexpr int kManySolves = 3;
  static constexpr double kLateCurved = 10;
  /// The second kick gives energy if it is more than this part of what its contact impulses would give bodies
  /// at rest, row by row: at rest all else is round-off of gaps.
  static constexpr double kGivenPart = 1e-6;

  // Iterative solvers.
  /// Sweeps after which positions are looked at again: rows are linear in impulses, positions are
  /// not.  Half: twice the position solves.
  static constexpr int kSweepsPerPass = 10;
};

}  // namespace taut
