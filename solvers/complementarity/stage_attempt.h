#pragma once

#include <algorithm>
#include <functional>
#include <span>

#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/complementarity/stage_problem.h"
#include "solvers/laws/axes/axis_forces.h"
#include "solvers/laws/contact_forces.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// One stage, as an integrator wants it solved.  `lambda`: a guess, then the result; `rates`: those that the
/// guess gives.
struct Stage {
  /// Recomputes the laws from the present rates and from what AxisForces and ContactForces know.
  using Renew = std::function<void()>;

  std::span<double> lambda, rates;
  const Renew& renew;
  bool near = false;   ///< this stage was solved at a neighbouring state
  bool exact = false;  ///< laws are to be met to what round-off allows, where they can
};

/// What a stage has come to: it could not be solved, it is, or its guess solves it and stays as it is.
enum class StageEnd { kFailed, kSolved, kUnchanged };

/// The system of stages, and the axes and contacts whose laws its rows have.
struct StageModel {
  ConstraintSystem& system;
  AxisForces& axes;
  ContactForces& contacts;
  const Settings& settings;

  /// So many axes rub that the bodies are the system, and nothing else.
  bool friction_dominated() const { return contacts.empty() && system.uses_primal_system(); }
  /// Tells axes of a solution.  True if what laws depend on beside the rates has changed with it: friction
  /// lets go, its load or the tangents of tables are others.
  bool move_laws(const StageProblem& solved, double rate_tolerance) const {
    return axes.laws_move(system, solved.lambda, solved.w, rate_tolerance);
  }
};

/// What may be spent on a stage, and what is enough at last.
struct StageBudget {
  double inexact = 0;    ///< residual up to which laws count as met when all else has failed; 0: none
  bool reduced = false;  ///< few Newton steps: those of the steps before were not enough either
};

/// What a rung of the ladder makes of a stage: it is solved, or cannot be solved, or is left to the next
/// rung.
enum class StageVerdict { kMet, kFailed, kNext };

/// A stage on its way down the ladder.
struct StageAttempt {
  const Stage& stage;
  std::span<const RowLaw> laws;  ///< renewed by stage.renew()
  std::span<double> b;
  std::span<const double> effective_mass;  ///< 1 / S_rr
  std::span<double> w;
  StageBudget budget;
  double tolerance;             ///< residual that Newton's method through the bodies goes for
  double rate_tolerance;        ///< rates that are off by no more than this count as right [m/s or rad/s]
  double warm_start_tolerance;  ///< the same for the last impulses, taken as they are
  SubstepReport& report;
  double inexact_residual = 0;  ///< that of the result, if it is beyond 1e-8

  StageProblem problem() const { return problem(stage.lambda); }
  /// The problem of this stage with the impulses λ given.
  StageProblem problem(std::span<double> lambda) const { return {laws, b, effective_mass, lambda, w}; }
  /// Of the present w.
  StageSolution solution(std::span<const double> lambda) const {
    return {laws, b, effective_mass, lambda, w};
  }
  void add(const StageRecord& record) {
    report.times += record.times;
    report.counts.contact_iterations += record.iterations;
    report.complementarity_residual = std::max(report.complementarity_residual, record.residual);
    inexact_residual = record.inexact;
  }
};

}  // namespace taut
