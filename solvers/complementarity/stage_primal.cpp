#include "solvers/complementarity/stage_primal.h"

#include <algorithm>

namespace taut {
namespace {

template <typename Outcome>
void add_to(StageRecord& record, const Outcome& outcome) {
  record.iterations += outcome.iterations;
  if (outcome.converged) record.residual = std::max(record.residual, outcome.residual);
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
  NewtonLimits limits{.rate_tolerance = attempt.rate_tolerance};
  if (attempt.stage.exact) limits.tolerance = Tuning::kMendedExactly;
  if (attempt.budget.reduced) limits.iterations = Tuning::kReducedSteps;
  const ContactIslands::Limits of_islands{limits, attempt.warm_start_tolerance, attempt.budget.inexact};
  for (int solve = 0; solve < Tuning::kMaxMendings; ++solve) {
    StageRecord record;
    const bool solved = model_.contacts.empty() ? solve_axes(attempt, record)
                                                : islands_.solve(attempt.problem(), of_islands, record);
    attempt.add(record);
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
bool StagePrimal::solve_axes(const StageAttempt& attempt, StageRecord& record) {
  model_.system.rates(attempt.stage.lambda, attempt.b, attempt.w);
  return solve_near(attempt, record) || solve_by_interior_point(attempt, record);
}

/// What is nearly solved, on the segments of the guess or by some steps of Newton; else λ is the guess.
bool StagePrimal::solve_near(const StageAttempt& attempt, StageRecord& record) {
  const std::span<double> lambda = attempt.stage.lambda;
  const double rate_tolerance = attempt.rate_tolerance;
  if (!(contact_solver_.distance(attempt.problem(), rate_tolerance) <= Tuning::kNewtonRange)) return false;
  const double tolerance = attempt.stage.near ? Tuning::kMendedExactly : kMetResidual;
  guess_.assign(lambda.begin(), lambda.end());
  if (solve_on_segments(attempt, {tolerance, rate_tolerance}, record) && exact(attempt)) return true;
  std::copy(guess_.begin(), guess_.end(), lambda.begin());
  const NewtonLimits few{.tolerance = tolerance,
                         .most = kMetResidual,
                         .rate_tolerance = rate_tolerance,
                         .iterations = Tuning::kFewSteps};
  if (contact_solver_.solve_by_newton(attempt.problem(), few, record) && exact(attempt)) return true;
  std::copy(guess_.begin(), guess_.end(), lambda.begin());
  return false;
}

/// All else by interior points, and what those leave by Newton.
bool StagePrimal::solve_by_interior_point(const StageAttempt& attempt, StageRecord& record) {
  const InteriorOutcome outcome =
      interior_.solve(attempt.laws, attempt.b, attempt.stage.lambda, attempt.w, {}, record.times);
  add_to(record, outcome);
  if (outcome.converged && exact(attempt)) return true;
  const NewtonLimits limits{.most = kMetResidual, .rate_tolerance = attempt.rate_tolerance};
  return contact_solver_.solve_by_newton(attempt.problem(), limits, record) && exact(attempt);
}

bool StagePrimal::solve_on_segments(const StageAttempt& attempt, const PrimalDualLimits& limits,
                                    StageRecord& record) {
  const PrimalDualOutcome outcome =
      primal_dual_.solve(attempt.laws, attempt.b, attempt.stage.lambda, attempt.w, limits, record.times);
  add_to(record, outcome);
  return outcome.converged;
}

}  // namespace taut
