#include "solvers/complementarity/stage_warm_start.h"

#include <algorithm>
#include <utility>

namespace taut {

StageWarmStart::StageWarmStart(const StageModel& model, const StageResidual& residual,
                               ContactSolver& contact_solver, StagePivoting& pivoting)
    : model_(model), residual_(residual), contact_solver_(contact_solver), pivoting_(pivoting) {}

/// What one stage leaves is mended by the next, in turns and for ever, unless that one is solved, too.
double StageWarmStart::begin(double loose, double tight) {
  return std::exchange(rested_, false) || !model_.friction_dominated() ? loose : tight;
}

StageVerdict StageWarmStart::solve(StageAttempt& attempt) {
  if (!may_rest()) return StageVerdict::kNext;
  Trial trial = accept(attempt);
  if (trial == Trial::kMissed) trial = solve_all_sticking(attempt);
  if (trial == Trial::kLawsMoved) attempt.stage.renew();
  return trial == Trial::kMet ? StageVerdict::kMet : StageVerdict::kNext;
}

/// Nothing strikes.
bool StageWarmStart::may_rest() const {
  return model_.friction_dominated() || (!model_.contacts.empty() && model_.contacts.rest());
}

/// The last impulses at once, or after some sweeps of Gauss–Seidel.
StageWarmStart::Trial StageWarmStart::accept(StageAttempt& attempt) {
  const std::span<double> lambda = attempt.stage.lambda;
  // Contacts that are gone, or are let through, give nothing from now on.
  if (!model_.contacts.is_clear(lambda)) return Trial::kMissed;
  const double tolerance = attempt.warm_start_tolerance;
  std::copy(attempt.stage.rates.begin(), attempt.stage.rates.end(), attempt.w.begin());
  double off = contact_solver_.relative_residual(attempt.problem(), tolerance);
  if (!is_near_enough(attempt, off)) return Trial::kMissed;
  if (off > ResidualTuning::kMet) {
    held_.assign(lambda.begin(), lambda.end());
    off = contact_solver_.sweep(attempt.problem(held_), StageTuning::kWarmStartSweeps, tolerance);
    if (off > ResidualTuning::kMet) return Trial::kMissed;
    std::copy(held_.begin(), held_.end(), lambda.begin());
  }
  return try_impulses(attempt, lambda, off);
}

/// Impulses that are off by this part are right, or are soon made so by sweeps.
bool StageWarmStart::is_near_enough(const StageAttempt& attempt, double off) const {
  const bool friction_dominated = model_.friction_dominated();
  // Newton is as fast through the bodies.
  if (off > Tuning::kNear ||
      (model_.system.uses_primal_system() && off > (friction_dominated ? 0 : ResidualTuning::kMet)))
    return false;
  // Sweeps bring impulses through contacts, but hardly along chains of joints.
  const int joint_rows = model_.system.rows().first_contact_row();
  if (off > ResidualTuning::kMet && 2 * joint_rows > model_.system.row_count()) return false;
  return !friction_dominated ||
         contact_solver_.newton().holds_joints(attempt.laws, attempt.w, attempt.warm_start_tolerance);
}

/// Impulses that are off their laws by no more than `off` are taken, unless some friction lets go at them.
StageWarmStart::Trial StageWarmStart::try_impulses(StageAttempt& attempt, std::span<double> lambda,
                                                   double off) {
  const double tolerance = attempt.warm_start_tolerance;
  if (model_.move_laws(attempt.problem(lambda), tolerance)) return Trial::kLawsMoved;
  ContactForces& contacts = model_.contacts;
  contacts.take_over(lambda, attempt.w, tolerance);
  if (!(contacts.residual() <= ResidualTuning::kMet) || contacts.slips_where_it_held() ||
      !residual_.exact(attempt.solution(lambda)))
    return Trial::kMissed;
  pivoting_.take_segments(attempt.solution(lambda));
  rested_ = true;
  double& worst = attempt.report.complementarity_residual;
  worst = std::max({worst, off, contacts.residual()});
  return Trial::kMet;
}

/// If contacts that hold go on holding with the division of the load that they have: one linear solve, which
/// the active set would follow by another division, as off its laws as its tolerance allows, in each stage.
StageWarmStart::Trial StageWarmStart::solve_all_sticking(StageAttempt& attempt) {
  if (model_.contacts.empty() || model_.system.uses_primal_system()) return Trial::kMissed;
  const double tolerance = attempt.warm_start_tolerance;
  std::copy(attempt.stage.rates.begin(), attempt.stage.rates.end(), attempt.w.begin());
  Trial trial = Trial::kMissed;
  const auto solve = [&](const std::vector<RowLaw>& laws, std::vector<double>& lambda) {
    segments_.assign(pivoting_.segments().begin(), pivoting_.segments().end());
    ActiveSetSettings settings{.rate_tolerance = tolerance, .keep_null_space = true};
    settings.max_rounds = settings.max_descent_rounds = 0;
    (void)pivoting_.active_set().solve(laws, attempt.b, lambda, attempt.w, attempt.report.times, settings);
  };
  const auto met = [&](const StageProblem& held) {
    const double off = contact_solver_.relative_residual(held, tolerance);
    if (off <= ResidualTuning::kMet) trial = try_impulses(attempt, held.lambda, off);
    if (trial != Trial::kMet) pivoting_.active_set().set_segments(segments_, attempt.laws);
    return trial == Trial::kMet;
  };
  (void)contact_solver_.keep_division(attempt.problem(), tolerance, solve, met);
  return trial;
}

}  // namespace taut
