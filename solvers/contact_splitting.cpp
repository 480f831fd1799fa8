#include "solvers/contact_splitting.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

/// λ is replaced by this much of it, the rest from y [Boyd2011].
constexpr double kRelaxation = 1.6;
/// ρ is put right every so many iterations, if one of the two residuals outweighs the other by this factor.
constexpr int kRhoPeriod = 25;
constexpr double kImbalance = 5;
constexpr double kLeastRho = 1e-6, kMostRho = 1e3;

}  // namespace

SplittingOutcome ContactSplitting::solve(const ContactForces& contacts, std::span<const RowLaw> laws,
                                         std::span<const double> b, std::span<double> lambda,
                                         std::span<double> w, double tolerance, double rate_tolerance,
                                         int max_iterations, StageTimes& times) {
  const int n = system_.row_count();
  for (auto* values : {&states_, &diagonal_, &x_, &y_, &last_, &u_, &target_, &right_})
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
  system_.multiply(lambda, w);
  for (int r = 0; r < n; ++r) {
    y_[r] = lambda[r];
    if (states_[r] > 0 && states_[r] != kMasked) u_[r] = -(w[r] + b[r] - target_[r]) / states_[r];
  }
  for (int r = 0; r < n; ++r) x_[r] = y_[r] + u_[r];
  answer(contacts, laws);
  for (int r = 0; r < n; ++r) {
    if (states_[r] == 0 || states_[r] == kMasked) continue;
    u_[r] = x_[r] - y_[r];
  }
  for (outcome.iterations = 1; outcome.iterations <= max_iterations; ++outcome.iterations) {
    for (int r = 0; r < n; ++r) {
      const double sigma = states_[r];
      right_[r] = sigma == 0         ? laws[r].rate(1) - b[r]
                  : sigma == kMasked ? 0
                                     : target_[r] - b[r] + sigma * (y_[r] - u_[r]);
    }
    solve_linear(lambda);
    last_ = y_;
    for (int r = 0; r < n; ++r)
      x_[r] = states_[r] == 0 ? lambda[r] : kRelaxation * lambda[r] + (1 - kRelaxation) * y_[r] + u_[r];
    answer(contacts, laws);
    double primal = 0, dual = 0;
    for (int r = 0; r < n; ++r) {
      const double root = std::sqrt(diagonal_[r]), sigma = states_[r];
      if (sigma == 0 || sigma == kMasked) continue;
      u_[r] = x_[r] - y_[r];
      // Redundant rows may contradict each other by round-off, and impulses then drift for ever.
      const double apart = diagonal_[r] * std::abs(lambda[r] - y_[r]),
                   moved = sigma * std::abs(y_[r] - last_[r]);
      if (apart > rate_tolerance) primal = std::max(primal, apart / root);
      if (moved > rate_tolerance) dual = std::max(dual, moved / root);
    }
    outcome.residual = scale > 0 ? std::max(primal, dual) / scale : 0;
    if (!(outcome.residual > tolerance)) {
      outcome.converged = outcome.residual == outcome.residual;
      break;
    }
    if (outcome.iterations % kRhoPeriod != 0) continue;
    if (primal < kImbalance * dual && dual < kImbalance * primal) continue;
    const double factor = std::clamp(std::sqrt(primal / std::max(dual, 1e-300)), 0.1, 10.0);
    const double next = std::clamp(rho_ * factor, kLeastRho, kMostRho);
    for (double& u : u_) u *= rho_ / next;
    rho_ = next;
    factorize(laws, contacts, times, outcome);
  }
  system_.multiply(lambda, w);
  for (int r = 0; r < n; ++r) w[r] += b[r];
  return outcome;
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
