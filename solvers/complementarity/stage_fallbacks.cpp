#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/common/max_abs.h"
#include "solvers/complementarity/stage_solver.h"

// Stages whose laws are met without an active set: at rest by the impulses of before, else through the
// bodies, by Newton's method for contacts and for what is nearly solved, or by an interior point method.
// (solvers/complementarity, "Ladder", "Many contacts", "Many axes with friction")
namespace taut {
namespace {

constexpr double kHeld = ContactSolver::kHeld, kNear = ContactSolver::kNear;
/// Off by no more than kNear they are mended by so many sweeps, if that is enough.
constexpr int kMendingSweeps = 50;
/// Without contacts Newton's method starts where the laws are off by no more than this part, for so many
/// steps: then it has few rows to put on other segments.
constexpr double kNewtonRange = 1e-5;
constexpr int kFewSteps = 8;
/// What that leaves where positions were looked at again.
constexpr double kMendedExactly = 1e-13;
/// Newton steps where those of the step before were not enough.
constexpr int kStepsOfHardStages = 300;
/// More solves of a stage, because friction let go or the load that it grows by has changed.
constexpr int kMaxMendings = 40;

/// What a solver has done.
template <typename Outcome>
StageRecord record_of(const Outcome& outcome) {
  StageRecord record;
  record.iterations = outcome.iterations;
  if (outcome.converged) record.residual = outcome.residual;
  return record;
}

}  // namespace

/// Rates that impulses of before may miss their laws by at rest.  What one stage leaves is mended by the
/// next, in turns and for ever, unless that one is solved, too.
double StageSolver::warm_start_tolerance(double rate_tolerance, bool rested) const {
  return rested || good_guess_ ? rate_tolerance
                               : std::min(rate_tolerance, 0.1 * settings_.velocity_tolerance);
}

/// True if the impulses of before meet the laws at once, or after some sweeps of Gauss–Seidel: a stage of
/// bodies at rest is done without a factor.
bool StageSolver::accept_warm_start(const Stage& stage, double rate_tolerance, StepReport& report) {
  const std::span<double> lambda = stage.lambda;
  // Contacts that are gone, as where bodies may no longer collide, give nothing from now on.
  const std::span<const ContactSet::Place> places = contacts_.set().places();
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto given = lambda.begin() + contacts_.first_row(static_cast<int>(k));
    const int count = places[k].at.row_count();
    if (!places[k].active && std::any_of(given, given + count, [](double l) { return l != 0; })) return false;
  }
  std::copy(stage.rates.begin(), stage.rates.end(), w_.begin());
  double off = contact_solver_.distance(problem(lambda), rate_tolerance);
  // Newton is as fast through the bodies.
  if (off > kNear || (system_.uses_primal_system() && off > (friction_dominated() ? 0 : kHeld))) return false;
  // Sweeps bring impulses through contacts, but hardly along chains of joints.
  const int joint_rows = system_.rows().first_contact_row();
  if (off > kHeld && 2 * joint_rows > system_.row_count()) return false;
  if (friction_dominated() && !contact_solver_.newton().holds_joints(laws_, w_, rate_tolerance)) return false;
  if (off > kHeld) {
    held_.assign(lambda.begin(), lambda.end());
    off = contact_solver_.sweep(problem(held_), kMendingSweeps, rate_tolerance);
    if (off > kHeld) return false;
    std::copy(held_.begin(), held_.end(), lambda.begin());
  }
  return meets_laws(lambda, off, rate_tolerance, report);
}

/// Impulses that are off their laws by no more than `off` are taken, unless some friction lets go at them.
bool StageSolver::meets_laws(std::span<double> lambda, double off, double rate_tolerance,
                             StepReport& report) {
  laws_moved_ = laws_move(lambda, rate_tolerance);
  if (laws_moved_) return false;
  contacts_.take_over(lambda, w_, rate_tolerance);
  if (!(contacts_.residual() <= kHeld) || contacts_.slips_where_it_held() || !exact(lambda)) return false;
  take_segments(lambda);
  rested_ = true;
  report.complementarity_residual = std::max({report.complementarity_residual, off, contacts_.residual()});
  return true;
}

/// True if contacts that hold go on holding with the division of the load that they have: one linear solve,
/// which changes the impulses of before only by what their rates lack.  The active set and Newton's method
/// would find another division, as off its laws as their tolerance allows, in each stage.
bool StageSolver::solve_all_sticking(const Stage& stage, double rate_tolerance, StepReport& report) {
  const std::span<double> lambda = stage.lambda;
  if (contacts_.empty() || contacts_.soft() || system_.uses_primal_system()) return false;
  std::copy(stage.rates.begin(), stage.rates.end(), w_.begin());
  if (!contacts_.all_stick(lambda) || contact_solver_.distance(problem(lambda), rate_tolerance) > kNear)
    return false;
  held_laws_ = laws_;
  contacts_.held_laws(lambda, held_laws_);
  held_.assign(lambda.begin(), lambda.end());
  segments_scratch_.assign(active_->segments().begin(), active_->segments().end());
  ActiveSetSettings settings{.rate_tolerance = rate_tolerance, .keep_null_space = true};
  settings.max_rounds = settings.max_descent_rounds = 0;
  (void)active_->solve(held_laws_, b_, held_, w_, report.times, settings);
  const double off = contact_solver_.distance(problem(held_), rate_tolerance);
  if (off <= kHeld && meets_laws(held_, off, rate_tolerance, report)) {
    std::copy(held_.begin(), held_.end(), lambda.begin());
    return true;
  }
  active_->set_segments(segments_scratch_, laws_);
  return false;
}

/// The segments of this solution, for the next solve and for law_error().
void StageSolver::take_segments(std::span<const double> lambda) {
  outcome_ = {};
  if (!friction_dominated()) {
    active_->reset();
    active_->prepare(laws_, b_, lambda);
    return;
  }
  segments_scratch_.resize(lambda.size());
  for (std::size_t r = 0; r < lambda.size(); ++r) {
    const double own = 1 / effective_mass_[r];
    segments_scratch_[r] = laws_[r].resolve(own, w_[r] - own * lambda[r]).segment;
  }
  active_->set_segments(segments_scratch_, laws_);
}

/// All that the bodies are the system for, contacts island by island: again where static friction lets go or
/// its load changes.
bool StageSolver::solve_primal(const Stage& stage, double rate_tolerance, double resting,
                               StepReport& report) {
  const std::span<double> lambda = stage.lambda;
  NewtonLimits limits{.rate_tolerance = rate_tolerance, .near = good_guess_};
  if (reduced_budget_) limits.iterations = kStepsOfHardStages;
  for (int solve = 0; solve < kMaxMendings; ++solve) {
    const bool solved = contacts_.empty() ? solve_axes(lambda, rate_tolerance, report)
                                          : solve_islands(lambda, limits, resting, report);
    take_segments(lambda);
    if (!solved) break;
    if (!laws_move(lambda, rate_tolerance)) return true;
    if (solve == kMaxMendings - 1) note_jam(lambda);
    stage.renew();
  }
  outcome_.status = ActiveSetStatus::kNotConverged;
  return false;
}

/// Many axes and no contacts: what is nearly solved on the segments of the guess, or by some steps of Newton,
/// all else by interior points.
bool StageSolver::solve_axes(std::span<double> lambda, double rate_tolerance, StepReport& report) {
  system_.rates(lambda, b_, w_);
  if (contact_solver_.distance(problem(lambda), rate_tolerance) <= kNewtonRange) {
    const double tolerance = good_guess_ ? kMendedExactly : kHeld;
    held_.assign(lambda.begin(), lambda.end());
    if (solve_on_segments(lambda, {tolerance, rate_tolerance}, report) && exact(lambda)) return true;
    std::copy(held_.begin(), held_.end(), lambda.begin());
    const NewtonLimits few{
        .tolerance = tolerance, .most = kHeld, .rate_tolerance = rate_tolerance, .iterations = kFewSteps};
    if (solve_by_newton(lambda, few, report) && exact(lambda)) return true;
    std::copy(held_.begin(), held_.end(), lambda.begin());
  }
  const InteriorOutcome outcome = interior_.solve(laws_, b_, lambda, w_, {}, report.times);
  add(record_of(outcome), report);
  return (outcome.converged && exact(lambda)) ||
         (solve_by_newton(lambda, {.most = kHeld, .rate_tolerance = rate_tolerance}, report) &&
          exact(lambda));
}

bool StageSolver::solve_on_segments(std::span<double> lambda, const PrimalDualLimits& limits,
                                    StepReport& report) {
  const PrimalDualOutcome outcome = primal_dual_.solve(laws_, b_, lambda, w_, limits, report.times);
  add(record_of(outcome), report);
  return outcome.converged;
}

void StageSolver::add(const StageRecord& record, StepReport& report) {
  report.times += record.times;
  report.contact_iterations += record.iterations;
  report.complementarity_residual = std::max(report.complementarity_residual, record.residual);
  stage_residual_ = record.loose;
}

bool StageSolver::solve_by_newton(std::span<double> lambda, const NewtonLimits& limits, StepReport& report) {
  StageRecord record;
  const bool solved = contact_solver_.solve_by_newton(problem(lambda), limits, record);
  add(record, report);
  return solved;
}

bool StageSolver::solve_islands(std::span<double> lambda, const NewtonLimits& limits, double resting,
                                StepReport& report) {
  StageRecord record;
  const bool solved = islands_.solve(problem(lambda), {limits, resting, inexact_}, record);
  add(record, report);
  return solved;
}

}  // namespace taut
