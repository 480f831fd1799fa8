#include "solvers/complementarity/proximal_round.h"

#include <algorithm>
#include <cmath>

namespace taut {

void ProximalRound::History::add(double size, double scale) {
  const bool at_round_off = least <= Tuning::kDescentRoundOff * scale;
  stuck = size > Tuning::kStuckPart * least && at_round_off ? stuck + 1 : 0;
  least = std::min(least, size);
  if (looks++ == 0) first = size;
}

void ProximalRound::resize() {
  const int n = system_.row_count();
  for (auto* values : {&x_, &change_, &rates_, &rates_of_step_}) values->assign(n, 0.0);
  for (auto* values : {&v_, &gradient_, &step_}) values->setZero(6 * system_.rows().body_count());
  metric_.begin(n);
  coupled_step_.reserve(gradient_.size());
}

void ProximalRound::start(std::span<const double> centre, std::span<const double> w) {
  centre_.assign(centre.begin(), centre.end());
  base_.assign(w.begin(), w.end());
  v_.setZero();
  std::fill(rates_.begin(), rates_.end(), 0.0);
}

void ProximalRound::begin_steps(const ContactProblem& problem, double rho, double residual) {
  metric_.set(system_.rows(), problem, rho);
  tolerance_ = std::max(Tuning::kForcing * std::min(residual, Tuning::kForcing), Tuning::kLeastGradient) *
               problem.scale;
  history_ = {};
}

std::span<const double> ProximalRound::x(const ContactProblem& problem, double length) {
  const std::span<const double> sigma = metric_.sigma(), carry = metric_.carry();
  for (std::size_t r = 0; r < x_.size(); ++r)
    x_[r] = carry[r] * centre_[r] -
            (base_[r] + rates_[r] + length * rates_of_step_[r] - problem.target[r]) / sigma[r];
  return x_;
}

ProximalRound::Verdict ProximalRound::look(const ContactProblem& problem, std::span<const double> y,
                                           int left) {
  for (std::size_t r = 0; r < y.size(); ++r) change_[r] = y[r] - centre_[r];
  system_.apply_Wt(change_, span_of(gradient_));
  gradient_ = v_ - gradient_;
  const double size = gradient_.lpNorm<Eigen::Infinity>();
  if (!std::isfinite(size)) return Verdict::kGivenUp;
  history_.add(size, problem.scale);
  if (size <= tolerance_ || history_.stuck == Tuning::kStuck) return Verdict::kMet;
  const bool blows_up = size > Tuning::kBlowUp * history_.first;
  const bool open = !blows_up && left > 0 && history_.looks <= Tuning::kStepsPerRound;
  return open ? Verdict::kOpen : Verdict::kGivenUp;
}

bool ProximalRound::find_step(ContactProjection& projection, StageTimes& times) {
  const std::span<const double> sigma = metric_.sigma();
  const std::span<double> D = projection.slope();
  for (std::size_t r = 0; r < D.size(); ++r) D[r] /= sigma[r];
  if (!system_.factorize_bodies(projection.turned(), D, times)) return false;
  coupled_step_.solve(projection, sigma, gradient_, step_);
  system_.apply_W(span_of(step_), rates_of_step_);
  along_ = step_.dot(v_);
  square_ = step_.squaredNorm();
  return true;
}

double ProximalRound::slope(std::span<const double> y, double length) const {
  double slope = along_ + length * square_;
  for (std::size_t r = 0; r < y.size(); ++r) slope -= rates_of_step_[r] * (y[r] - centre_[r]);
  return slope;
}

void ProximalRound::move(double length) {
  v_ += length * step_;
  for (std::size_t r = 0; r < rates_.size(); ++r) rates_[r] += length * rates_of_step_[r];
}

}  // namespace taut
