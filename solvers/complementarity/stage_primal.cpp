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

bool StagePrimal::solve(const StageAttempt& attempt, StageRecord& record) {
  model_.system.rates(attempt.stage.lambda, attempt.b, attempt.w);
  return solve_near(attempt, record) || solve_by_interior_point(attempt, record);
}

/// What is nearly solved, on the segments of the guess or by some steps of Newton; else λ is the guess.
bool StagePrimal::solve_near(const StageAttempt& attempt, StageRecord& record) {
  const std::span<double> lambda = attempt.stage.lambda;
  const double rate_tolerance = attempt.rate_tolerance;
  if (!(contact_solver_.relative_residual(attempt.problem(), rate_tolerance) <= Tuning::kNewtonRange))
    return false;
  guess_.assign(lambda.begin(), lambda.end());
  const PrimalDualOutcome outcome = primal_dual_.solve(attempt.laws, attempt.b, lambda, attempt.w,
                                                       {attempt.tolerance, rate_tolerance}, record.times);
  add_to(record, outcome);
  if (outcome.converged && exact(attempt)) return true;
  std::copy(guess_.begin(), guess_.end(), lambda.begin());
  const NewtonLimits few{.tolerance = attempt.tolerance,
                         .most = ResidualTuning::kMet,
                         .rate_tolerance = rate_tolerance,
                         .iterations = Tuning::kFewSteps};
  if (contact_solver_.solve(attempt.problem(), {.newton = few}, record) && exact(attempt)) return true;
  std::copy(guess_.begin(), guess_.end(), lambda.begin());
  return false;
}

/// All else by interior points, and what those leave by Newton.
bool StagePrimal::solve_by_interior_point(const StageAttempt& attempt, StageRecord& record) {
  const InteriorOutcome outcome =
      interior_.solve(attempt.laws, attempt.b, attempt.stage.lambda, attempt.w, {}, record.times);
  add_to(record, outcome);
  if (outcome.converged && exact(attempt)) return true;
  const NewtonLimits limits{.most = ResidualTuning::kMet, .rate_tolerance = attempt.rate_tolerance};
  return contact_solver_.solve(attempt.problem(), {.newton = limits}, record) && exact(attempt);
}

}  // namespace taut
