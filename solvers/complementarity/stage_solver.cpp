#include "solvers/complementarity/stage_solver.h"

#include <algorithm>
#include <cmath>

#include "solvers/common/move_rows.h"
#include "solvers/complementarity/contact_stage.h"

namespace taut {
namespace {

/// The warm start of a whole system that factors S is StageWarmStart.
ContactLimits contact_limits(const StageAttempt& attempt, const ConstraintSystem& system) {
  ContactLimits limits{.newton = {.rate_tolerance = attempt.rate_tolerance},
                       .warm_start = system.uses_primal_system(),
                       .warm_start_tolerance = attempt.warm_start_tolerance,
                       .inexact = attempt.budget.inexact};
  if (attempt.stage.exact) limits.newton.tolerance = StageTuning::kExactTolerance;
  if (attempt.budget.reduced) limits.newton.iterations = StageTuning::kReducedSteps;
  return limits;
}

}  // namespace

StageSolver::StageSolver(const World& world, ConstraintSystem& system, AxisForces& axes,
                         ContactForces& contacts, const Settings& settings)
    : model_{system, axes, contacts, settings},
      residual_(system, contacts),
      culprits_(world, model_),
      contact_solver_(system, contacts),
      islands_(system, contacts, settings.threads),
      pivoting_(model_, residual_, culprits_),
      warm_start_(model_, residual_, contact_solver_, pivoting_),
      primal_(model_, residual_, contact_solver_) {
  const int rows = system.row_count();
  b_.assign(rows, 0.0);
  for (auto* values : {&effective_mass_, &w_}) values->assign(bounded() ? rows : 0, 0.0);
  laws_.assign(bounded() ? rows : 0, RowLaw::equality());
}

void StageSolver::move_rows(std::span<const int> from) {
  for (auto* values : {&b_, &effective_mass_, &w_}) taut::move_rows(from, 0.0, *values);
  taut::move_rows(from, RowLaw::none(), laws_);
  contact_solver_.reset();
  islands_.forget_pattern();
  pivoting_.move_rows(from, laws_);
}

void StageSolver::begin_advance() {
  accuracy_.begin_pass();
  culprits_.clear();
}

void StageSolver::set_equalities() {
  const Rows& rows = model_.system.rows();
  for (int r = 0; r < rows.first_contact_row(); ++r)
    if (rows.is_equality(r)) laws_[r] = RowLaw::equality();
}

/// b of w = S λ + b, such that the stage's λ gives its rates.
void StageSolver::rates_without(const Stage& stage) {
  model_.system.multiply(stage.lambda, b_);
  for (int r = 0; r < model_.system.row_count(); ++r) b_[r] = stage.rates[r] - b_[r];
}

StageEnd StageSolver::solve(const Stage& stage, double rate_tolerance, SubstepReport& report) {
  rates_without(stage);
  // What was solved at a neighbouring state is polished.
  const double tight = std::min(rate_tolerance, StageTuning::kRatePart * model_.settings.velocity_tolerance);
  StageAttempt attempt{
      .stage = stage,
      .laws = laws_,
      .b = b_,
      .effective_mass = effective_mass_,
      .w = w_,
      .budget = budget_,
      .tolerance = stage.near ? StageTuning::kExactTolerance : ResidualTuning::kMet,
      .rate_tolerance = rate_tolerance,
      .warm_start_tolerance = warm_start_.begin(rate_tolerance, stage.near ? rate_tolerance : tight),
      .report = report};
  StageVerdict verdict = warm_start_.solve(attempt);
  const bool unchanged = verdict == StageVerdict::kMet && model_.friction_dominated();
  if (verdict == StageVerdict::kNext) verdict = pivoting_.solve(attempt);
  const ContactLimits limits = contact_limits(attempt, model_.system);
  for (int solve = 1; verdict == StageVerdict::kNext; ++solve) {  // again while friction lets go
    StageRecord record;
    const bool solved = model_.contacts.empty() ? primal_.solve(attempt, record)
                        : islands_.is_one()     ? contact_solver_.solve(attempt.problem(), limits, record)
                                                : islands_.solve(attempt.problem(), limits, record);
    verdict = judge(attempt, record, solved, solve);
  }
  accuracy_.take(attempt.inexact_residual);
  const bool met = verdict == StageVerdict::kMet;
  detail::StageWatchScope::tell(model_, attempt.solution(stage.lambda), met);
  return unchanged ? StageEnd::kUnchanged : met ? StageEnd::kSolved : StageEnd::kFailed;
}

/// What a solve through the bodies has come to: where friction lets go the next one, with renewed laws.
StageVerdict StageSolver::judge(StageAttempt& attempt, const StageRecord& record, bool solved, int solves) {
  const std::span<double> lambda = attempt.stage.lambda;
  attempt.add(record);
  pivoting_.take_segments(attempt.solution(lambda));
  if (solved && !model_.move_laws(attempt.problem(), attempt.rate_tolerance)) return StageVerdict::kMet;
  const bool jams = solved && solves == StageTuning::kMaxRenewals;
  if (jams) culprits_.find_jam(lambda, attempt.effective_mass);
  if (solved) attempt.stage.renew();
  if (solved && !jams) return StageVerdict::kNext;
  pivoting_.note_not_converged();
  return StageVerdict::kFailed;
}

bool StageSolver::solve_velocities(const Stage& stage, SubstepReport& report) {
  double tolerance = StageTuning::kRatePart * model_.settings.velocity_tolerance;
  for (int exact = 0;; ++exact) {
    if (solve(stage, tolerance, report) == StageEnd::kFailed) break;
    const double off = model_.contacts.empty() ? 0 : residual_over_tolerance(stage.lambda, w_);
    if (off <= 1 || (exact == kExactSolves && take_inexact(off))) return true;
    if (exact == kExactSolves) break;
    tolerance = exact_tolerance();
    std::copy(w_.begin(), w_.end(), stage.rates.begin());
  }
  note_culprits(stage.lambda, w_);
  return false;
}

bool StageSolver::iterate(const Stage& stage, int sweeps, double rate_tolerance, std::span<Wrench> absorbed,
                          SubstepReport& report) {
  rates_without(stage);
  double least = 0;  // √ of the least effective mass: a tolerance for impulses
  for (int r = 0; r < model_.system.row_count(); ++r) {
    const double root_mass = std::sqrt(effective_mass_[r]);
    if (effective_mass_[r] > 0) least = least > 0 ? std::min(least, root_mass) : root_mass;
  }
  const Settings& settings = model_.settings;
  const IterationLimits limits{settings.solver, sweeps, settings.relaxation, rate_tolerance * least};
  const IterationOutcome outcome =
      contact_solver_.iteration().solve(model_.contacts, laws_, b_, stage.lambda, w_, limits, absorbed);
  report.counts.sweeps += outcome.sweeps;
  if (!std::isfinite(outcome.residual)) return false;
  (void)model_.move_laws({laws_, b_, effective_mass_, stage.lambda, w_}, 0);
  model_.contacts.take_over(stage.lambda, w_, rate_tolerance);
  return true;
}

double StageSolver::residual_over_tolerance(std::span<const double> lambda, std::span<const double> w) const {
  if (accuracy_.is_inexact()) return 0;
  return residual_.natural(solution(lambda, w)) / residual_.natural_tolerance();
}

bool StageSolver::take_inexact(double off) {
  const double residual = off * residual_.natural_tolerance();
  accuracy_.take(residual);
  return residual <= model_.settings.inexact_tolerance;
}

void StageSolver::note_inexact(std::span<const double> lambda, std::span<const double> rates) {
  if (accuracy_.is_worst()) note_culprits(lambda, rates);
  accuracy_.finish();
}

void StageSolver::report_residuals(SubstepReport& report) const {
  if (!accuracy_.report(report)) return;
  culprits_.report(report);
  report.message = "the laws of contacts, friction and limits are not met to 1e-8";
}

}  // namespace taut
