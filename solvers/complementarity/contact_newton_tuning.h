#pragma once

namespace taut {

/// Constants of the Newton method for contacts.  Without a unit: parts and counts; ρ is Σ over S_rr.  What
/// was measured is in solvers/HISTORY.md, "Complementarity", under "Many contacts"; the rest is chosen.  What
/// half and twice of each change is in benchmarks/results/tuning.md, and here where it is more than twice the
/// work of a scene. (solvers/complementarity, "Many contacts")
struct ContactNewtonTuning {
  /// ρ of equalities: less than all others, so that contacts give way where they and joints ask for slightly
  /// different rates.
  static constexpr double kEqualityRho = 1e-9;
  /// ρ at first: so many times the residual of the guess, from kNearRho to kFirstRho.
  /// kRhoOfResidual: half lets a pile that falls asleep sink in deeper.
  /// kFirstRho: half and twice take 2.4 times the Newton steps of a card house, and down to a quarter of
  /// those of stacks.
  static constexpr double kRhoOfResidual = 100, kNearRho = 1e-4, kFirstRho = 1e-2;

  // Ends of a round.
  /// Newton's equation is met to this part of the residual of the round before (or of itself, if that is
  /// more), and never better than to the second, of the scale: round-off.  kForcing: half lets a pile that
  /// falls asleep sink in deeper.
  static constexpr double kForcing = 0.01, kLeastGradient = 1e-13;
  /// Gradients below this part of the scale may be round-off, and are if so many steps leave more than the
  /// third of them.  kStuck: half takes 2.5 times the Newton steps of shapes on a mesh.
  static constexpr double kDescentRoundOff = 1e-8, kStuckPart = 0.5;
  static constexpr int kStuck = 2;
  /// Newton steps of a round, and how far its gradient may grow.  Measured: 40 steps take
  /// up to twice as many in all.
  static constexpr int kStepsPerRound = 20;
  static constexpr double kBlowUp = 10;
  /// Trials of the line search; a step is taken whole if the slope at its end is at most this part of that at
  /// its start.  Twice: 2.1 times the back-solves of boxes squeezed between walls.
  static constexpr int kSearches = 12;
  static constexpr double kSlope = 0.5;

  // Ends of the method.
  /// Newton steps at most.
  static constexpr int kMostSteps = 500;
  /// Rounds after which equalities are met, as far as they can be: what they leave does not count.
  static constexpr int kEqualityRounds = 3;
  /// Before `most` is enough in any case, equalities are to be met to so many times the tolerance of rates.
  static constexpr double kEqualityRates = 9;
  /// Rounds that leave more than this of the residual are slow, after so many: then `most` is enough.
  static constexpr double kSlowRound = 0.3;
  static constexpr int kFirstRounds = 3;
  /// Rounds after which `most` is enough however fast they are.
  static constexpr int kPatience = 12;
  /// Rounds may need no Newton step: so many for each that is allowed.
  static constexpr int kRoundsOfAStep = 10;
  /// After so many rounds the slip of contacts that can hold falls to less than this part in each.
  static constexpr int kRoundsToHold = 3;
  static constexpr double kSlowSlip = 0.97;

  // How rounds go on.
  /// A round is kept if its Newton method ended and the residual grew by no more than kWorse, or if the
  /// residual fell to kWell anyway.
  static constexpr double kWorse = 3;
  /// How ρ falls after a round that went well (to kWell of the residual) or fast (to kFast, and ρ by as
  /// much), and grows after one that was taken back.  Measured: to 0.05 or 0.1 in place of kDown takes twice
  /// the steps and leaves some stages unsolved.  kFast: half takes 3 times the factorisations of a card
  /// house.
  static constexpr double kDown = 0.3, kUp = 3, kWell = 0.7, kFast = 0.1;
  /// Its bounds.  Measured: 1e-9 as the least takes no fewer steps; 1e-6 fails where bodies wedge; with 1e-2
  /// as the most, a pile of 1000 that goes on from a file is given up.
  static constexpr double kLeastCoupledRho = 1e-8, kMostRho = 1;
  /// Rigid contacts whose impulses have grown to more than so many times all that acts, yield after a round
  /// with this ρ or less that has changed the residual by less than this part.
  static constexpr double kTooMuch = 1.5, kRhoToYield = 1e-5, kStalled = 0.1;
  /// Rounds that must go well after one that was taken back, before ρ falls again.
  static constexpr int kHold = 3;
  /// Every so many rounds the residual must have fallen to kProgress.
  static constexpr int kLook = 12;
  static constexpr double kProgress = 0.5;
  /// Part of the coupling N that is kept at least, where with all of it the step does not go down.
  static constexpr double kLeastPart = 0.25;

  // GMRES [SaadSchultz1986].
  /// Vectors at most, and part of the right side that is left.  Measured: to 0.1 takes half the back-solves,
  /// but more Newton steps.
  static constexpr int kMostVectors = 80;
  static constexpr double kLinear = 1e-3;
  /// A new vector that is shorter is round-off.
  static constexpr double kBreakdown = 1e-14;
};

}  // namespace taut
