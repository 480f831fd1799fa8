#pragma once

namespace taut {

/// Constants by which steps are divided.  Chosen, where nothing else is said.  What half and twice of each
/// change is in benchmarks/results/tuning.md.  (solvers/simulator, "Sub-steps")
struct SubstepTuning {
  /// A sub-step that failed is followed by one this part as long; each success lets the next be so many times
  /// longer.  kShrink: twice, which does not shorten, fails; kGrow: half takes 2.1 times the position solves
  /// of bodies that come to rest after an impact.
  static constexpr double kShrink = 0.5, kGrow = 1.5;
  /// A count of sub-steps that is above a whole number by less than this is that number.
  static constexpr double kCountRoundOff = 1e-9;
  /// Steps in a row that ask for fewer sub-steps before there are fewer: a symplectic scheme keeps its energy
  /// only while its step stays the same.
  static constexpr int kQuietSteps = 300;

  // Laws that are hard to meet.
  /// They may be met inexactly in sub-steps below this part of the step.
  static constexpr double kHardPart = 0.6;
  /// Steps after one with inexact laws in which they may be inexact in any sub-step.
  static constexpr int kReducedBudgetSteps = 10;
};

}  // namespace taut
