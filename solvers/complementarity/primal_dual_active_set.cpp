#include "solvers/complementarity/primal_dual_active_set.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {

PrimalDualOutcome PrimalDualActiveSet::solve(std::span<const RowLaw> laws, std::span<const double> b,
                                             std::span<double> lambda, std::span<double> w,
                                             const PrimalDualLimits& limits, StageTimes& times) {
  begin(laws.size());
  PrimalDualOutcome outcome;
  double last = std::numeric_limits<double>::infinity();
  int stuck = 0;
  for (;; ++outcome.iterations) {
    system_.rates(lambda, b, w);
    const Error error = choose_segments(laws, lambda, w, limits.rate_tolerance);
    if (!error.largest.finite()) return outcome;
    const double largest = error.largest.size();
    outcome.residual = error.counted.over(error.scale);
    outcome.converged = outcome.residual <= limits.tolerance;
    const bool slow = largest > Tuning::kProgress * last;
    const bool done = outcome.converged && (slow || largest <= Tuning::kExact * error.scale);
    stuck = slow ? stuck + 1 : 0;
    if (done || stuck == Tuning::kStuck || outcome.iterations == limits.iterations) return outcome;
    const bool serves = largest < Tuning::kServes * last;
    last = largest;
    if (!factorize(laws, limits.softness, serves, times)) return outcome;
    correct(laws, lambda, w);
  }
}

void PrimalDualActiveSet::begin(std::size_t rows) {
  for (auto* values : {&diagonal_, &stiffness_, &change_, &rates_}) values->assign(rows, 0.0);
  v_.assign(6 * static_cast<std::size_t>(system_.rows().body_count()), 0.0);
  segments_.resize(rows);
  system_.effective_masses(diagonal_);
  for (double& s : diagonal_) s = delassus_diagonal(s);
}

/// The segments that each row by itself would take, and how far λ is from them.
PrimalDualActiveSet::Error PrimalDualActiveSet::choose_segments(std::span<const RowLaw> laws,
                                                                std::span<const double> lambda,
                                                                std::span<const double> w,
                                                                double rate_tolerance) {
  Error error;
  for (std::size_t r = 0; r < laws.size(); ++r) {
    const RowLaw::Point answer = laws[r].resolve(diagonal_[r], w[r] - diagonal_[r] * lambda[r]);
    const NaturalResidual off(diagonal_[r], lambda[r] - answer.lambda);
    // Not where λ is: interior points leave all rows between their bounds, also those that slide.
    segments_[r] = answer.segment;
    error.scale = std::max(error.scale, std::sqrt(diagonal_[r]) * std::abs(lambda[r]));
    error.largest.add(off.size);
    error.counted.add(off.beyond(rate_tolerance));
  }
  return error;
}

/// λ of the present segments, with the factor.
void PrimalDualActiveSet::correct(std::span<const RowLaw> laws, std::span<double> lambda,
                                  std::span<const double> w) {
  for (std::size_t r = 0; r < laws.size(); ++r) {
    const int segment = segments_[r];
    change_[r] = RowLaw::is_vertical(segment) ? stiffness_[r] * (laws[r].rate(segment) - w[r])
                                              : laws[r].force(segment) - lambda[r] - stiffness_[r] * w[r];
  }
  system_.apply_Wt(change_, v_);
  system_.solve_bodies(v_);
  system_.apply_W(v_, rates_);
  for (std::size_t r = 0; r < laws.size(); ++r) lambda[r] += change_[r] - stiffness_[r] * rates_[r];
}

/// P of the present segments and W, or an earlier one that is nearly the same and still serves.
bool PrimalDualActiveSet::factorize(std::span<const RowLaw> laws, double softness, bool serves,
                                    StageTimes& times) {
  for (std::size_t r = 0; r < laws.size(); ++r)
    stiffness_[r] = RowLaw::is_vertical(segments_[r]) ? 1 / (softness * diagonal_[r]) : laws[r].slope;
  if (serves && is_near(laws)) return true;
  const std::span<const double> weighted = system_.weighted();
  factored_segments_ = segments_;
  factored_stiffness_ = stiffness_;
  factored_weighted_.assign(weighted.begin(), weighted.end());
  const bool ok = system_.factorize_bodies(weighted, stiffness_, times);
  version_ = ok ? system_.body_factor_version() : -1;
  return ok;
}

/// The factor is this one's, and of a P that differs by little.
bool PrimalDualActiveSet::is_near(std::span<const RowLaw> laws) const {
  const std::span<const double> weighted = system_.weighted();
  if (version_ != system_.body_factor_version() || segments_ != factored_segments_) return false;
  for (std::size_t r = 0; r < laws.size(); ++r)
    if (!RowLaw::is_vertical(segments_[r]) && stiffness_[r] != factored_stiffness_[r]) return false;
  double size = 0, change = 0;
  for (std::size_t i = 0; i < weighted.size(); ++i) {
    size = std::max(size, std::abs(weighted[i]));
    change = std::max(change, std::abs(weighted[i] - factored_weighted_[i]));
  }
  return change <= Tuning::kNearby * size;
}

}  // namespace taut
