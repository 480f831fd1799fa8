#pragma once

#include <span>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/complementarity/contact_islands.h"
#include "solvers/complementarity/contact_solver.h"
#include "solvers/complementarity/stage_accuracy.h"
#include "solvers/complementarity/stage_attempt.h"
#include "solvers/complementarity/stage_culprits.h"
#include "solvers/complementarity/stage_pivoting.h"
#include "solvers/complementarity/stage_primal.h"
#include "solvers/complementarity/stage_residual.h"
#include "solvers/complementarity/stage_tuning.h"
#include "solvers/complementarity/stage_warm_start.h"
#include "solvers/laws/axes/axis_forces.h"
#include "solvers/laws/contact_forces.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// Solves the stages of a step: impulses λ and rates w = S λ + b with a law for each row, joints as
/// equalities among them.  What the laws depend on beside the rates (static friction that lets go, loads,
/// tangents of tables, slip directions of contacts) is looked at after each solve, and the stage is solved
/// again with renewed laws until it stays.
///
/// A stage goes down a ladder: the last impulses as they are, or with one linear solve where contacts stick
/// (StageWarmStart); without contacts the active set on the factor of S (StagePivoting), then through the
/// bodies (StagePrimal); contacts through the bodies, island by island (ContactSolver). The rungs remember
/// what worked last. (solvers/complementarity, "Ladder", "Natural residual")
class StageSolver {
 public:
  static constexpr int kExactSolves = StageTuning::kExactSolves;
  static constexpr double kRatePart = StageTuning::kRatePart;
  using Stage = taut::Stage;
  using Renew = Stage::Renew;

  StageSolver(const World& world, ConstraintSystem& system, AxisForces& axes, ContactForces& contacts,
              const Settings& settings);

  /// Residual up to which the laws of a stage are taken as met when Newton's method has spent its steps,
  /// which are few if the steps before were hard; 0: none beyond its own.
  void accept_inexact(double residual, bool reduced_budget) { budget_ = {residual, reduced_budget}; }
  /// Rows of the system are others; row r was `from[r]`, −1: new.
  void move_rows(std::span<const int> from);
  /// The next solve starts from its guess.
  void forget_segments() { pivoting_.active_set().reset(); }

  // What kind of system it is.
  bool iterative() const { return model_.settings.solver != Solver::kDirect; }
  /// Rows have laws of their own, or are to be solved one by one.
  bool bounded() const { return iterative() || !model_.axes.empty() || !model_.contacts.empty(); }
  /// So many axes rub that the bodies are the system, and nothing else.
  bool friction_dominated() const { return model_.friction_dominated(); }
  /// Stages ask for the factor of S, if they do, themselves.
  bool factors_on_demand() const { return !model_.contacts.empty() || model_.system.uses_primal_system(); }

  // Before a solve.
  /// Forgets what was noted in the last advance.
  void begin_advance();
  void renew_effective_masses() { model_.system.effective_masses(effective_mass_); }
  std::span<const double> effective_mass() const { return effective_mass_; }  ///< 1 / S_rr
  std::vector<RowLaw>& laws() { return laws_; }
  const std::vector<RowLaw>& laws() const { return laws_; }
  /// Laws of the rows of joints that have none of their own.
  void set_equalities();
  /// Tells the system which rows will have to be factored if the segments stay what they are.
  void prepare(std::span<const double> b, std::span<const double> lambda) {
    pivoting_.active_set().prepare(laws_, b, lambda);
  }
  /// prepare() with the b of the last solve.
  void prepare(std::span<const double> lambda) { prepare(b_, lambda); }

  // Solves.
  /// Rates that are off by no more than the tolerance count as right.
  StageEnd solve(const Stage& stage, double rate_tolerance, SubstepReport& report);
  /// To what round-off allows where the tolerance of velocities lets too much pass; inexactly where that may
  /// be.
  bool solve_velocities(const Stage& stage, SubstepReport& report);
  /// So many sweeps of the iterative solver; false if a number is not finite.  `absorbed`: momentum that
  /// bodies held fast did not take in.
  bool iterate(const Stage& stage, int sweeps, double rate_tolerance, std::span<Wrench> absorbed,
               SubstepReport& report);

  // After a solve.
  std::span<const double> rates() const { return w_; }
  /// How far the motion is from the laws [m or rad] in a step of h.
  double motion_residual(std::span<const double> lambda, std::span<const double> rates, double h) const {
    return residual_.motion(solution(lambda, rates), h);
  }
  /// The natural residual over its tolerance; 0 if no better solution is known.
  double residual_over_tolerance(std::span<const double> lambda, std::span<const double> w) const;
  /// Rates that laws may be missed by where the tolerances of positions and velocities have let too much
  /// pass.
  double exact_tolerance() const { return residual_.exact_rate_tolerance(); }
  /// The laws are not met any better than by this part of residual_over_tolerance().  False if that is not
  /// enough for an inexact step.
  bool take_inexact(double off);
  /// A stage is done, inexactly perhaps.
  void note_inexact(std::span<const double> lambda, std::span<const double> rates);
  void note_residual(std::span<const double> lambda, std::span<const double> rates) {
    accuracy_.note_natural(residual_.natural(solution(lambda, rates)));
  }
  void note_culprits(std::span<const double> lambda, std::span<const double> w) {
    culprits_.find(residual_, solution(lambda, w));
  }
  /// What the stages ended with, for a sub-step that is kept.
  void report_residuals(SubstepReport& report) const;

  /// How far stages are from their laws; to be told when a stage begins.
  StageResidual& residual() { return residual_; }
  /// What the stages of this advance ended with.
  StageAccuracy& accuracy() { return accuracy_; }
  const StageAccuracy& accuracy() const { return accuracy_; }
  /// Who was furthest from the laws of a stage that could not be solved, or was solved inexactly, and who
  /// jams.
  StageCulprits& culprits() { return culprits_; }
  /// How the last active set went.
  const ActiveSetOutcome& active_set_outcome() const { return pivoting_.outcome(); }
  /// Threads that could not be started.
  int missing_threads() const { return islands_.missing_threads(); }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);
  void transfer_factors(Archive& archive);

 private:
  void rates_without(const Stage& stage);
  StageVerdict judge(StageAttempt& attempt, const StageRecord& record, bool solved, int solves);
  StageSolution solution(std::span<const double> lambda, std::span<const double> w) const {
    return {laws_, b_, effective_mass_, lambda, w};
  }

  StageModel model_;
  StageBudget budget_;
  std::vector<RowLaw> laws_;
  std::vector<double> b_, w_, effective_mass_;
  StageResidual residual_;
  StageAccuracy accuracy_;
  StageCulprits culprits_;
  ContactSolver contact_solver_;
  ContactIslands islands_;
  StagePivoting pivoting_;
  StageWarmStart warm_start_;
  StagePrimal primal_;
};

}  // namespace taut
