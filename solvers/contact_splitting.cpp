#include "solvers/contact_splitting.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

/// α: how much of λ − y each iteration takes [Boyd2011].
constexpr double kRelaxation = 1.6;
/// The natural map is looked at every so many iterations, and ρ put right if one of λ − y and the change of Σ
/// y outweighs the other by a factor.
constexpr int kPeriod = 25;
constexpr double kImbalance = 5, kLeastRho = 1e-6, kMostRho = 1e3;
/// Changes of impulses that are the same from one iteration to the next, relative, and how many of them are
/// made at once at most.
constexpr double kEven = 0.1, kLongestLeap = 1e9;
/// A leap ends before laws answer with something else, by this part of a change, and must not raise λ − y by
/// more than this factor.  So many iterations of a period are neither leaps nor extrapolated.
constexpr double kAside = 0.1, kMostGrowth = 2;
constexpr int kPlain = 3;
/// Iterations after which `most` is enough.
constexpr int kPatience = 200;
/// Iterates that an extrapolation uses, and the part of its equations added to their diagonal.
constexpr int kMemory = 10;
constexpr double kRegularization = 1e-12;

}  // namespace

SplittingOutcome ContactSplitting::solve(const ContactForces& contacts, std::span<const RowLaw> laws,
                                         std::span<const double> b, std::span<double> lambda,
                                         std::span<double> w, const SplittingLimits& limits,
                                         StageTimes& times) {
  const Problem problem{contacts, laws, b, lambda, w};
  SplittingOutcome outcome;
  resize(system_.row_count());
  factorize(problem, times, outcome);
  const double scale = begin(problem);
  double bound = std::numeric_limits<double>::infinity();  // of λ − y, or back to the plain iterate
  for (outcome.iterations = 1;; ++outcome.iterations) {
    const double distance = evaluate(problem);
    const bool last = outcome.iterations >= limits.iterations || !std::isfinite(distance);
    const bool look = outcome.iterations % kPeriod == 0;
    if (look || distance <= limits.tolerance * scale || last) {
      outcome.residual = scale > 0 ? law_error(problem, limits.rate_tolerance) / scale : 0;
      const double enough = outcome.iterations > kPatience ? limits.most : limits.tolerance;
      outcome.converged = std::isfinite(distance) && outcome.residual <= enough;
      if (outcome.converged || last) return outcome;
    }
    if (distance > bound) {
      s_ = plain_;
      columns_ = 0;
      bound = std::numeric_limits<double>::infinity();
      continue;
    }
    const bool even = drifts(distance);
    if (look && !even && balance(problem, distance, times, outcome)) {
      bound = std::numeric_limits<double>::infinity();
      continue;
    }
    bound = step(problem, distance, even, outcome.iterations % kPeriod < kPlain);
  }
}

/// s ← s + f, or more.  Returns what the next λ − y must not exceed.
double ContactSplitting::step(const Problem& problem, double distance, bool even, bool plainly) {
  plain_ = s_ + f_;
  double bound = std::numeric_limits<double>::infinity();
  if (even) {
    columns_ = 0;
    leap(problem, distance);
    bound = kMostGrowth * distance;
  } else {
    remember();
    leap_ = plain_;
    if (!plainly && columns_ > 0) {
      extrapolate();
      bound = distance;
    }
  }
  last_s_ = s_;
  last_y_ = y_;
  last_f_ = f_;
  s_.swap(leap_);
  return bound;
}

void ContactSplitting::resize(int n) {
  for (auto* values : {&states_, &diagonal_, &target_, &scratch_, &refinement_}) values->assign(n, 0.0);
  for (auto* values : {&root_, &s_, &y_, &f_, &last_s_, &last_y_, &last_f_, &plain_, &leap_})
    values->setZero(n);
  for (auto* values : {&steps_, &changes_}) values->resize(n, kMemory);
  products_.resize(kMemory, kMemory);
  columns_ = next_ = 0;
}

/// s such that the laws meet the guess and its rates as far as they can.  Returns the size of impulses [√J],
/// also of those that vanish in the end.
double ContactSplitting::begin(const Problem& problem) {
  double scale = 0;
  problem.contacts.targets(target_);
  system_.multiply(problem.lambda, problem.w);
  for (int r = 0; r < system_.row_count(); ++r) {
    if (states_[r] == kMasked) continue;
    const double lambda = problem.lambda[r], b = problem.b[r];
    scale = std::max({scale, root_[r] * std::abs(lambda), std::abs(b) / root_[r]});
    if (takes_part(r)) s_[r] = lambda - (problem.w[r] + b - target_[r]) / states_[r];
  }
  return scale;
}

/// y, λ and f at s_.  Returns the largest |λ − y| √S_rr.
double ContactSplitting::evaluate(const Problem& problem) {
  const int n = system_.row_count();
  answer(problem);
  for (int r = 0; r < n; ++r) {
    const double sigma = states_[r];
    scratch_[r] = sigma == 0         ? problem.laws[r].rate(1) - problem.b[r]
                  : sigma == kMasked ? 0
                                     : target_[r] - problem.b[r] + sigma * (2 * y_[r] - s_[r]);
  }
  solve_linear(problem.lambda);
  double distance = 0;
  for (int r = 0; r < n; ++r) {
    f_[r] = takes_part(r) ? kRelaxation * (problem.lambda[r] - y_[r]) : 0;
    const double size = root_[r] * std::abs(f_[r]) / kRelaxation;
    if (!(size <= distance)) distance = size;
    if (std::isnan(distance)) break;
  }
  return distance;
}

/// (S + Σ) λ = right side in scratch_, refined once: equalities are to hold exactly.
void ContactSplitting::solve_linear(std::span<double> lambda) {
  const int n = system_.row_count();
  std::copy(scratch_.begin(), scratch_.end(), lambda.begin());
  system_.solve(lambda);
  if (!system_.shifted()) return;
  system_.multiply(lambda, refinement_);
  for (int r = 0; r < n; ++r)
    refinement_[r] = states_[r] == kMasked ? 0 : scratch_[r] - refinement_[r] - states_[r] * lambda[r];
  system_.solve(refinement_);
  for (int r = 0; r < n; ++r) lambda[r] += refinement_[r];
}

void ContactSplitting::factorize(const Problem& problem, StageTimes& times, SplittingOutcome& outcome) {
  system_.row_inertias(diagonal_);
  for (int r = 0; r < system_.row_count(); ++r) {
    diagonal_[r] = diagonal_[r] > 0 ? 1 / diagonal_[r] : 1;
    root_[r] = std::sqrt(diagonal_[r]);
    states_[r] = !problem.laws[r].bounded() ? 0 : rho_ * diagonal_[r];
  }
  problem.contacts.mask(states_, rho_, diagonal_);
  system_.set_row_states(states_);
  system_.factorize(times);
  ++outcome.factorizations;
}

/// y: what each law answers to s where the others resist with Σ.
void ContactSplitting::answer(const Problem& problem) {
  for (int r = 0; r < system_.rows().first_contact_row(); ++r)
    y_[r] = takes_part(r) ? problem.laws[r].resolve(states_[r], -states_[r] * s_[r]).lambda : 0;
  problem.contacts.answer({s_.data(), states_.size()}, {y_.data(), states_.size()});
}

/// The natural map at λ, with its w: what is sought is nearer than the fixed point, where impulses are not
/// unique.
double ContactSplitting::law_error(const Problem& problem, double rate_tolerance) const {
  system_.multiply(problem.lambda, problem.w);
  for (int r = 0; r < system_.row_count(); ++r) problem.w[r] += problem.b[r];
  double error = problem.contacts.error(problem.lambda, problem.w, rate_tolerance);
  for (int r = 0; r < system_.rows().first_contact_row(); ++r) {
    if (!takes_part(r)) continue;
    const double s = diagonal_[r], lambda = problem.lambda[r];
    const double off = std::abs(lambda - problem.laws[r].resolve(s, problem.w[r] - s * lambda).lambda);
    if (s * off > rate_tolerance) error = std::max(error, root_[r] * off);
  }
  return error;
}

/// ρ such that λ − y and the change of Σ y are of one size.  True if it was changed.
bool ContactSplitting::balance(const Problem& problem, double distance, StageTimes& times,
                               SplittingOutcome& outcome) {
  double dual = 0;
  for (Eigen::Index r = 0; r < y_.size(); ++r)
    if (takes_part(static_cast<int>(r)))
      dual = std::max(dual, states_[r] * std::abs(y_[r] - last_y_[r]) / root_[r]);
  if (distance < kImbalance * dual && dual < kImbalance * distance) return false;
  const double factor = std::clamp(std::sqrt(distance / std::max(dual, 1e-300)), 0.1, 10.0);
  const double next = std::clamp(rho_ * factor, kLeastRho, kMostRho);
  s_ = y_ + rho_ / next * (s_ - y_);
  rho_ = next;
  columns_ = 0;
  last_f_.setZero();
  factorize(problem, times, outcome);
  return true;
}

/// True if f is what it was: points wedge each other, with rates that cannot all be met, and raise their
/// impulses by the same amount in each iteration until one slides.
bool ContactSplitting::drifts(double distance) const {
  return (root_.array() * (f_ - last_f_).array()).abs().maxCoeff() <= kEven * kRelaxation * distance;
}

/// leap_ = s after so many equal changes as the laws let pass.
void ContactSplitting::leap(const Problem& problem, double distance) {
  last_s_ = s_;
  last_y_ = y_;
  double reached = 1;
  for (double leap = 2; leap <= kLongestLeap; leap *= 2) {
    s_ = last_s_ + leap * f_;
    answer(problem);
    double aside = 0;  // of rows that were within their laws
    for (Eigen::Index r = 0; r < s_.size(); ++r)
      if (last_s_[r] == last_y_[r])
        aside = std::max(aside, root_[r] * std::abs(y_[r] - last_y_[r] - leap * f_[r]));
    if (aside > kAside * kRelaxation * distance) break;
    reached = leap;
  }
  s_.swap(last_s_);
  y_.swap(last_y_);
  leap_ = s_ + reached * f_;
}

/// What f made of the last step of s.
void ContactSplitting::remember() {
  if (last_f_.isZero(0)) return;
  if (columns_ == 0) next_ = 0;
  changes_.col(next_) = root_.cwiseProduct(f_ - last_f_);
  steps_.col(next_) = root_.cwiseProduct(s_ - last_s_);
  columns_ = std::min(columns_ + 1, kMemory);
  for (int k = 0; k < columns_; ++k)
    products_(k, next_) = products_(next_, k) = changes_.col(k).dot(changes_.col(next_));
  next_ = (next_ + 1) % kMemory;
}

/// leap_ = s + f from the combination of the last steps that leaves the least f [Walker2011].
void ContactSplitting::extrapolate() {
  const int m = columns_;
  Eigen::MatrixXd normal = products_.topLeftCorner(m, m);
  normal.diagonal().array() += kRegularization * normal.trace();
  const Eigen::VectorXd f = root_.cwiseProduct(f_);
  const Eigen::VectorXd gamma = normal.ldlt().solve(changes_.leftCols(m).transpose() * f);
  if (gamma.allFinite()) leap_ -= ((steps_.leftCols(m) + changes_.leftCols(m)) * gamma).cwiseQuotient(root_);
}

}  // namespace taut
