#include "solvers/complementarity/contact_newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/common/max_abs.h"

namespace taut {
namespace {

/// Σ over S_rr: in the first round, how it falls from round to round, the least, and that of equalities,
/// which is less than all others so that contacts give way where they and joints ask for slightly different
/// rates.
constexpr double kFirstRho = 1e-2, kRhoFactor = 0.1, kLeastRho = 1e-5, kEqualityRho = 1e-9;
/// The first one over the residual of the guess, with nothing lagged.
constexpr double kRhoOfResidual = 100;
/// Newton's equation is met to this part of the residual of the round before, and never better than this.
constexpr double kForcing = 0.01, kLeastGradient = 1e-13;
/// Rounds after which equalities are met, as far as they can be.
constexpr int kEqualityRounds = 3;
/// Before `most` is enough in any case, equalities are to be met to so many times the tolerance of rates.
constexpr double kClosed = 9;
/// Gradients below this may be round-off, and are if so many steps do not halve them.
constexpr double kDescentRoundOff = 1e-8;
constexpr int kStuck = 2;
/// Rounds that leave more than this of the residual are slow, after so many.
constexpr double kSlowRound = 0.3;
constexpr int kFirstRounds = 3;
constexpr int kStepsPerRound = 40, kSearches = 12;
/// With nothing lagged: steps of a round, and how far its gradient may grow.
constexpr int kCoupledSteps = 20;
constexpr double kBlowUp = 10;
/// A step is taken whole if the slope at its end is at most this part of that at its start.
constexpr double kSlope = 0.5;
/// Rounds after which `most` is enough, and that the extrapolation uses.
constexpr int kPatience = 12, kMemory = 6;
/// A residual that grows by more than this ends the extrapolation; after so many rounds it is careful.
constexpr double kGrowth = 5, kMixing = 0.5;
constexpr int kSlow = 20, kPeriod = 10;
/// Part of the extrapolation's equations that is added to their diagonal.
constexpr double kRegularization = 1e-13;
/// After so many rounds the slip of contacts that can hold has fallen to less than this part in each.
constexpr int kRoundsToHold = 3;
/// Rounds may need no Newton step: so many for each that is allowed.
constexpr int kRoundsOfAStep = 10;
constexpr double kSlowSlip = 0.97;
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMemory, kMemory>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMemory, 1>;

}  // namespace

NewtonOutcome ContactNewton::solve(const ContactLaws& contacts, std::span<const RowLaw> laws,
                                   std::span<const double> b, std::span<double> lambda, std::span<double> w,
                                   const NewtonLimits& limits, StageTimes& times) {
  const Problem problem{contacts, laws, b, lambda, w};
  NewtonOutcome outcome;
  begin(problem);
  double last = 1, rho = kFirstRho, last_slip = 0;
  const auto held = [&] { return holds_joints(problem.laws, problem.w, limits.rate_tolerance); };
  if (soft_ || is_heap()) {
    const double off = law_error(problem, limits.rate_tolerance, 0);
    rho = limits.near ? kNearRho : std::clamp(kRhoOfResidual * off, kNearRho, kFirstRho);
    if (!soft_) last = off;
    begin_coupled(off);
  }
  for (;;) {
    ++outcome.rounds;
    set_sigma(problem, rho);
    const double tolerance = std::max(kForcing * std::min(last, kForcing), kLeastGradient) * scale_;
    const bool met = minimize(problem, tolerance, limits, times, outcome);
    const bool finite = met || mode_ == Mode::kCoupled;
    read_rates(problem);
    outcome.residual = law_error(problem, limits.rate_tolerance, outcome.rounds);
    if (outcome.residual > kGrowth * last) remembered_ = 0;
    const bool slow = outcome.rounds > kPatience ||
                      (outcome.rounds > kFirstRounds && !(outcome.residual <= kSlowRound * last));
    const double enough = slow ? limits.most : limits.tolerance;
    const bool closed = held(), as_closed = closed || outcome.rounds > kPatience;
    outcome.converged = finite && outcome.residual <= enough && as_closed;
    if (outcome.converged) return outcome;
    if (closed) keep_best(problem, outcome.residual);
    outcome.converged = best_residual_ <= enough;
    const double slip = limits.holding ? problem.contacts.shared_slip(problem.w) : 0;
    const bool in_vain = outcome.rounds > kRoundsToHold && slip > kSlowSlip * last_slip;
    last_slip = slip;
    if (outcome.converged || !finite || in_vain || outcome.iterations >= limits.iterations ||
        outcome.rounds >= kRoundsOfAStep * limits.iterations) {
      give_best(problem, outcome);
      return outcome;
    }
    const Mode before = mode_, mode = next_mode(problem, met, outcome.residual, rho);
    if (before == Mode::kCoupled)
      last = kept_residual_;
    else if (met)
      last = outcome.residual;
    if (next_round(problem, mode)) rho = std::max(kRhoFactor * rho, kLeastRho);
  }
}

void ContactNewton::keep_best(const Problem& problem, double residual) {
  if (!(residual < best_residual_)) return;
  best_residual_ = residual;
  best_.assign(problem.lambda.begin(), problem.lambda.end());
  best_w_.assign(problem.w.begin(), problem.w.end());
}

void ContactNewton::give_best(const Problem& problem, NewtonOutcome& outcome) const {
  if (!std::isfinite(best_residual_)) return;
  outcome.residual = best_residual_;
  std::copy(best_.begin(), best_.end(), problem.lambda.begin());
  std::copy(best_w_.begin(), best_w_.end(), problem.w.begin());
}

bool ContactNewton::is_heap() const {
  const Rows& rows = system_.rows();
  return rows.contact_count() > 0 && (rows.first_contact_row() == 0 || system_.uses_primal_system());
}

/// S_rr, the rates asked for, the size of impulses [√J] (also of those that vanish in the end), and the
/// guess.
void ContactNewton::begin(const Problem& problem) {
  const int n = system_.row_count();
  for (auto* values : {&own_, &sigma_, &target_, &shift_, &last_, &x_, &y_, &rates_, &rates_of_step_, &bound_,
                       &slope_, &base_, &change_})
    values->assign(n, 0.0);
  carry_.assign(n, 1.0);
  for (auto* values : {&best_, &best_w_, &kept_}) values->reserve(n);
  for (auto* values : {&v_, &gradient_, &step_}) values->setZero(6 * system_.rows().body_count());
  const int contacts = system_.rows().contact_count();
  for (auto* values : {&s_, &f_, &last_s_, &last_f_, &next_}) values->setZero(contacts);
  for (auto* values : {&steps_, &changes_}) values->setZero(contacts, kMemory);
  coupling_.assign(contacts, 0.0);
  rounds_ = remembered_ = mode_rounds_ = 0;
  best_residual_ = std::numeric_limits<double>::infinity();
  mode_ = lagged_ = Mode::kSlip;
  soft_ = problem.contacts.soft();
  system_.effective_masses(own_);
  turned_.assign(system_.weighted().begin(), system_.weighted().end());
  problem.contacts.targets(target_);
  for (int r = 0; r < system_.rows().first_contact_row(); ++r)
    target_[r] = problem.laws[r].bounded() ? 0 : problem.laws[r].rate(1);
  scale_ = 0;
  for (int r = 0; r < n; ++r) {
    own_[r] = own_[r] > 0 ? 1 / own_[r] : 1;
    const double root = std::sqrt(own_[r]);
    scale_ = std::max({scale_, root * std::abs(problem.lambda[r]), std::abs(problem.b[r]) / root});
    last_[r] = y_[r] = problem.lambda[r];
  }
  for (int k = 0; k < contacts; ++k) {
    const ContactLaws::Cone cone = problem.contacts.cone(k);
    const int row = problem.contacts.first_row(k);
    if (by_radius(cone)) bound_[row + 1] = cone.sliding * std::max(0.0, cone.normal_given + last_[row]);
  }
  read_rates(problem);
  start_round(problem);
}

/// λ and w of y.
void ContactNewton::read_rates(const Problem& problem) const {
  std::copy(y_.begin(), y_.end(), problem.lambda.begin());
  system_.rates(problem.lambda, problem.b, problem.w);
}

/// A round starts from λ̄ = y and its rates.
void ContactNewton::start_round(const Problem& problem) {
  last_ = y_;
  std::copy(problem.w.begin(), problem.w.end(), base_.begin());
  v_.setZero();
  std::fill(rates_.begin(), rates_.end(), 0.0);
}

/// The gradient δv − Wᵀ (y − λ̄).
void ContactNewton::read_gradient() {
  for (std::size_t r = 0; r < y_.size(); ++r) change_[r] = y_[r] - last_[r];
  system_.to_bodies(change_, span_of(gradient_));
  gradient_ = v_ - gradient_;
}

/// Compliant normals are decoupled from the disc, whose metric is another one.
bool ContactNewton::by_radius(const ContactLaws::Cone& cone) const {
  return !cone.shares && (mode_ != Mode::kSlip || cone.softness > 0 || std::isfinite(cone.most));
}

/// One Σ in a cone and in a disc, so that they keep their shape.
void ContactNewton::set_sigma(const Problem& problem, double rho) {
  const Rows& rows = system_.rows();
  for (int r = 0; r < rows.first_contact_row(); ++r)
    sigma_[r] = (problem.laws[r].bounded() ? rho : kEqualityRho) * own_[r];
  for (int k = 0; k < rows.contact_count(); ++k) {
    const int row = problem.contacts.first_row(k);
    const auto alike = [&](int from, int count) {
      const double most = *std::max_element(own_.begin() + from, own_.begin() + from + count);
      std::fill_n(sigma_.begin() + from, count, rho * most);
    };
    const ContactLaws::Cone cone = problem.contacts.cone(k);
    alike(row, 3);
    for (int i = 0; i < 3; ++i) {
      const double softness = i == 0 ? cone.softness : cone.slip_softness;
      carry_[row + i] = sigma_[row + i] / (sigma_[row + i] + softness);
      sigma_[row + i] += softness;
    }
    if (!cone.twist) continue;
    alike(row + 3, 1);
    alike(row + 4, 2);
  }
}

/// What a round leaves to the next: λ̄ = P, and the lagged s = μ |u_t|, or μ Λ_n by radius, extrapolated from
/// the last rounds [Walker2011]: without that each round leaves some part of its error, a third or two.  True
/// if λ̄ is further off than s.
bool ContactNewton::next_round(const Problem& problem, Mode mode) {
  double off_last = 0;
  for (std::size_t r = 0; r < y_.size(); ++r)
    off_last = std::max(off_last, carry_[r] * sigma_[r] * std::abs(y_[r] - last_[r]) / std::sqrt(own_[r]));
  start_round(problem);
  const int contacts = system_.rows().contact_count();
  const bool turn = mode != mode_;
  mode_ = mode;
  ++rounds_;
  if (mode == Mode::kCoupled) std::fill(shift_.begin(), shift_.end(), 0.0);
  if (mode == Mode::kCoupled) return false;
  if (contacts == 0) return true;
  double off_lagged = 0;
  if (turn) {
    remembered_ = 0;
    answer_lagged(problem, next_);
  } else {
    read_lagged(problem, s_);
    answer_lagged(problem, f_);
    f_ -= s_;
    off_lagged = f_.lpNorm<Eigen::Infinity>();
    extrapolate();
  }
  for (int k = 0; k < contacts; ++k) {
    const int row = problem.contacts.first_row(k);
    const double root = std::sqrt(own_[row]), value = std::max(0.0, next_[k]);
    const bool radius = by_radius(problem.contacts.cone(k));
    shift_[row] = radius ? 0 : value * root;
    bound_[row + 1] = radius ? value / root : 0;
  }
  return off_last > off_lagged;
}

/// The s that was used [√J].
void ContactNewton::read_lagged(const Problem& problem, Eigen::VectorXd& s) const {
  for (int k = 0; k < system_.rows().contact_count(); ++k) {
    const int row = problem.contacts.first_row(k);
    const double root = std::sqrt(own_[row]);
    s[k] = by_radius(problem.contacts.cone(k)) ? root * bound_[row + 1] : shift_[row] / root;
  }
}

/// The s that belongs to the present impulses and rates [√J].
void ContactNewton::answer_lagged(const Problem& problem, Eigen::VectorXd& s) const {
  for (int k = 0; k < system_.rows().contact_count(); ++k) {
    const ContactLaws::Cone cone = problem.contacts.cone(k);
    const int row = problem.contacts.first_row(k);
    const double root = std::sqrt(own_[row]);
    const auto off = [&](int r) { return problem.w[r] - target_[r]; };
    const double lagged = by_radius(cone) ? root * std::max(0.0, cone.normal_given + y_[row])
                                          : std::hypot(off(row + 1), off(row + 2)) / root;
    s[k] = cone.works && !cone.shares ? cone.sliding * lagged : 0;
  }
}

/// next_ = s + f from the combination of the last rounds that leaves the least f.  Points that wedge each
/// other let s go to and fro, or shrink by a hundredth only: then by half of f, and with a new memory now and
/// then.
void ContactNewton::extrapolate() {
  const bool slow = rounds_ > kSlow;
  const double mixing = slow ? kMixing : 1;
  if (slow && rounds_ % kPeriod == 0) remembered_ = 0;
  next_ = s_ + mixing * f_;
  if (remembered_ > 0) {
    const int column = (remembered_ - 1) % kMemory;
    steps_.col(column) = s_ - last_s_;
    changes_.col(column) = f_ - last_f_;
    const int m = std::min(remembered_, kMemory);
    Small normal = Small::Zero(m, m);
    SmallVector gamma = SmallVector::Zero(m);
    for (int i = 0; i < m; ++i) {
      gamma[i] = changes_.col(i).dot(f_);
      for (int j = 0; j <= i; ++j) normal(i, j) = normal(j, i) = changes_.col(i).dot(changes_.col(j));
    }
    normal.diagonal().array() += kRegularization * normal.trace();
    gamma = normal.ldlt().solve(gamma);
    if (!gamma.allFinite()) gamma.setZero();
    for (int i = 0; i < m; ++i) next_ -= gamma[i] * (steps_.col(i) + mixing * changes_.col(i));
  }
  last_s_ = s_;
  last_f_ = f_;
  ++remembered_;
}

/// v with v = Wᵀ P, to the tolerance [√J].  False if a value is not finite, or with nothing lagged if that is
/// not reached.
bool ContactNewton::minimize(const Problem& problem, double tolerance, const NewtonLimits& limits,
                             StageTimes& times, NewtonOutcome& outcome) {
  project(problem);
  double least = std::numeric_limits<double>::infinity(), first = 0;
  int stuck = 0;  // steps since it fell, at round-off
  for (int step = 0;; ++step) {
    read_gradient();
    const double size = gradient_.lpNorm<Eigen::Infinity>();
    if (!std::isfinite(size)) return false;
    stuck = size > 0.5 * least && least <= kDescentRoundOff * scale_ ? stuck + 1 : 0;
    least = std::min(least, size);
    if (step == 0) first = size;
    if (size <= tolerance || stuck == kStuck) return true;
    const bool coupled = mode_ == Mode::kCoupled;
    if (coupled && (step == kCoupledSteps || size > kBlowUp * first)) return false;
    if (step == kStepsPerRound || outcome.iterations >= limits.iterations) return !coupled;
    ++outcome.iterations;
    for (std::size_t r = 0; r < slope_.size(); ++r) slope_[r] /= sigma_[r];
    if (!system_.factorize_bodies(turned_, slope_, times)) return false;
    if (mode_ == Mode::kCoupled) {
      coupled_step();
    } else {
      step_ = -gradient_;
      system_.solve_bodies(span_of(step_));
    }
    system_.to_rows(span_of(step_), rates_of_step_);
    search(problem);
  }
}

/// How far along the step: where the slope of the convex function is about 0.  Leaves P and its slopes of
/// there.
void ContactNewton::search(const Problem& problem) {
  const double along = step_.dot(v_), square = step_.squaredNorm();
  const auto slope_at = [&](double length) {
    double slope = along + length * square;
    project(problem, length);
    for (std::size_t r = 0; r < y_.size(); ++r) slope -= rates_of_step_[r] * (y_[r] - last_[r]);
    return slope;
  };
  const double start = step_.dot(gradient_);
  double low = 0, slope_low = start, high = 1, slope_high = slope_at(1), length = 1;
  bool last_was_high = true;
  for (int k = 0; k < kSearches && slope_high > -kSlope * start; ++k) {
    length = low + (high - low) * slope_low / (slope_low - slope_high);
    const double slope = slope_at(length);
    if (std::abs(slope) <= -kSlope * start) break;
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

bool ContactNewton::holds_joints(std::span<const RowLaw> laws, std::span<const double> w,
                                 double rate_tolerance) const {
  double open = 0;
  for (int r = 0; r < system_.rows().first_contact_row(); ++r)
    if (!laws[r].bounded()) open = std::max(open, std::abs(w[r] - laws[r].rate(1)));
  return open <= kClosed * rate_tolerance;
}

/// The natural map at λ, with its w, over the size of impulses; infinite if λ is.  What is left of equalities
/// after some rounds is what dependent ones contradict each other by.
double ContactNewton::law_error(const Problem& problem, double rate_tolerance, int rounds) const {
  if (!std::isfinite(max_abs(problem.lambda))) return std::numeric_limits<double>::infinity();
  if (scale_ == 0) return 0;
  double error = contact_residual(problem.contacts, problem.lambda, problem.w, rate_tolerance);
  for (int r = 0; r < system_.rows().first_contact_row(); ++r) {
    if (rounds > kEqualityRounds && !problem.laws[r].bounded()) continue;
    error = std::max(
        error, problem.laws[r].natural_residual(own_[r], problem.lambda[r], problem.w[r], rate_tolerance));
  }
  return error / scale_;
}

}  // namespace taut
