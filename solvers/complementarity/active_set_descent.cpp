#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/interruption.h"
#include "solvers/complementarity/active_set.h"

/// The fall-back of the active set: a descent on the convex function whose minimum is the solution,
///
///     E(λ) = ½ λᵀSλ + bᵀλ + Σ ψ_r(λ_r),   −ψ_r'(λ_r) the rate at which the law of row r gives λ_r,
///
/// by sweeps of projected Gauss–Seidel, which move any number of rows to other segments, and exact
/// minimisation on the segments that result, cut short by a line search [MoreToraldo1991].
/// (solvers/complementarity, "The active set")
namespace taut {

ActiveSet::Search ActiveSet::descend(const Problem& problem, StageTimes& times, ActiveSetOutcome& outcome) {
  bool at_minimum = true;  // of E on the present segments
  while (outcome.descent_rounds++ < problem.settings.max_descent_rounds) {
    detail::poll_interrupt();
    if (at_minimum) {
      (void)gauss_seidel_.solve(problem.laws, problem.b, problem.lambda, Tuning::kSweeps, 0);
      for (std::size_t r = 0; r < segments_.size(); ++r)
        segments_[r] = problem.laws[r].segment_at(problem.lambda[r]);
    }
    states_from_segments(problem.laws);
    read_segment_residuals(problem);
    std::copy(problem.lambda.begin(), problem.lambda.end(), start_lambda_.begin());
    std::copy(problem.w.begin(), problem.w.end(), start_w_.begin());

    const int budget = problem.settings.update_factor && !system_.singular() ? update_budget() : -1;
    if (!solve_segments(problem, Start::kKeep, budget, times, outcome)) return Search::kNotFinite;
    if (find_wrong_rows(problem) == 0) {
      // What Gauss–Seidel left in the null space of dependent rows goes, if the segments allow.
      if (!solve_segments(problem, Start::kLeastNorm, budget, times, outcome)) return Search::kNotFinite;
      if (find_wrong_rows(problem) == 0) return Search::kFound;
      if (!solve_segments(problem, Start::kKeep, budget, times, outcome)) return Search::kNotFinite;
      (void)find_wrong_rows(problem);
    }
    keep_best(problem);
    const bool off = system_.singular() && segment_residual_ > problem.settings.tolerance * scale_;
    at_minimum = step_towards_decision(problem);
    if (off && at_minimum) {
      // Nothing stops impulses that grow without bound: E has no minimum, there is no solution.
      if (!solve_segments(problem, Start::kLeastNorm, budget, times, outcome)) return Search::kNotFinite;
      return Search::kFound;
    }
  }
  return Search::kStalled;
}

/// From start_lambda_ to the least E on the way to decision_, where the rows want to go, along the null space
/// too. Rows that stop it at the end of their vertical stay there.  Returns whether nothing stopped it.
bool ActiveSet::step_towards_decision(const Problem& problem) {
  for (std::size_t r = 0; r < states_.size(); ++r) decision_[r] -= start_lambda_[r];
  system_.multiply(decision_, slope_);
  const auto [low, high] = line_search(problem);
  for (std::size_t r = 0; r < states_.size(); ++r) {
    const double d = decision_[r];
    double& lambda = problem.lambda[r];
    lambda = start_lambda_[r] + low * d;
    if (d == 0) continue;
    const RowLaw& law = problem.laws[r];
    const int before = law.segment_at(lambda), after = law.segment_at(start_lambda_[r] + high * d);
    segments_[r] = after;
    if (before == after || law.slope > 0) continue;
    // Without a slope only ends of verticals are crossed: a level.
    const int level = RowLaw::is_vertical(before) ? before + (d > 0 ? -1 : 1) : before;
    segments_[r] = level;
    lambda = law.force(level);
  }
  return low == high;
}

/// The t in [0, 1] at which E(λ₀ + t d) is least, between two numbers: the root of
///     g(t) = dᵀ(w₀ + t S d) − Σ d_r · (rate of row r's law at λ_r),
/// which never falls.  d in decision_, S d in slope_.
std::pair<double, double> ActiveSet::line_search(const Problem& problem) const {
  const auto derivative = [&](double t) {
    double g = 0;
    for (std::size_t r = 0; r < states_.size(); ++r) {
      const double d = decision_[r];
      if (d == 0) continue;
      g += d * (start_w_[r] + t * slope_[r] - problem.laws[r].rate_at(start_lambda_[r] + t * d));
    }
    return g;
  };
  bool stays = true;
  for (std::size_t r = 0; r < states_.size() && stays; ++r)
    stays = decision_[r] == 0 || segments_[r] == problem.laws[r].segment_at(start_lambda_[r] + decision_[r]);
  if (stays || derivative(1) <= 0) return {1, 1};
  double low = 0, high = 1;
  for (int i = 0; i < Tuning::kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (derivative(middle) <= 0 ? low : high) = middle;
  }
  return {low, high};
}

}  // namespace taut
