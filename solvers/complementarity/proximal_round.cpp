#include "solvers/complementarity/proximal_round.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {
namespace {

/// Sizes of the gradient from step to step of a round.
struct GradientHistory {
  double first = -1, least = std::numeric_limits<double>::infinity();
  int stuck = 0;  // steps since it fell, at round-off

  void add(double size, double scale) {
    const bool at_round_off = least <= ContactNewtonTuning::kDescentRoundOff * scale;
    stuck = size > 0.5 * least && at_round_off ? stuck + 1 : 0;
    least = std::min(least, size);
    if (first < 0) first = size;
  }
};

}  // namespace

void ProximalRound::begin(const ContactProblem& problem) {
  const int n = system_.row_count();
  for (auto* values : {&base_, &change_, &rates_, &rates_of_step_}) values->assign(n, 0.0);
  for (auto* values : {&v_, &gradient_, &step_}) values->setZero(6 * system_.rows().body_count());
  metric_.begin(n);
  coupled_step_.reserve(gradient_.size());
  projection_.begin(problem.lambda);
  start(problem);
}

void ProximalRound::start(const ContactProblem& problem) {
  centre_ = projection_.y();
  std::copy(problem.w.begin(), problem.w.end(), base_.begin());
  v_.setZero();
  std::fill(rates_.begin(), rates_.end(), 0.0);
}

bool ProximalRound::minimize(const ContactProblem& problem, double tolerance, int most, int& steps,
                             StageTimes& times) {
  project(problem, 0);
  GradientHistory history;
  for (int step = 0;; ++step) {
    read_gradient();
    const double size = gradient_.lpNorm<Eigen::Infinity>();
    if (!std::isfinite(size)) return false;
    history.add(size, problem.scale);
    if (size <= tolerance || history.stuck == Tuning::kStuck) return true;
    if (step == Tuning::kStepsPerRound || size > Tuning::kBlowUp * history.first || steps >= most)
      return false;
    ++steps;
    if (!find_step(times)) return false;
    search(problem);
  }
}

/// y and P' of x at the present velocities and `length` of the step.
void ProximalRound::project(const ContactProblem& problem, double length) {
  const std::span<const double> sigma = metric_.sigma(), carry = metric_.carry();
  const std::span<double> x = projection_.x();
  for (std::size_t r = 0; r < x.size(); ++r)
    x[r] = carry[r] * centre_[r] -
           (base_[r] + rates_[r] + length * rates_of_step_[r] - problem.target[r]) / sigma[r];
  projection_.project(problem, sigma);
}

/// The gradient δv − Wᵀ (y − λ̄).
void ProximalRound::read_gradient() {
  const std::span<const double> y = projection_.y();
  for (std::size_t r = 0; r < y.size(); ++r) change_[r] = y[r] - centre_[r];
  system_.apply_Wt(change_, span_of(gradient_));
  gradient_ = v_ - gradient_;
}

/// Newton's step with the primal matrix 1 + Wᵀ D W, D = P' Σ⁻¹, and what friction that follows normal
/// impulses adds to it.  False if it cannot be factored.
bool ProximalRound::find_step(StageTimes& times) {
  const std::span<const double> sigma = metric_.sigma();
  const std::span<double> D = projection_.slope();
  for (std::size_t r = 0; r < D.size(); ++r) D[r] /= sigma[r];
  if (!system_.factorize_bodies(projection_.turned(), D, times)) return false;
  coupled_step_.solve(projection_, sigma, gradient_, step_);
  system_.apply_W(span_of(step_), rates_of_step_);
  return true;
}

/// How far along the step: where F along it, the slope of the function if there is one, is about 0.  Leaves
/// y and P' of there.
void ProximalRound::search(const ContactProblem& problem) {
  const double along = step_.dot(v_), square = step_.squaredNorm();
  const auto slope_at = [&](double length) {
    double slope = along + length * square;
    project(problem, length);
    const std::span<const double> y = projection_.y();
    for (std::size_t r = 0; r < y.size(); ++r) slope -= rates_of_step_[r] * (y[r] - centre_[r]);
    return slope;
  };
  const double start = step_.dot(gradient_);
  double low = 0, slope_low = start, high = 1, slope_high = slope_at(1), length = 1;
  bool last_was_high = true;
  for (int k = 0; k < Tuning::kSearches && slope_high > -Tuning::kSlope * start; ++k) {
    length = low + (high - low) * slope_low / (slope_low - slope_high);
    const double slope = slope_at(length);
    if (std::abs(slope) <= -Tuning::kSlope * start) break;
    if (slope > 0) {  // the Illinois method: an end that stays counts half
      high = length;
      slope_high = slope;
      if (last_was_high) slope_low *= 0.5;
    } else {
      low = length;
      slope_low = slope;
      if (!last_was_high) slope_high *= 0.5;
    }
    last_was_high = slope > 0;
  }
  v_ += length * step_;
  for (std::size_t r = 0; r < rates_.size(); ++r) rates_[r] += length * rates_of_step_[r];
}

}  // namespace taut
