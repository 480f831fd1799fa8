#include "solvers/complementarity/primal_dual_active_set.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {
namespace {

/// Iterations go on until they take away less than half of what is left.
constexpr double kPieceProgress = 0.5;
/// So many in a row that do not are given up.
constexpr int kPieceStuck = 2;
/// A factor of before serves as long as it leaves less than this part, and W has changed by less than that.
constexpr double kServes = 0.3, kNearby = 1e-6;
/// Better than this is round-off.
constexpr double kExact = 1e-14;

}  // namespace

PrimalDualOutcome PrimalDualActiveSet::solve(std::span<const RowLaw> laws, std::span<const double> b,
                                             std::span<double> lambda, std::span<double> w,
                                             const PrimalDualLimits& limits, StageTimes& times) {
  const std::size_t n = laws.size();
  for (auto* values : {&own_, &stiffness_, &change_, &rates_}) values->assign(n, 0.0);
  v_.assign(6 * static_cast<std::size_t>(system_.rows().body_count()), 0.0);
  segments_.resize(n);
  system_.effective_masses(own_);
  for (double& own : own_) own = own > 0 ? 1 / own : 1;
  PrimalDualOutcome outcome;
  double last = std::numeric_limits<double>::infinity();
  int stuck = 0;
  for (;; ++outcome.iterations) {
    system_.rates(lambda, b, w);
    double error = 0, counted = 0, scale = 0, sum = 0;
    for (std::size_t r = 0; r < n; ++r) {
      const RowLaw::Point answer = laws[r].resolve(own_[r], w[r] - own_[r] * lambda[r]);
      const double root = std::sqrt(own_[r]), off = root * std::abs(lambda[r] - answer.lambda);
      // Not where λ is: interior points leave all rows between their bounds, also those that slide.
      segments_[r] = answer.segment;
      scale = std::max(scale, root * std::abs(lambda[r]));
      sum += off + root * std::abs(lambda[r]);
      error = std::max(error, off);
      if (!(root * off <= limits.rate_tolerance)) counted = std::max(counted, off);
    }
    if (!std::isfinite(sum)) return outcome;  // a maximum passes over what is not a number
    outcome.residual = counted > 0 ? counted / scale : 0;
    outcome.converged = outcome.residual <= limits.tolerance;
    const bool done = outcome.converged && (error > kPieceProgress * last || error <= kExact * scale);
    stuck = error > kPieceProgress * last ? stuck + 1 : 0;
    if (done || stuck == kPieceStuck || outcome.iterations == limits.iterations) return outcome;
    const bool serves = error < kServes * last;
    last = error;
    if (!factorize(laws, limits.softness, serves, times)) return outcome;
    for (std::size_t r = 0; r < n; ++r) {
      const int segment = segments_[r];
      change_[r] = RowLaw::is_vertical(segment) ? stiffness_[r] * (laws[r].rate(segment) - w[r])
                                                : laws[r].force(segment) - lambda[r] - stiffness_[r] * w[r];
    }
    system_.to_bodies(change_, v_);
    system_.solve_bodies(v_);
    system_.to_rows(v_, rates_);
    for (std::size_t r = 0; r < n; ++r) lambda[r] += change_[r] - stiffness_[r] * rates_[r];
  }
}

/// P of the present segments and W, or one of before that is nearly the same and still serves.
bool PrimalDualActiveSet::factorize(std::span<const RowLaw> laws, double softness, bool serves,
                                    StageTimes& times) {
  for (std::size_t r = 0; r < laws.size(); ++r)
    stiffness_[r] = RowLaw::is_vertical(segments_[r]) ? 1 / (softness * own_[r]) : laws[r].slope;
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
  return change <= kNearby * size;
}

}  // namespace taut
