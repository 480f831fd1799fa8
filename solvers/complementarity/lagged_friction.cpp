#include "solvers/complementarity/lagged_friction.h"

#include <algorithm>
#include <limits>

#include "solvers/complementarity/contact_newton_tuning.h"

namespace taut {

void LaggedFriction::begin(const ContactProblem& problem, Lag lag) {
  const int contacts = problem.contacts.count();
  shift_.assign(problem.lambda.size(), 0.0);
  radius_.assign(contacts, 0.0);
  for (auto* values : {&s_, &f_, &next_}) values->setZero(contacts);
  extrapolation_.begin(contacts);
  rounds_ = 0;
  lag_ = lag;
  for (int k = 0; k < contacts; ++k) {
    const ContactLaws::Cone cone = problem.contacts.cone(k);
    if (!by_radius(cone)) continue;
    const double normal = cone.normal_given + problem.lambda[problem.contacts.first_row(k)];
    radius_[k] = cone.sliding * std::max(0.0, normal);
  }
}

void LaggedFriction::hold_nothing() {
  lag_ = Lag::kNothing;
  ++rounds_;
  std::fill(shift_.begin(), shift_.end(), 0.0);
}

double LaggedFriction::advance(const ContactProblem& problem, std::span<const double> y, Lag lag) {
  const bool same = lag == lag_;
  lag_ = lag;
  ++rounds_;
  if (problem.contacts.count() == 0) return -std::numeric_limits<double>::infinity();
  double off = 0;
  if (same) {
    read(problem, s_);
    answer(problem, y, f_);
    f_ -= s_;
    off = extrapolate();
  } else {
    forget();
    answer(problem, y, next_);
  }
  take(problem);
  return off;
}

/// The s that was used [√J].
void LaggedFriction::read(const ContactProblem& problem, Eigen::VectorXd& s) const {
  for (int k = 0; k < problem.contacts.count(); ++k) {
    const int row = problem.contacts.first_row(k);
    const double root = std::sqrt(problem.diagonal[row]);
    s[k] = by_radius(problem.contacts.cone(k)) ? root * radius_[k] : shift_[row] / root;
  }
}

/// The s that belongs to the present impulses and rates [√J].
void LaggedFriction::answer(const ContactProblem& problem, std::span<const double> y,
                            Eigen::VectorXd& s) const {
  for (int k = 0; k < problem.contacts.count(); ++k) {
    const ContactLaws::Cone cone = problem.contacts.cone(k);
    const int row = problem.contacts.first_row(k), slide = row + ContactLaws::kSlidingRow;
    const double root = std::sqrt(problem.diagonal[row]);
    const auto off = [&](int r) { return problem.w[r] - problem.target[r]; };
    const double lagged = by_radius(cone) ? root * std::max(0.0, cone.normal_given + y[row])
                                          : std::hypot(off(slide), off(slide + 1)) / root;
    s[k] = cone.works && !cone.shares ? cone.sliding * lagged : 0;
  }
}

/// The next s, and the largest f.  Points that wedge each other let s go to and fro, or shrink by a hundredth
/// only: then by half of f, and with a new memory now and then.
double LaggedFriction::extrapolate() {
  using Tuning = ContactNewtonTuning;
  const bool slow = rounds_ > Tuning::kManyRounds;
  if (slow && rounds_ % Tuning::kPeriod == 0) forget();
  next_ = extrapolation_.extrapolate(s_, f_, slow ? Tuning::kMixing : 1);
  return f_.lpNorm<Eigen::Infinity>();
}

/// The next s as shifts and radii.
void LaggedFriction::take(const ContactProblem& problem) {
  for (int k = 0; k < problem.contacts.count(); ++k) {
    const int row = problem.contacts.first_row(k);
    const double root = std::sqrt(problem.diagonal[row]), value = std::max(0.0, next_[k]);
    const bool radius = by_radius(problem.contacts.cone(k));
    shift_[row] = radius ? 0 : value * root;
    radius_[k] = radius ? value / root : 0;
  }
}

}  // namespace taut
