#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/max_abs.h"
#include "solvers/rattle.h"

// Stages whose laws are met without an active set: at rest by the impulses of before, else through the
// bodies, by Newton's method for contacts and for what is nearly solved, or by an interior point method.
// (solvers/README, "Many contacts", "Many axes with friction")
namespace taut {
namespace {

/// Impulses of before are taken over if they are off their laws by no more than this part.
constexpr double kHeld = 1e-9;
/// Off by no more than this they are mended by so many sweeps, if that is enough.
constexpr double kNear = 1e-3;
constexpr int kMendingSweeps = 50;
/// Without contacts Newton's method starts where the laws are off by no more than this part, for so many
/// steps: then it has few rows to put on other pieces.
constexpr double kNewtonRange = 1e-5;
constexpr int kFewSteps = 8;
/// What that leaves where positions were looked at again.
constexpr double kExact = 1e-13;
/// Newton steps where those of the step before were not enough.
constexpr int kStepsOfHardStages = 300;
/// Contacts whose guess is further off than kNear are first swept so often, or until no impulse changes by
/// more than this part of the largest.
constexpr int kFirstSweeps = 300;
constexpr double kSwept = 1e-10;
/// Sweeps of Gauss–Seidel where that was not enough.
constexpr int kLastSweeps = 1000;
/// Newton steps in which contacts that stick are to find a division of the load that holds them.
constexpr int kStepsToHold = 150;
/// More solves of a stage, because friction let go or the load that it grows by has changed.
constexpr int kMaxSolves = 40;

/// What a solver has done.
template <typename Outcome>
void book(const Outcome& outcome, StepReport& report) {
  report.contact_iterations += outcome.iterations;
  if (outcome.converged)
    report.complementarity_residual = std::max(report.complementarity_residual, outcome.residual);
}

}  // namespace

/// The natural map at impulses whose rates are w, over the largest of them; errors of rates within the
/// tolerance do not count.
double Rattle::distance_from_laws(std::span<const double> lambda, std::span<const double> w,
                                  double rate_tolerance) const {
  double error = 0, scale = 0, sum = 0;
  for (int r = 0; r < system_.row_count(); ++r) {
    scale = std::max(scale, std::abs(lambda[r]) / std::sqrt(inertia_[r]));
    sum += std::abs(lambda[r]) + std::abs(w[r]);
  }
  if (!std::isfinite(sum)) return std::numeric_limits<double>::infinity();
  for (int r = 0; r < system_.rows().first_contact_row(); ++r) {
    const double own = 1 / inertia_[r];
    const double off = std::abs(lambda[r] - laws_[r].answer(own, lambda[r], w[r]));
    if (!(own * off <= rate_tolerance)) error = std::max(error, std::sqrt(own) * off);
  }
  error = std::max(error, contacts_.error(lambda, w, rate_tolerance));
  return error == 0 ? 0 : error / scale;
}

/// Rates that impulses of before may miss their laws by at rest.  What one stage leaves is mended by the
/// next, in turns and for ever, unless that one is solved, too.
double Rattle::resting_tolerance(double rate_tolerance, bool rested) const {
  return rested || near_ ? rate_tolerance : std::min(rate_tolerance, 0.1 * settings_.velocity_tolerance);
}

/// True if the impulses of before meet the laws at once, or after some sweeps of Gauss–Seidel: a stage of
/// bodies at rest is done without a factor.
bool Rattle::holds(std::span<double> lambda, double rate_tolerance, StepReport& report) {
  // Contacts that are gone, as where bodies may no longer collide, give nothing from now on.
  const std::span<const ContactSet::Place> places = contacts_.set().places();
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto given = lambda.begin() + contacts_.first_row(static_cast<int>(k));
    const int count = places[k].at.twist ? 6 : 3;
    if (!places[k].active && std::any_of(given, given + count, [](double l) { return l != 0; })) return false;
  }
  std::copy(rates_.begin(), rates_.end(), w_.begin());
  double off = distance_from_laws(lambda, w_, rate_tolerance);
  // Newton is as fast through the bodies.
  if (off > kNear || (system_.through_bodies() && off > (rubs() ? 0 : kHeld))) return false;
  if (rubs() && !newton_.holds_joints(laws_, w_, rate_tolerance)) return false;
  if (off > kHeld) {
    held_.assign(lambda.begin(), lambda.end());
    (void)iteration_->solve(contacts_, laws_, delta_, held_, w_, {.sweeps = kMendingSweeps}, {});
    off = distance_from_laws(held_, w_, rate_tolerance);
    if (off > kHeld) return false;
    std::copy(held_.begin(), held_.end(), lambda.begin());
  }
  return meets_laws(lambda, off, rate_tolerance, report);
}

/// Impulses that are off their laws by no more than `off` are taken, unless some friction lets go at them.
bool Rattle::meets_laws(std::span<double> lambda, double off, double rate_tolerance, StepReport& report) {
  laws_moved_ = laws_move(lambda, rate_tolerance);
  if (laws_moved_) return false;
  contacts_.take_over(lambda, w_, rate_tolerance);
  if (!(contacts_.residual() <= kHeld) || contacts_.slips_where_it_held()) return false;
  take_pieces(lambda);
  rested_ = true;
  report.complementarity_residual = std::max({report.complementarity_residual, off, contacts_.residual()});
  return true;
}

/// True if contacts that hold go on holding with the division of the load that they have: one linear solve,
/// which changes the impulses of before only by what their rates lack.  The active set and Newton's method
/// would find another division, as off its laws as their tolerance allows, in each stage.
bool Rattle::holds_by_factor(std::span<double> lambda, double rate_tolerance, StepReport& report) {
  if (contacts_.empty() || contacts_.soft() || system_.through_bodies()) return false;
  std::copy(rates_.begin(), rates_.end(), w_.begin());
  if (!contacts_.all_stick(lambda) || distance_from_laws(lambda, w_, rate_tolerance) > kNear) return false;
  held_laws_ = laws_;
  contacts_.held_laws(lambda, held_laws_);
  held_.assign(lambda.begin(), lambda.end());
  pieces_scratch_.assign(active_->pieces().begin(), active_->pieces().end());
  ActiveSetSettings settings{.rate_tolerance = rate_tolerance, .keep_null_space = true};
  settings.max_rounds = settings.max_descent_rounds = 0;
  (void)active_->solve(held_laws_, delta_, held_, w_, report.times, settings);
  const double off = distance_from_laws(held_, w_, rate_tolerance);
  if (off <= kHeld && meets_laws(held_, off, rate_tolerance, report)) {
    std::copy(held_.begin(), held_.end(), lambda.begin());
    return true;
  }
  active_->set_pieces(pieces_scratch_, laws_);
  return false;
}

/// The pieces of this solution, for the next solve and for law_error().
void Rattle::take_pieces(std::span<const double> lambda) {
  outcome_ = {};
  if (!rubs()) {
    active_->reset();
    active_->prepare(laws_, delta_, lambda);
    return;
  }
  pieces_scratch_.resize(lambda.size());
  for (std::size_t r = 0; r < lambda.size(); ++r) {
    const double own = 1 / inertia_[r];
    pieces_scratch_[r] = laws_[r].resolve(own, w_[r] - own * lambda[r]).piece;
  }
  active_->set_pieces(pieces_scratch_, laws_);
}

/// All that the bodies are the system for: again where static friction lets go or its load changes.
bool Rattle::solve_through_bodies(std::span<double> lambda, double rate_tolerance, Renew renew,
                                  StepReport& report) {
  NewtonLimits limits{.rate_tolerance = rate_tolerance, .near = near_};
  if (few_steps_) limits.iterations = kStepsOfHardStages;
  for (int solve = 0; solve < kMaxSolves; ++solve) {
    const bool solved = contacts_.empty() ? solve_axes(lambda, rate_tolerance, report)
                                          : solve_by_newton(lambda, limits, report) ||
                                                solve_by_sweeps(lambda, rate_tolerance, report);
    take_pieces(lambda);
    if (!solved) break;
    if (!laws_move(lambda, rate_tolerance)) return true;
    (this->*renew)();
  }
  outcome_.status = ActiveSetStatus::kNotConverged;
  return false;
}

/// Many axes and no contacts: what is nearly solved on the pieces of the guess, or by some steps of Newton,
/// all else by interior points.
bool Rattle::solve_axes(std::span<double> lambda, double rate_tolerance, StepReport& report) {
  system_.rates(lambda, delta_, w_);
  if (distance_from_laws(lambda, w_, rate_tolerance) <= kNewtonRange) {
    const double tolerance = near_ ? kExact : kHeld;
    held_.assign(lambda.begin(), lambda.end());
    if (solve_on_pieces(lambda, {tolerance, rate_tolerance}, report)) return true;
    std::copy(held_.begin(), held_.end(), lambda.begin());
    const NewtonLimits few{
        .tolerance = tolerance, .most = kHeld, .rate_tolerance = rate_tolerance, .iterations = kFewSteps};
    if (solve_by_newton(lambda, few, report)) return true;
    std::copy(held_.begin(), held_.end(), lambda.begin());
  }
  const InteriorOutcome outcome = interior_.solve(laws_, delta_, lambda, w_, {}, report.times);
  book(outcome, report);
  return outcome.converged ||
         solve_by_newton(lambda, {.most = kHeld, .rate_tolerance = rate_tolerance}, report);
}

bool Rattle::solve_on_pieces(std::span<double> lambda, const PieceLimits& limits, StepReport& report) {
  const PieceOutcome outcome = piece_newton_.solve(laws_, delta_, lambda, w_, limits, report.times);
  book(outcome, report);
  return outcome.converged;
}

/// A better guess for Newton's method: Gauss–Seidel, whose sweeps cost little, comes near from anywhere.
void Rattle::sweep_guess(std::span<double> lambda, double rate_tolerance) {
  system_.rates(lambda, delta_, w_);
  double size = 0;
  for (int r = 0; r < system_.row_count(); ++r)
    size = std::max(size, std::abs(delta_[r]) * std::sqrt(inertia_[r]));
  const double off = distance_from_laws(lambda, w_, rate_tolerance);
  if (off <= kNear) return;
  held_.assign(lambda.begin(), lambda.end());
  const IterationLimits limits{.sweeps = kFirstSweeps, .tolerance = kSwept * size};
  (void)iteration_->solve(contacts_, laws_, delta_, held_, w_, limits, {});
  if (distance_from_laws(held_, w_, rate_tolerance) < off)
    std::copy(held_.begin(), held_.end(), lambda.begin());
}

/// Contacts, and what is left to others; again where static friction lets go.
bool Rattle::solve_by_newton(std::span<double> lambda, const NewtonLimits& limits, StepReport& report) {
  if (newton_.is_heap() && !contacts_.soft()) sweep_guess(lambda, limits.rate_tolerance);
  guess_.assign(lambda.begin(), lambda.end());
  for (int solve = 0;; ++solve) {
    if (!run_newton(lambda, limits, report).converged) return false;
    if (solve == kMaxSolves || !contacts_.slips_where_it_held()) return true;
    if (hold_on(lambda, limits.rate_tolerance, report) || !contacts_.weakened()) return true;
  }
}

NewtonOutcome Rattle::run_newton(std::span<double> lambda, const NewtonLimits& limits, StepReport& report) {
  const NewtonOutcome outcome = newton_.solve(contacts_, laws_, delta_, lambda, w_, limits, report.times);
  contacts_.take_over(lambda, w_, limits.rate_tolerance);
  book(outcome, report);
  loose_ = 0;
  return outcome;
}

/// A solution in which contacts slip that stuck: true, and another one, if there is one in which they hold.
/// Else they are let go, and λ and w stay as they are.
bool Rattle::hold_on(std::span<double> lambda, double rate_tolerance, StepReport& report) {
  NewtonLimits limits{.rate_tolerance = rate_tolerance, .iterations = kStepsToHold, .holding = true};
  limits.most = limits.tolerance;
  if (!contacts_.begin_sharing()) return false;
  unshared_.assign(lambda.begin(), lambda.end());
  for (bool again = true; again;) {
    std::copy(guess_.begin(), guess_.end(), lambda.begin());
    const NewtonOutcome outcome = run_newton(lambda, limits, report);
    if (outcome.converged && !contacts_.slips_where_it_held()) {
      // What holds by the normality law holds by Coulomb's where it does not slip at all.
      contacts_.end_sharing(true);
      const double off = distance_from_laws(lambda, w_, rate_tolerance);
      if (off <= NewtonLimits().most) {
        report.complementarity_residual = std::max(report.complementarity_residual, off);
        return true;
      }
      contacts_.go_on_sharing();
    }
    again = contacts_.let_go(w_, outcome.iterations < limits.iterations);
  }
  contacts_.end_sharing(false);
  std::copy(unshared_.begin(), unshared_.end(), lambda.begin());
  system_.rates(lambda, delta_, w_);
  return false;
}

/// Where Newton's method has given up: its best round, or what Gauss–Seidel makes of that if it is better, if
/// it is good enough.  Gauss–Seidel on contacts comes near from anywhere, and no further.
bool Rattle::solve_by_sweeps(std::span<double> lambda, double rate_tolerance, StepReport& report) {
  if (inexact_ == 0 || contacts_.empty()) return false;
  const double best = distance_from_laws(lambda, w_, rate_tolerance);
  held_.assign(lambda.begin(), lambda.end());
  (void)iteration_->solve(contacts_, laws_, delta_, lambda, w_, {.sweeps = kLastSweeps}, {});
  double residual = distance_from_laws(lambda, w_, rate_tolerance);
  if (!(residual < best) || !newton_.holds_joints(laws_, w_, rate_tolerance)) {
    residual = best;
    std::copy(held_.begin(), held_.end(), lambda.begin());
    system_.rates(lambda, delta_, w_);
  }
  contacts_.take_over(lambda, w_, rate_tolerance);
  if (!(residual <= inexact_) || !std::isfinite(max_abs(lambda))) return false;
  if (residual > NewtonLimits().most)
    loose_ = residual;
  else
    report.complementarity_residual = std::max(report.complementarity_residual, residual);
  return true;
}

void Rattle::forget_contact_impulses() {
  const auto first = system_.rows().first_contact_row();
  for (auto* values : {&lambda_, &mu_, &start_mu_, &force_multipliers_})
    std::fill(values->begin() + first, values->end(), 0.0);
}

/// Only for stages of sub-steps that are kept.
void Rattle::report_inexactness(StepReport& report) const {
  if (loosest_ == 0) return;
  report.status = Status::kInexact;
  report.complementarity_residual = std::max(report.complementarity_residual, loosest_);
  report.message = "the laws of contacts, friction and limits are not met to 1e-8";
}

}  // namespace taut
