#include "solvers/complementarity/stage_pivoting.h"

#include <algorithm>

#include "solvers/common/move_rows.h"

namespace taut {

StagePivoting::StagePivoting(const StageModel& model, const StageResidual& residual, StageCulprits& culprits)
    : model_(model), residual_(residual), culprits_(culprits) {
  active_.emplace(model.system);
}

/// Solves with renewed laws until all agree.
StageVerdict StagePivoting::solve(StageAttempt& attempt) {
  if (!model_.contacts.empty() || model_.system.uses_primal_system()) return StageVerdict::kNext;
  const std::span<double> lambda = attempt.stage.lambda;
  ActiveSetSettings settings{.rate_tolerance = attempt.rate_tolerance};
  if (has_many_bounded_rows()) settings.max_descent_rounds = 0;  // the bodies are faster
  guess_.assign(lambda.begin(), lambda.end());
  for (int solve = 0;; ++solve) {
    settings.keep_null_space = solve > 0;
    outcome_ = active_->solve(attempt.laws, attempt.b, lambda, attempt.w, attempt.report.times, settings);
    attempt.report.counts.pivots += outcome_.pivots;
    if (!outcome_.ok()) return after_stall(attempt, settings.rate_tolerance == 0);
    if (!model_.move_laws(attempt.problem(), attempt.rate_tolerance)) {
      if (residual_.exact(attempt.solution(lambda))) {
        double& worst = attempt.report.complementarity_residual;
        worst = std::max(worst, outcome_.residual);
        return StageVerdict::kMet;
      }
      if (settings.rate_tolerance == 0) return give_up(attempt);
      settings.rate_tolerance = 0;  // it has let something pass
      continue;
    }
    if (solve >= Tuning::kMaxAxisSolves) break;
    attempt.stage.renew();
  }
  culprits_.find_jam(lambda, attempt.effective_mass);
  return StageVerdict::kFailed;
}

bool StagePivoting::has_many_bounded_rows() const {
  return std::ssize(model_.system.rows().axis_rows()) >= Tuning::kManyRows;
}

/// From the guess through the bodies.
StageVerdict StagePivoting::give_up(StageAttempt& attempt) {
  std::copy(guess_.begin(), guess_.end(), attempt.stage.lambda.begin());
  return StageVerdict::kNext;
}

/// A failure, unless what is asked for are the last digits, or the rows are so many that
/// the bodies are the fall-back.
StageVerdict StagePivoting::after_stall(StageAttempt& attempt, bool polishes) {
  if (!polishes && (!has_many_bounded_rows() || outcome_.status != ActiveSetStatus::kNotConverged))
    return StageVerdict::kFailed;
  return give_up(attempt);
}

void StagePivoting::take_segments(const StageSolution& solution) {
  const auto& [laws, b, effective_mass, lambda, w] = solution;
  outcome_ = {};
  if (!model_.friction_dominated()) {
    active_->reset();
    active_->prepare(laws, b, lambda);
    return;
  }
  segments_scratch_.resize(lambda.size());
  for (std::size_t r = 0; r < lambda.size(); ++r) {
    const double diagonal = 1 / effective_mass[r];
    segments_scratch_[r] = laws[r].resolve(diagonal, w[r] - diagonal * lambda[r]).segment;
  }
  active_->set_segments(segments_scratch_, laws);
}

void StagePivoting::move_rows(std::span<const int> from, std::span<const RowLaw> laws) {
  std::vector<int> segments(active_->segments().begin(), active_->segments().end());
  taut::move_rows(from, -1, segments);
  active_.emplace(model_.system);
  active_->set_segments(segments, laws);
}

}  // namespace taut
