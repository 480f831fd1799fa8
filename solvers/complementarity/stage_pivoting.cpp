#include "solvers/complementarity/stage_pivoting.h"

#include <algorithm>
#include <limits>

#include "solvers/common/move_rows.h"

namespace taut {

StagePivoting::StagePivoting(const StageModel& model, const StageResidual& residual,
                             ContactSolver& contact_solver, StageCulprits& culprits)
    : model_(model), residual_(residual), contact_solver_(contact_solver), culprits_(culprits) {
  active_.emplace(model.system);
}

StageVerdict StagePivoting::solve(StageAttempt& attempt) {
  return left_to_bodies() ? StageVerdict::kNext : pivot(attempt);
}

bool StagePivoting::left_to_bodies() {
  return model_.system.uses_primal_system() || model_.contacts.soft() ||
         (primal_stages_left_ > 0 && primal_stages_left_-- > 0);
}

/// Solves with renewed laws until all agree.
StageVerdict StagePivoting::pivot(StageAttempt& attempt) {
  const std::span<double> lambda = attempt.stage.lambda;
  const bool only_axes = model_.contacts.empty();
  ActiveSetSettings settings = this->settings(attempt.rate_tolerance);
  guess_.assign(lambda.begin(), lambda.end());
  double earlier = std::numeric_limits<double>::infinity();  // contacts' residual some solves ago
  for (int solve = 0;; ++solve) {
    settings.keep_null_space = solve > 0;
    outcome_ = active_->solve(attempt.laws, attempt.b, lambda, attempt.w, attempt.report.times, settings);
    attempt.report.counts.pivots += outcome_.pivots;
    if (!outcome_.ok() && only_axes) return after_stall(attempt, settings.rate_tolerance == 0);
    const bool moved = model_.move_laws(attempt.problem(), attempt.rate_tolerance);
    const bool slid = model_.contacts.adapt(lambda, attempt.w, attempt.rate_tolerance);
    const bool met = outcome_.ok() && !moved && !slid;
    if (met && !residual_.exact(attempt.solution(lambda))) {  // the tolerance of rates has let it pass
      if (settings.rate_tolerance == 0) return give_up(attempt, false);
      settings.rate_tolerance = 0;
      continue;
    }
    if (met) {
      const Sticking sticking = search_sticking(attempt);
      if (sticking == Sticking::kFound) return StageVerdict::kMet;
      if (sticking == Sticking::kNoneNeeded) return finish(attempt);
    }
    if (is_out_of_patience(solve, met, earlier)) return only_axes ? jam(attempt) : give_up(attempt, true);
    turn_contacts(attempt);
    attempt.stage.renew();
  }
}

/// From a warm start, with the bodies as fall-back where there are contacts or many bounded rows.
ActiveSetSettings StagePivoting::settings(double rate_tolerance) const {
  const bool contacts = !model_.contacts.empty();
  ActiveSetSettings settings{.rate_tolerance = rate_tolerance};
  if (contacts) settings.max_rounds = Tuning::kContactRounds;
  if (contacts || has_many_bounded_rows()) settings.max_descent_rounds = 0;
  return settings;
}

bool StagePivoting::has_many_bounded_rows() const {
  return std::ssize(model_.system.rows().axis_rows()) >= Tuning::kManyRows;
}

StageVerdict StagePivoting::finish(StageAttempt& attempt) const {
  double& worst = attempt.report.complementarity_residual;
  worst = std::max({worst, outcome_.residual, model_.contacts.residual()});
  return StageVerdict::kMet;
}

/// From the guess through the bodies, and the next stages at once if that is wanted.
StageVerdict StagePivoting::give_up(StageAttempt& attempt, bool next_too) {
  if (next_too) primal_stages_left_ = Tuning::kPrimalStagesInARow;
  std::copy(guess_.begin(), guess_.end(), attempt.stage.lambda.begin());
  return StageVerdict::kNext;
}

/// Without contacts: a failure, unless what is asked for are the last digits, or the rows are so many that
/// the bodies are the fall-back.
StageVerdict StagePivoting::after_stall(StageAttempt& attempt, bool polishes) {
  const bool many = has_many_bounded_rows();
  if (!polishes && (!many || outcome_.status != ActiveSetStatus::kNotConverged)) return StageVerdict::kFailed;
  return give_up(attempt, many);
}

StageVerdict StagePivoting::jam(StageAttempt& attempt) {
  culprits_.find_jam(attempt.stage.lambda, attempt.inertia);
  return StageVerdict::kFailed;
}

/// After so many solves, or with contacts if the active set fails or friction settles too slowly; `earlier`:
/// the residual of that when it was looked at last.
bool StagePivoting::is_out_of_patience(int solve, bool met, double& earlier) const {
  if (solve >= Tuning::kMaxAxisSolves) return true;
  if (model_.contacts.empty()) return false;
  if (!outcome_.ok()) return true;
  if (solve % Tuning::kFrictionPatience != Tuning::kFrictionPatience - 1) return false;
  if (!met && model_.contacts.residual() > Tuning::kFrictionProgress * earlier) return true;
  earlier = model_.contacts.residual();
  return false;
}

/// Contacts that stuck and slip in this solution: whether there is one in which they hold.
StagePivoting::Sticking StagePivoting::search_sticking(StageAttempt& attempt) {
  if (!model_.contacts.slips_where_it_held()) return Sticking::kNoneNeeded;
  StageRecord record;
  const bool holds =
      contact_solver_.search_sticking_solution(attempt.problem(), attempt.rate_tolerance, record);
  attempt.add(record);
  if (!holds) return model_.contacts.weakened() ? Sticking::kLetGo : Sticking::kNoneNeeded;
  take_segments(attempt.solution(attempt.stage.lambda));
  return model_.move_laws(attempt.problem(), attempt.rate_tolerance) ? Sticking::kLetGo : Sticking::kFound;
}

/// Turned tangents: in all that has a row, then in J and its factor.
void StagePivoting::turn_contacts(StageAttempt& attempt) {
  if (model_.contacts.turns().empty()) return;
  const Stage& stage = attempt.stage;
  for (const ContactLaws::Turn& turn : model_.contacts.turns()) {
    const int first = model_.contacts.first_row(turn.place);
    const int count = model_.contacts.row_count(turn.place);
    for (std::span<double> values : {stage.lambda, stage.rates, attempt.b, std::span<double>(guess_)})
      for (int r = first + 1; r < first + count; r += 3) {
        const double a = values[r], b = values[r + 1];
        values[r] = turn.cos * a + turn.sin * b;
        values[r + 1] = turn.cos * b - turn.sin * a;
      }
  }
  model_.contacts.turned(model_.system);
  const std::span<const double> J = model_.system.jacobian().last(stage.contact_jacobian.size());
  std::copy(J.begin(), J.end(), stage.contact_jacobian.begin());
  model_.system.factorize(attempt.report.times);
}

void StagePivoting::take_segments(const StageSolution& solution) {
  const auto& [laws, b, inertia, lambda, w] = solution;
  outcome_ = {};
  if (!model_.friction_dominated()) {
    active_->reset();
    active_->prepare(laws, b, lambda);
    return;
  }
  segments_scratch_.resize(lambda.size());
  for (std::size_t r = 0; r < lambda.size(); ++r) {
    const double own = 1 / inertia[r];
    segments_scratch_[r] = laws[r].resolve(own, w[r] - own * lambda[r]).segment;
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
