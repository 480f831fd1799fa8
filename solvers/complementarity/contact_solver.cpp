#include "solvers/complementarity/contact_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/common/max_abs.h"
#include "solvers/laws/contact_residual.h"

namespace taut {
namespace {

/// S_rr of row r.
auto diagonal_of(const StageProblem& problem) {
  return [effective_mass = problem.effective_mass](std::size_t r) { return 1 / effective_mass[r]; };
}

}  // namespace

ContactSolver::ContactSolver(ConstraintSystem& system, ContactLaws& contacts)
    : system_(system), contacts_(contacts), newton_(system), locked_(system) {}

ImpulseIteration& ContactSolver::iteration() {
  if (!iteration_) iteration_.emplace(system_);
  return *iteration_;
}

double ContactSolver::relative_residual(const StageProblem& problem, double rate_tolerance) const {
  double scale = 0;
  for (std::size_t r = 0; r < problem.lambda.size(); ++r)
    scale = std::max(scale, std::abs(problem.lambda[r]) / std::sqrt(problem.effective_mass[r]));
  return largest_residual(problem, rate_tolerance).over(scale);
}

/// The natural residual [√J]; infinite if a value is not finite.
LargestResidual ContactSolver::largest_residual(const StageProblem& problem, double rate_tolerance) const {
  const auto& [laws, b, effective_mass, lambda, w] = problem;
  LargestResidual largest;
  if (!std::isfinite(max_abs(lambda)) || !std::isfinite(max_abs(w)))
    largest.add(std::numeric_limits<double>::infinity());
  largest.add_rows(laws.first(system_.rows().first_contact_row()), diagonal_of(problem), lambda, w,
                   rate_tolerance);
  add_contacts(contacts_, lambda, w, rate_tolerance, largest);
  return largest;
}

bool ContactSolver::solve(const StageProblem& problem, const ContactLimits& limits, StageRecord& record) {
  const double rate_tolerance = limits.newton.rate_tolerance;
  if (limits.warm_start && rests(problem, limits.warm_start_tolerance, record)) return true;
  sweep_guess(problem, rate_tolerance);
  for (int solve = 0;; ++solve) {
    if (!newton_.solve(contacts_, problem, limits.newton, record).converged)
      return solve_by_sweeps(problem, rate_tolerance, limits.inexact, record);
    close_joints(problem, rate_tolerance, record);
    if (solve == Tuning::kMaxSolves || !contacts_.slips_where_it_held()) return true;
    if (search_sticking_solution(problem, rate_tolerance, record) || !contacts_.weakened()) return true;
  }
}

/// True if nothing comes together and λ meets the laws as it is, or after one linear solve in which all that
/// presses is locked; w becomes its rates.
bool ContactSolver::rests(const StageProblem& problem, double rate_tolerance, StageRecord& record) {
  if (!contacts_.rest() || !contacts_.is_clear(problem.lambda)) return false;
  system_.rates(problem.lambda, problem.b, problem.w);
  return meets_laws(problem, ResidualTuning::kMet, rate_tolerance, record) ||
         rests_locked(problem, rate_tolerance, record);
}

bool ContactSolver::meets_laws(const StageProblem& problem, double tolerance, double rate_tolerance,
                               StageRecord& record) {
  const double off = relative_residual(problem, rate_tolerance);
  if (off > tolerance || !newton_.holds_joints(problem.laws, problem.w, rate_tolerance)) return false;
  contacts_.take_over(problem.lambda, problem.w, rate_tolerance);
  if (!(contacts_.residual() <= tolerance) || contacts_.slips_where_it_held()) return false;
  record.residual = std::max({record.residual, off, contacts_.residual()});
  return true;
}

/// With all that presses locked, and the load divided as it is now.
bool ContactSolver::rests_locked(const StageProblem& problem, double rate_tolerance, StageRecord& record) {
  const auto solve = [&](std::span<const RowLaw> laws, std::span<double> lambda) {
    record.iterations +=
        locked_
            .solve(laws, problem.b, lambda, problem.w,
                   {.rate_tolerance = rate_tolerance, .softness = Tuning::kLockedSoftness}, record.times)
            .iterations;
  };
  const auto met = [&](const StageProblem& held) {
    return meets_laws(held, ResidualTuning::kMetByContacts, rate_tolerance, record);
  };
  return keep_division(problem, rate_tolerance, solve, met);
}

double ContactSolver::sweep(const StageProblem& problem, int sweeps, double rate_tolerance) {
  (void)iteration().solve(contacts_, problem.laws, problem.b, problem.lambda, problem.w, {.sweeps = sweeps},
                          {});
  return relative_residual(problem, rate_tolerance);
}

/// A better guess for Newton's method: Gauss–Seidel, whose sweeps cost little, comes near from anywhere.  Of
/// joints they cost more than they save.
void ContactSolver::sweep_guess(const StageProblem& problem, double rate_tolerance) {
  const bool with_joints = system_.rows().first_contact_row() > 0;
  if (!newton_.is_heap() || (contacts_.soft() && with_joints)) return;
  system_.rates(problem.lambda, problem.b, problem.w);
  double size = 0;
  for (std::size_t r = 0; r < problem.b.size(); ++r)
    size = std::max(size, std::abs(problem.b[r]) * std::sqrt(problem.effective_mass[r]));
  const double off = relative_residual(problem, rate_tolerance);
  if (off <= Tuning::kNear) return;
  held_.assign(problem.lambda.begin(), problem.lambda.end());
  StageProblem swept = problem;
  swept.lambda = held_;
  const IterationLimits limits{.sweeps = Tuning::kFirstSweeps, .tolerance = Tuning::kSwept * size};
  (void)iteration().solve(contacts_, problem.laws, problem.b, held_, problem.w, limits, {});
  if (relative_residual(swept, rate_tolerance) < off)
    std::copy(held_.begin(), held_.end(), problem.lambda.begin());
}

/// Where laws are met as parts of the largest impulse, joints between light bodies may still be off by more
/// than the tolerance of rates: these and axes once more, with the impulses of contacts as they are.
void ContactSolver::close_joints(const StageProblem& problem, double rate_tolerance, StageRecord& record) {
  if (newton_.holds_joints(problem.laws, problem.w, rate_tolerance)) return;
  StageProblem closed = problem;
  held_.assign(problem.lambda.begin(), problem.lambda.end());
  closed.lambda = held_;
  locked_laws_.assign(problem.laws.begin(), problem.laws.end());
  for (int r = system_.rows().first_contact_row(); r < system_.row_count(); ++r)
    locked_laws_[r] = RowLaw::constant(held_[r]);
  const PrimalDualLimits limits{.rate_tolerance = rate_tolerance};
  record.iterations +=
      locked_.solve(locked_laws_, problem.b, held_, problem.w, limits, record.times).iterations;
  if (relative_residual(closed, rate_tolerance) <= ResidualTuning::kMetByContacts)
    std::copy(held_.begin(), held_.end(), problem.lambda.begin());
  else
    system_.rates(problem.lambda, problem.b, problem.w);
  contacts_.take_over(problem.lambda, problem.w, rate_tolerance);
}

/// From a solution in which contacts slip that stuck: true, and another one, if there is one in which they
/// hold.  Else they are let go, and λ and w stay as they are.
bool ContactSolver::search_sticking_solution(const StageProblem& problem, double rate_tolerance,
                                             StageRecord& record) {
  const std::span<double> lambda = problem.lambda;
  NewtonLimits limits{.rate_tolerance = rate_tolerance, .iterations = Tuning::kStepsToHold, .holding = true};
  limits.most = limits.tolerance;
  StickSearch& search = contacts_.stick_search();
  if (!search.begin(lambda, problem.w)) return false;
  lambda_before_.assign(lambda.begin(), lambda.end());
  for (bool again = true; again;) {
    std::copy(lambda_before_.begin(), lambda_before_.end(), lambda.begin());
    const NewtonOutcome outcome = newton_.solve(contacts_, problem, limits, record);
    if (outcome.converged && !contacts_.slips_where_it_held()) {
      // What holds by the normality law holds by Coulomb's where it does not slip at all.
      search.end(true);
      const double off = relative_residual(problem, rate_tolerance);
      if (off <= ResidualTuning::kMetByContacts) {
        record.residual = std::max(record.residual, off);
        return true;
      }
      search.go_on();
    }
    again = search.mark_sliding(problem.w, outcome.iterations < limits.iterations);
  }
  search.end(false);
  std::copy(lambda_before_.begin(), lambda_before_.end(), lambda.begin());
  system_.rates(lambda, problem.b, problem.w);
  return false;
}

/// Where Newton's method has given up: its best round, or what Gauss–Seidel makes of that if it is better, if
/// it is good enough.  Gauss–Seidel on contacts comes near from anywhere, and no further.
bool ContactSolver::solve_by_sweeps(const StageProblem& problem, double rate_tolerance, double inexact,
                                    StageRecord& record) {
  if (inexact == 0 || contacts_.count() == 0) return false;
  const LargestResidual best = largest_residual(problem, rate_tolerance);
  held_.assign(problem.lambda.begin(), problem.lambda.end());
  (void)iteration().solve(contacts_, problem.laws, problem.b, problem.lambda, problem.w,
                          {.sweeps = Tuning::kLastSweeps}, {});
  LargestResidual error = largest_residual(problem, rate_tolerance);
  if (!(error.size() < best.size()) || !newton_.holds_joints(problem.laws, problem.w, rate_tolerance)) {
    error = best;
    std::copy(held_.begin(), held_.end(), problem.lambda.begin());
    system_.rates(problem.lambda, problem.b, problem.w);
  }
  contacts_.take_over(problem.lambda, problem.w, rate_tolerance);
  // Also of impulses that vanish in the end.
  const double residual = error.over(impulse_scale(diagonal_of(problem), problem.lambda, problem.b));
  if (!(residual <= inexact) || !std::isfinite(max_abs(problem.lambda))) return false;
  if (residual > ResidualTuning::kMetByContacts)
    record.inexact = residual;
  else
    record.residual = std::max(record.residual, residual);
  return true;
}

}  // namespace taut
