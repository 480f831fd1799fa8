#include "solvers/contact_splitting.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

/// λ is replaced by this much of it, the rest from y [Boyd2011].
constexpr double kRelaxation = 1.6;
/// ρ is put right every so many iterations, if one of the two residuals outweighs the other by this factor.
constexpr int kPeriod = 25;
constexpr double kImbalance = 5;
constexpr double kLeastRho = 1e-6, kMostRho = 1e3;
/// Changes of impulses that are the same from one iteration to the next, relative, and how many of them are
/// made at once at most.
constexpr double kEven = 1e-3, kLongestLeap = 1e9;

}  // namespace

SplittingOutcome ContactSplitting::solve(const ContactForces& contacts, std::span<const RowLaw> laws,
                                         std::span<const double> b, std::span<double> lambda,
                                         std::span<double> w, const SplittingLimits& limits,
                                         StageTimes& times) {
  const int n = system_.row_count();
  for (auto* values :
       {&states_, &diagonal_, &x_, &y_, &last_, &change_, &last_change_, &u_, &target_, &right_})
    values->assign(n, 0.0);
  system_.row_inertias(diagonal_);
  for (double& d : diagonal_) d = d > 0 ? 1 / d : 1;
  contacts.targets(target_);
  SplittingOutcome outcome;
  factorize(laws, contacts, times, outcome);
  double scale = 0;  // of impulses [√J], also of those that vanish in the end
  for (int r = 0; r < n; ++r) {
    const double root = std::sqrt(diagonal_[r]);
    if (states_[r] != kMasked) scale = std::max({scale, root * std::abs(lambda[r]), std::abs(b[r]) / root});
  }
  begin(contacts, laws, b, lambda, w);
  for (outcome.iterations = 1; outcome.iterations <= limits.iterations; ++outcome.iterations) {
    const Distance distance = iterate(contacts, laws, b, lambda, limits.rate_tolerance);
    outcome.residual = scale > 0 ? std::max(distance.primal, distance.dual) / scale : 0;
    if (!(outcome.residual > limits.tolerance)) {
      outcome.converged = outcome.residual == outcome.residual;
      break;
    }
    if (outcome.iterations % kPeriod != 0) continue;
    if (law_error(contacts, laws, b, lambda, w, limits.rate_tolerance) <= limits.tolerance * scale) {
      outcome.converged = true;
      return outcome;
    }
    if (leap(contacts, laws)) continue;
    if (distance.primal < kImbalance * distance.dual && distance.dual < kImbalance * distance.primal)
      continue;
    const double factor = std::sqrt(distance.primal / std::max(distance.dual, 1e-300));
    const double next = std::clamp(rho_ * std::clamp(factor, 0.1, 10.0), kLeastRho, kMostRho);
    for (double& u : u_) u *= rho_ / next;
    rho_ = next;
    factorize(laws, contacts, times, outcome);
  }
  system_.multiply(lambda, w);
  for (int r = 0; r < n; ++r) w[r] += b[r];
  return outcome;
}

/// y = λ, and u such that the laws meet w = S λ + b as far as they can.
void ContactSplitting::begin(const ContactForces& contacts, std::span<const RowLaw> laws,
                             std::span<const double> b, std::span<const double> lambda, std::span<double> w) {
  const int n = system_.row_count();
  system_.multiply(lambda, w);
  for (int r = 0; r < n; ++r)
    x_[r] = lambda[r] - (takes_part(r) ? (w[r] + b[r] - target_[r]) / states_[r] : 0);
  answer(contacts, laws);
  for (int r = 0; r < n; ++r) u_[r] = takes_part(r) ? x_[r] - y_[r] : 0;
}

ContactSplitting::Distance ContactSplitting::iterate(const ContactForces& contacts,
                                                     std::span<const RowLaw> laws, std::span<const double> b,
                                                     std::span<double> lambda, double rate_tolerance) {
  const int n = system_.row_count();
  for (int r = 0; r < n; ++r) {
    const double sigma = states_[r];
    right_[r] = sigma == 0         ? laws[r].rate(1) - b[r]
                : sigma == kMasked ? 0
                                   : target_[r] - b[r] + sigma * (y_[r] - u_[r]);
  }
  solve_linear(lambda);
  last_ = y_;
  for (int r = 0; r < n; ++r)
    x_[r] = takes_part(r) ? kRelaxation * lambda[r] + (1 - kRelaxation) * y_[r] + u_[r] : lambda[r];
  answer(contacts, laws);
  change_.swap(last_change_);
  Distance distance;
  for (int r = 0; r < n; ++r) {
    change_[r] = 0;
    if (!takes_part(r)) continue;
    u_[r] = x_[r] - y_[r];
    change_[r] = y_[r] - last_[r];
    // What is only round-off in rates does not count: redundant rows may contradict each other by that.
    const double root = std::sqrt(diagonal_[r]);
    const double apart = diagonal_[r] * std::abs(lambda[r] - y_[r]),
                 moved = states_[r] * std::abs(change_[r]);
    if (apart > rate_tolerance) distance.primal = std::max(distance.primal, apart / root);
    if (moved > rate_tolerance) distance.dual = std::max(distance.dual, moved / root);
  }
  return distance;
}

/// Points that wedge each other, with rates that cannot all be met, raise their impulses by the same amount
/// in each iteration until one slides.  Takes them there at once.  True if they were.
bool ContactSplitting::leap(const ContactForces& contacts, std::span<const RowLaw> laws) {
  const int n = system_.row_count();
  double size = 0, uneven = 0;
  for (int r = 0; r < n; ++r) {
    const double root = std::sqrt(diagonal_[r]);
    size = std::max(size, root * std::abs(change_[r]));
    uneven = std::max(uneven, root * std::abs(change_[r] - last_change_[r]));
  }
  if (uneven > kEven * size) return false;
  last_ = y_;
  double reached = 0;
  for (double leap = 1; leap <= kLongestLeap; leap *= 2) {
    for (int r = 0; r < n; ++r) x_[r] = last_[r] + leap * change_[r];
    answer(contacts, laws);
    double outside = 0;
    for (int r = 0; r < n; ++r)
      if (takes_part(r)) outside = std::max(outside, std::sqrt(diagonal_[r]) * std::abs(y_[r] - x_[r]));
    if (outside > kEven * leap * size) break;
    reached = leap;
  }
  for (int r = 0; r < n; ++r) y_[r] = last_[r] + reached * change_[r];
  return reached > 0;
}

/// The natural map at λ, with its w: what is sought is nearer than the impulses that lead there, where those
/// are not unique.
double ContactSplitting::law_error(const ContactForces& contacts, std::span<const RowLaw> laws,
                                   std::span<const double> b, std::span<const double> lambda,
                                   std::span<double> w, double rate_tolerance) const {
  system_.multiply(lambda, w);
  for (int r = 0; r < system_.row_count(); ++r) w[r] += b[r];
  double error = contacts.error(lambda, w, rate_tolerance);
  for (int r = 0; r < system_.rows().first_contact_row(); ++r) {
    if (!takes_part(r)) continue;
    const double s = diagonal_[r];
    const double off = std::abs(lambda[r] - laws[r].resolve(s, w[r] - s * lambda[r]).lambda);
    if (s * off > rate_tolerance) error = std::max(error, std::sqrt(s) * off);
  }
  return error;
}

/// (S + Σ) λ = right side, refined once: equalities are to hold exactly.
void ContactSplitting::solve_linear(std::span<double> lambda) {
  const int n = system_.row_count();
  std::copy(right_.begin(), right_.end(), lambda.begin());
  system_.solve(lambda);
  if (!system_.singular()) return;
  system_.multiply(lambda, x_);
  for (int r = 0; r < n; ++r) x_[r] = states_[r] == kMasked ? 0 : right_[r] - x_[r] - states_[r] * lambda[r];
  system_.solve(x_);
  for (int r = 0; r < n; ++r) lambda[r] += x_[r];
}

void ContactSplitting::factorize(std::span<const RowLaw> laws, const ContactForces& contacts,
                                 StageTimes& times, SplittingOutcome& outcome) {
  for (int r = 0; r < system_.row_count(); ++r) states_[r] = !laws[r].bounded() ? 0 : rho_ * diagonal_[r];
  contacts.mask(states_, rho_, diagonal_);
  system_.set_row_states(states_);
  system_.factorize(times);
  ++outcome.factorizations;
}

/// y: what each law answers to x where the others resist with Σ.
void ContactSplitting::answer(const ContactForces& contacts, std::span<const RowLaw> laws) {
  for (int r = 0; r < system_.rows().first_contact_row(); ++r) {
    const double sigma = states_[r];
    if (sigma > 0)
      y_[r] = laws[r].resolve(sigma, -sigma * x_[r]).lambda;
    else
      y_[r] = x_[r];
  }
  contacts.answer(x_, y_);
}

}  // namespace taut
