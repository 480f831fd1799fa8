#include "solvers/complementarity/active_set.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/base/interruption.h"

namespace taut {

std::string_view to_string(ActiveSetStatus status) {
  switch (status) {
    case ActiveSetStatus::kSolved:
      return "solved";
    case ActiveSetStatus::kContradiction:
      return "contradiction";
    case ActiveSetStatus::kNotConverged:
      return "not converged";
    case ActiveSetStatus::kNotFinite:
      return "not finite";
  }
  return "?";
}

ActiveSet::ActiveSet(ConstraintSystem& system) : system_(system), updates_(system), gauss_seidel_(system) {
  const std::size_t n = system.row_count();
  segments_.assign(n, -1);
  steps_.assign(n, 0);
  moves_.assign(n, 0);
  for (auto* values : {&states_, &effective_mass_, &root_diagonal_, &residual_, &decision_, &best_lambda_,
                       &start_lambda_, &start_w_, &slope_})
    values->assign(n, 0.0);
}

void ActiveSet::reset() { std::fill(segments_.begin(), segments_.end(), -1); }

void ActiveSet::set_segments(std::span<const int> segments, std::span<const RowLaw> laws) {
  std::copy(segments.begin(), segments.end(), segments_.begin());
  for (std::size_t r = 0; r < laws.size(); ++r) steps_[r] = laws[r].steps;
}

void ActiveSet::prepare(std::span<const RowLaw> laws, std::span<const double> b,
                        std::span<const double> lambda) {
  choose_segments(laws, b, lambda);
  states_from_segments(laws);
  system_.set_row_states(states_);
}

/// Rows without history take the segment that they would take by themselves against the present impulses of
/// the others.
void ActiveSet::choose_segments(std::span<const RowLaw> laws, std::span<const double> b,
                                std::span<const double> lambda) {
  bool any = false;
  for (std::size_t r = 0; r < laws.size(); ++r) {
    // Laws may have been renewed between the last solve and set_segments(), too.
    const bool known = segments_[r] >= 0 && segments_[r] < laws[r].segments();
    if (steps_[r] != laws[r].steps || !known || !laws[r].exists(segments_[r])) segments_[r] = -1;
    steps_[r] = laws[r].steps;
    any = any || segments_[r] < 0;
  }
  if (!any) return;
  system_.effective_masses(effective_mass_);
  system_.multiply(lambda, residual_);
  for (std::size_t r = 0; r < laws.size(); ++r)
    if (segments_[r] < 0)
      segments_[r] =
          laws[r]
              .resolve(1 / effective_mass_[r], b[r] + residual_[r] - lambda[r] / effective_mass_[r])
              .segment;
}

void ActiveSet::states_from_segments(std::span<const RowLaw> laws) {
  for (std::size_t r = 0; r < laws.size(); ++r)
    states_[r] = RowLaw::is_vertical(segments_[r]) ? 0 : laws[r].slope > 0 ? 1 / laws[r].slope : kMasked;
}

ActiveSetOutcome ActiveSet::solve(std::span<const RowLaw> laws, std::span<const double> b,
                                  std::span<double> lambda, std::span<double> w, StageTimes& times,
                                  const ActiveSetSettings& settings) {
  assert(laws.size() == segments_.size() && b.size() == laws.size());
  assert(lambda.size() == laws.size() && w.size() == laws.size());
  const Problem problem{laws, b, lambda, w, settings};
  ActiveSetOutcome outcome;
  choose_segments(laws, b, lambda);
  system_.effective_masses(effective_mass_);
  for (std::size_t r = 0; r < laws.size(); ++r) root_diagonal_[r] = 1 / std::sqrt(effective_mass_[r]);
  best_residual_ = std::numeric_limits<double>::infinity();

  Search result = search(problem, times, outcome);
  if (result == Search::kStalled) result = descend(problem, times, outcome);
  if (result == Search::kStalled) {
    std::copy(best_lambda_.begin(), best_lambda_.end(), lambda.begin());
    read_segment_residuals(problem);
  }
  take_residual(problem, outcome);
  if (result == Search::kNotFinite || !std::isfinite(outcome.residual)) {
    outcome.status = ActiveSetStatus::kNotFinite;
    std::fill(lambda.begin(), lambda.end(), 0.0);  // it may be the next guess
  } else if (outcome.residual > settings.tolerance) {
    outcome.status = result == Search::kFound && system_.singular() ? ActiveSetStatus::kContradiction
                                                                    : ActiveSetStatus::kNotConverged;
  }
  if (!outcome.ok()) reset();
  return outcome;
}

ActiveSet::Search ActiveSet::search(const Problem& problem, StageTimes& times, ActiveSetOutcome& outcome) {
  int fewest = std::numeric_limits<int>::max(), trials = Tuning::kBlockTrials;
  const auto bounded = std::count_if(problem.laws.begin(), problem.laws.end(),
                                     [](const RowLaw& law) { return law.bounded(); });
  const int most = problem.settings.max_rounds >= 0
                       ? problem.settings.max_rounds
                       : Tuning::kMaxRounds + static_cast<int>(bounded) / Tuning::kRowsOfARound;
  for (int rounds = most;; --rounds) {
    if (!solve_trial(problem, trials == 0, times, outcome)) return Search::kNotFinite;
    const int wrong = find_wrong_rows(problem);
    if (wrong == 0) return Search::kFound;
    detail::poll_interrupt();
    keep_best(problem);
    if (rounds == 0) return Search::kStalled;
    if (wrong < fewest) {
      fewest = wrong;
      trials = Tuning::kBlockTrials;
    } else if (trials > 0) {
      --trials;
    }
    move_wrong_rows(trials == 0, outcome);
  }
}

/// The present segments.  A singular factor and its updates leave noise that pivoting can trip over: no
/// updates when it struggles.
bool ActiveSet::solve_trial(const Problem& problem, bool struggles, StageTimes& times,
                            ActiveSetOutcome& outcome) {
  const bool update = problem.settings.update_factor && (!struggles || !system_.singular());
  const Start start = problem.settings.keep_null_space ? Start::kKeep : Start::kLeastNorm;
  return solve_segments(problem, start, update ? update_budget() : -1, times, outcome);
}

/// All wrong rows by one segment, or the one of least index.
void ActiveSet::move_wrong_rows(bool only_first, ActiveSetOutcome& outcome) {
  ++outcome.rounds;
  if (only_first) ++outcome.least_index_rounds;
  for (std::size_t r = 0; r < moves_.size(); ++r) {
    if (moves_[r] == 0) continue;
    segments_[r] += moves_[r];
    ++outcome.pivots;
    if (only_first) break;
  }
}

/// λ and w of the present segments: w_r = w_k on verticals, λ_r = l_k − c w_r on levels.
bool ActiveSet::solve_segments(const Problem& problem, Start start, int budget, StageTimes& times,
                               ActiveSetOutcome& outcome) {
  states_from_segments(problem.laws);
  if (!updates_.set_states(states_, budget)) {
    system_.set_row_states(states_);
    system_.factorize(times);
    ++outcome.factorizations;
    if (!updates_.set_states(states_, -1)) return false;
  }
  const bool from_zero = start == Start::kLeastNorm && system_.singular();
  for (std::size_t r = 0; r < states_.size(); ++r) {
    if (states_[r] == kMasked)
      problem.lambda[r] = problem.laws[r].force(segments_[r]);
    else if (from_zero)  // nothing from other segments may stay in the null space
      problem.lambda[r] = 0;
  }
  segment_residual_ = read_segment_residuals(problem);
  for (int pass = 0; pass < Tuning::kMaxPasses && segment_residual_ > Tuning::kRefined * scale_; ++pass) {
    std::copy(residual_.begin(), residual_.end(), decision_.begin());
    updates_.solve(decision_);
    for (std::size_t r = 0; r < states_.size(); ++r) problem.lambda[r] += decision_[r];
    const double before = segment_residual_;
    segment_residual_ = read_segment_residuals(problem);
    if (!(segment_residual_ < before) && pass > 0) {
      for (std::size_t r = 0; r < states_.size(); ++r) problem.lambda[r] -= decision_[r];
      segment_residual_ = read_segment_residuals(problem);
    }
    if (!(segment_residual_ < Tuning::kPassProgress * before) && pass > 0) break;
  }
  return std::isfinite(segment_residual_);
}

/// w = S λ + b and what the equation of each segment, w = w_k or λ = l − c w, lacks; the largest, over
/// √(S_rr + Σ_r) [√J], infinite if something is not finite.  It belongs to the linear problem of the segments
/// that are tried; whether those are the right ones is for the natural residual (take_residual()).
double ActiveSet::read_segment_residuals(const Problem& problem) {
  system_.rates(problem.lambda, problem.b, problem.w);
  LargestResidual largest;
  scale_ = 0;
  for (std::size_t r = 0; r < states_.size(); ++r) {
    const double w = problem.w[r];
    scale_ = std::max({scale_, root_diagonal_[r] * std::abs(problem.lambda[r]),
                       std::abs(problem.b[r]) / root_diagonal_[r]});
    residual_[r] = 0;
    if (states_[r] == kMasked) continue;
    double stiffness = root_diagonal_[r];
    if (states_[r] == 0) {
      residual_[r] = problem.laws[r].rate(segments_[r]) - w;
      scale_ = std::max(scale_, std::abs(problem.laws[r].rate(segments_[r])) / root_diagonal_[r]);
    } else {
      residual_[r] = states_[r] * (problem.laws[r].force(segments_[r]) - problem.lambda[r]) - w;
      stiffness = std::sqrt(root_diagonal_[r] * root_diagonal_[r] + states_[r]);
    }
    largest.add(std::abs(residual_[r]) / stiffness);
  }
  return largest.strict_size();
}

/// Where dependent rows ask for rates that exclude each other, the limit of vanishing compliance decides:
/// their impulses grow along what is off target, until one of them reaches its bound.  Returns whether that
/// is so; decision_ gets the impulses to decide by.
bool ActiveSet::impulses_to_decide_by(const Problem& problem) {
  bool missed = false;
  for (std::size_t r = 0; r < states_.size() && !missed; ++r)
    missed = std::abs(residual_[r]) >
                 std::max(Tuning::kDecision * scale_ * root_diagonal_[r], problem.settings.rate_tolerance) &&
             states_[r] == 0;
  if (!missed) {
    std::copy(problem.lambda.begin(), problem.lambda.end(), decision_.begin());
    return false;
  }
  std::copy(residual_.begin(), residual_.end(), decision_.begin());
  updates_.solve_shifted(decision_);
  for (std::size_t r = 0; r < states_.size(); ++r) decision_[r] += problem.lambda[r];
  return true;
}

/// Which rows have left their segments, and to which side.
int ActiveSet::find_wrong_rows(const Problem& problem) {
  double rate_slack = Tuning::kDecision * scale_, impulse_slack = rate_slack;
  if (impulses_to_decide_by(problem) && system_.singular()) {
    // Round-off in the null space is magnified by 1 / ε.
    const double noise = ResidualTuning::kRoundOff / system_.factored_shift();
    double largest = 0;
    for (std::size_t r = 0; r < states_.size(); ++r)
      largest = std::max(largest, root_diagonal_[r] * std::abs(decision_[r]));
    impulse_slack = std::max(impulse_slack, noise * largest);
    rate_slack = std::max(rate_slack, noise * segment_residual_);
  }
  int wrong = 0;
  for (std::size_t r = 0; r < states_.size(); ++r) {
    const RowLaw& law = problem.laws[r];
    const int segment = segments_[r];
    if (RowLaw::is_vertical(segment)) {
      const double value = decision_[r] + law.slope * law.rate(segment),
                   slack = impulse_slack / root_diagonal_[r];
      moves_[r] =
          static_cast<signed char>((value < law.low(segment) - slack) - (value > law.high(segment) + slack));
    } else {
      const double w = problem.w[r],
                   slack = std::max(rate_slack * root_diagonal_[r], problem.settings.rate_tolerance);
      moves_[r] =
          static_cast<signed char>((w > law.last(segment) + slack) - (w < law.first(segment) - slack));
    }
    wrong += moves_[r] != 0;
  }
  return wrong;
}

void ActiveSet::take_residual(const Problem& problem, ActiveSetOutcome& outcome) {
  outcome.residual = scale_;
  if (!std::isfinite(scale_)) return;
  LargestResidual largest;
  largest.add_rows(
      problem.laws, [&](std::size_t r) { return root_diagonal_[r] * root_diagonal_[r]; }, problem.lambda,
      problem.w, problem.settings.rate_tolerance);
  outcome.residual = largest.over(scale_);
  outcome.worst_row = largest.row();
}

void ActiveSet::keep_best(const Problem& problem) {
  ActiveSetOutcome measured;
  take_residual(problem, measured);
  if (!(measured.residual < best_residual_)) return;
  best_residual_ = measured.residual;
  std::copy(problem.lambda.begin(), problem.lambda.end(), best_lambda_.begin());
}

/// Columns of an update that cost less than a factorisation.
int ActiveSet::update_budget() const {
  const double per_entry = system_.factor().flops() / static_cast<double>(system_.factor().nonzeros());
  const int more = static_cast<int>(per_entry / Tuning::kFlopsOfAColumn);
  return std::clamp(Tuning::kLeastColumns + more, Tuning::kLeastColumns, RowUpdates::kMaxRows);
}

}  // namespace taut
