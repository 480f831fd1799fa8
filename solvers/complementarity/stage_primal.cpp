#include "solvers/complementarity/stage_primal.h"

#include <algorithm>

namespace taut {
namespace {

/// What a solver has done.
template <typename Outcome>
StageRecord record_of(const Outcome& outcome) {
  StageRecord record;
  record.iterations = outcome.iterations;
  if (outcome.converged) record.residual = outcome.residual;
  return record;
}

}  // namespace

StagePrimal::StagePrimal(const StageModel& model, const StageResidual& residual,
                         ContactSolver& contact_solver, StagePivoting& pivoting, StageCulprits& culprits)
    : model_(model),
      residual_(residual),
      contact_solver_(contact_solver),
      pivoting_(pivoting),
      culprits_(culprits),
      islands_(model.system, model.contacts, contact_solver, model.settings.threads),
      interior_(model.system),
      primal_dual_(model.system) {}

StageVerdict StagePrimal::solve(StageAttempt& attempt) {
  const std::span<double> lambda = attempt.stage.lambda;
  for (int solve = 0; solve < Tuning::kMaxMendings; ++solve) {
    const bool solved = model_.contacts.empty() ? solve_axes(attempt) : solve_islands(attempt);
    pivoting_.take_segments(attempt.solution(lambda));
    if (!solved) break;
    if (!model_.move_laws(attempt.problem(), attempt.rate_tolerance)) return StageVerdict::kMet;
    if (solve == Tuning::kMaxMendings - 1) culprits_.find_jam(lambda, attempt.inertia);
    attempt.stage.renew();
  }
  pivoting_.note_not_converged();
  return StageVerdict::kFailed;
}

/// Many axes and no contacts.
bool StagePrimal::solve_axes(StageAttempt& attempt) {
  model_.system.rates(attempt.stage.lambda, attempt.b, attempt.w);
  return solve_near(attempt) || solve_by_interior_point(attempt);
}

/// What is nearly solved, on the segments of the guess or by some steps of Newton; else λ is the guess.
bool StagePrimal::solve_near(StageAttempt& attempt) {
  const std::span<double> lambda = attempt.stage.lambda;
  const double rate_tolerance = attempt.rate_tolerance;
  if (!(contact_solver_.distance(attempt.problem(), rate_tolerance) <= Tuning::kNewtonRange)) return false;
  const double tolerance = attempt.stage.near ? Tuning::kMendedExactly : kMetResidual;
  guess_.assign(lambda.begin(), lambda.end());
  if (solve_on_segments(attempt, {tolerance, rate_tolerance}) && exact(attempt)) return true;
  std::copy(guess_.begin(), guess_.end(), lambda.begin());
  const NewtonLimits few{.tolerance = tolerance,
                         .most = kMetResidual,
                         .rate_tolerance = rate_tolerance,
                         .iterations = Tuning::kFewSteps};
  if (solve_by_newton(attempt, few) && exact(attempt)) return true;
  std::copy(guess_.begin(), guess_.end(), lambda.begin());
  return false;
}

/// All else by interior points, and what those leave by Newton.
bool StagePrimal::solve_by_interior_point(StageAttempt& attempt) {
  const InteriorOutcome outcome =
      interior_.solve(attempt.laws, attempt.b, attempt.stage.lambda, attempt.w, {}, attempt.report.times);
  attempt.add(record_of(outcome));
  if (outcome.converged && exact(attempt)) return true;
  const NewtonLimits limits{.most = kMetResidual, .rate_tolerance = attempt.rate_tolerance};
  return solve_by_newton(attempt, limits) && exact(attempt);
}

bool StagePrimal::solve_on_segments(StageAttempt& attempt, const PrimalDualLimits& limits) {
  const PrimalDualOutcome outcome = primal_dual_.solve(attempt.laws, attempt.b, attempt.stage.lambda,
                                                       attempt.w, limits, attempt.report.times);
  attempt.add(record_of(outcome));
  return outcome.converged;
}

bool StagePrimal::solve_by_newton(StageAttempt& attempt, const NewtonLimits& limits) {
  StageRecord record;
  const bool solved = contact_solver_.solve_by_newton(attempt.problem(), limits, record);
  attempt.add(record);
  return solved;
}

bool StagePrimal::solve_islands(StageAttempt& attempt) {
  NewtonLimits limits{.rate_tolerance = attempt.rate_tolerance, .near = attempt.stage.near};
  if (attempt.budget.reduced) limits.iterations = Tuning::kReducedSteps;
  StageRecord record;
  const bool solved = islands_.solve(attempt.problem(),
                                     {limits, attempt.warm_start_tolerance, attempt.budget.inexact}, record);
  attempt.add(record);
  return solved;
}

}  // namespace taut
