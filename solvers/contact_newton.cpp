#include "solvers/contact_newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {
namespace {

using Vec2 = Eigen::Vector2d;

/// Σ over S_rr: in the first round, how it falls from round to round, the least, and that of equalities.
constexpr double kFirstRho = 1e-2, kRhoFactor = 0.1, kLeastRho = 1e-6, kEqualityRho = 1e-7;
/// Newton's equation is met to this part of the residual of the round before, and never better than this.
constexpr double kForcing = 0.01, kLeastGradient = 1e-13;
constexpr int kStepsPerRound = 40, kSearches = 12;
/// A step is taken whole if the slope at its end is at most this part of that at its start.
constexpr double kSlope = 0.5;
/// Rounds after which `most` is enough, and that the extrapolation uses.
constexpr int kPatience = 12, kMemory = 6;

std::span<double> span_of(Eigen::VectorXd& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

}  // namespace

NewtonOutcome ContactNewton::solve(const ContactForces& contacts, std::span<const RowLaw> laws,
                                   std::span<const double> b, std::span<double> lambda, std::span<double> w,
                                   const NewtonLimits& limits, StageTimes& times) {
  const Problem problem{contacts, laws, b, lambda, w};
  NewtonOutcome outcome;
  begin(problem);
  double forcing = kForcing, last = 1;
  for (double rho = kFirstRho;;) {
    ++outcome.rounds;
    set_sigma(problem, rho);
    const bool finite =
        minimize(problem, std::max(kForcing * forcing, kLeastGradient) * scale_, limits, times, outcome);
    std::copy(y_.begin(), y_.end(), lambda.begin());
    system_.multiply(lambda, w);
    for (std::size_t r = 0; r < w.size(); ++r) w[r] += b[r];
    outcome.residual = scale_ > 0 ? law_error(problem, limits.rate_tolerance) / scale_ : 0;
    if (outcome.residual > 5 * last) rounds_ = 0;
    last = outcome.residual;
    forcing = std::min(outcome.residual, kForcing);
    const double enough = outcome.rounds > kPatience ? limits.most : limits.tolerance;
    outcome.converged = finite && outcome.residual <= enough;
    if (outcome.converged || !finite || outcome.iterations >= limits.iterations) return outcome;
    if (next_round(problem)) rho = std::max(kRhoFactor * rho, kLeastRho);
  }
}

/// S_rr, the rates asked for, the size of impulses [√J] (also of those that vanish in the end), and the
/// guess.
void ContactNewton::begin(const Problem& problem) {
  const int n = system_.row_count();
  for (auto* values :
       {&own_, &sigma_, &target_, &shift_, &last_, &x_, &y_, &rates_, &rates_of_step_, &bound_, &slope_})
    values->assign(n, 0.0);
  for (auto* values : {&v_, &gradient_, &step_}) values->setZero(6 * system_.rows().body_count());
  const int contacts = system_.rows().contact_count();
  for (auto* values : {&s_, &f_, &last_s_, &last_f_, &next_}) values->setZero(contacts);
  for (auto* values : {&steps_, &changes_}) values->setZero(contacts, kMemory);
  rounds_ = 0;
  system_.row_inertias(own_);
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
  system_.to_bodies(last_, span_of(v_));
  system_.to_rows(span_of(v_), rates_);
  for (int r = 0; r < n; ++r) problem.w[r] = problem.b[r] + rates_[r];
  (void)next_round(problem);  // s
  rounds_ = 0;
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
    const ContactForces::Cone cone = problem.contacts.cone(k);
    alike(row, 3);
    if (!cone.twist) continue;
    alike(row + 3, 1);
    alike(row + 4, 2);
    const double normal = std::max(0.0, cone.normal_given + last_[row]);
    bound_[row + 3] = cone.spinning * normal;
    bound_[row + 4] = cone.rolling * normal;
  }
}

/// λ̄ = P and s = μ |u_t| of the round that has ended, s extrapolated from the last rounds [Walker2011]:
/// without that each round leaves some part of its error, a third or two.  True if λ̄ is further off than s.
bool ContactNewton::next_round(const Problem& problem) {
  double off_last = 0;
  for (std::size_t r = 0; r < y_.size(); ++r)
    off_last = std::max(off_last, sigma_[r] * std::abs(y_[r] - last_[r]) / std::sqrt(own_[r]));
  last_ = y_;
  const int contacts = system_.rows().contact_count();
  if (contacts == 0) return true;
  for (int k = 0; k < contacts; ++k) {
    const ContactForces::Cone cone = problem.contacts.cone(k);
    const int row = problem.contacts.first_row(k);
    const double root = std::sqrt(own_[row]);
    const auto off = [&](int r) { return problem.w[r] - target_[r]; };
    const double answer = cone.works ? cone.sliding * std::hypot(off(row + 1), off(row + 2)) : 0;
    s_[k] = shift_[row] / root;
    f_[k] = answer / root - s_[k];
  }
  extrapolate();
  for (int k = 0; k < contacts; ++k) {
    const int row = problem.contacts.first_row(k);
    shift_[row] = std::max(0.0, next_[k] * std::sqrt(own_[row]));
  }
  return off_last > f_.lpNorm<Eigen::Infinity>();
}

/// next_ = s + f from the combination of the last rounds that leaves the least f.
void ContactNewton::extrapolate() {
  next_ = s_ + f_;
  if (rounds_ > 1) {
    const int column = (rounds_ - 2) % kMemory;
    steps_.col(column) = s_ - last_s_;
    changes_.col(column) = f_ - last_f_;
    const int m = std::min(rounds_ - 1, kMemory);
    const Eigen::VectorXd gamma = changes_.leftCols(m).colPivHouseholderQr().solve(f_);
    if (gamma.allFinite()) next_ -= (steps_.leftCols(m) + changes_.leftCols(m)) * gamma;
  }
  last_s_ = s_;
  last_f_ = f_;
  ++rounds_;
}

/// v with v = Wᵀ P, to the tolerance [√J].  False if a value is not finite.
bool ContactNewton::minimize(const Problem& problem, double tolerance, const NewtonLimits& limits,
                             StageTimes& times, NewtonOutcome& outcome) {
  for (int step = 0;; ++step) {
    project(problem);
    system_.to_bodies(y_, span_of(gradient_));
    gradient_ = v_ - gradient_;
    const double size = gradient_.lpNorm<Eigen::Infinity>();
    if (!std::isfinite(size)) return false;
    if (size <= tolerance || step == kStepsPerRound || outcome.iterations >= limits.iterations) return true;
    ++outcome.iterations;
    for (std::size_t r = 0; r < slope_.size(); ++r) slope_[r] /= sigma_[r];
    if (!system_.factorize_bodies(turned_, slope_, times)) return false;
    step_ = -gradient_;
    system_.solve_bodies(span_of(step_));
    system_.to_rows(span_of(step_), rates_of_step_);
    search(problem);
  }
}

/// How far along the step: where the slope of the convex function is about 0.
void ContactNewton::search(const Problem& problem) {
  const double along = step_.dot(v_), square = step_.squaredNorm();
  const auto slope_at = [&](double length) {
    double slope = along + length * square;
    project(problem, length);
    for (std::size_t r = 0; r < y_.size(); ++r) slope -= rates_of_step_[r] * y_[r];
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

/// x and y = P(x) at the present velocities and `length` of the step, with the slopes of P.
void ContactNewton::project(const Problem& problem, double length) {
  const Rows& rows = system_.rows();
  for (std::size_t r = 0; r < x_.size(); ++r)
    x_[r] = last_[r] -
            (problem.b[r] + rates_[r] + length * rates_of_step_[r] - target_[r] + shift_[r]) / sigma_[r];
  for (int r = 0; r < rows.first_contact_row(); ++r) project_row(problem.laws[r], r);
  for (int k = 0; k < rows.contact_count(); ++k) project_contact(problem, k);
}

void ContactNewton::project_row(const RowLaw& law, int r) {
  if (!law.bounded()) {
    y_[r] = x_[r];
    slope_[r] = 1;
    return;
  }
  const RowLaw::Point point = law.resolve(sigma_[r], -sigma_[r] * x_[r]);
  y_[r] = point.lambda;
  slope_[r] = RowLaw::is_vertical(point.piece) ? 1 : law.slope * sigma_[r] / (1 + law.slope * sigma_[r]);
}

/// The nearest point of Coulomb's cone |Λ_t| ≤ μ Λ_n, of the spin's interval and of the rolling disc.
void ContactNewton::project_contact(const Problem& problem, int k) {
  const ContactForces::Cone cone = problem.contacts.cone(k);
  const int row = problem.contacts.first_row(k), count = cone.twist ? 6 : 3;
  if (!cone.works) {
    std::fill_n(y_.begin() + row, count, 0.0);
    std::fill_n(slope_.begin() + row, count, 0.0);
    return;
  }
  const double mu = cone.sliding, normal = cone.normal_given + x_[row];
  const Vec2 tangent = cone.sliding_given + Vec2(x_[row + 1], x_[row + 2]);
  const double size = tangent.norm();
  if (size <= mu * normal || mu * size <= -normal) {
    const bool within = size <= mu * normal;
    for (int i = 0; i < 3; ++i) slope_[row + i] = within ? 1 : 0;
    if (within) {
      std::copy_n(x_.begin() + row, 3, y_.begin() + row);
    } else {
      y_[row] = -cone.normal_given;
      y_[row + 1] = -cone.sliding_given[0];
      y_[row + 2] = -cone.sliding_given[1];
    }
    turn_rows(k, 0, 1, Vec2::UnitX());
  } else {
    const Vec2 direction = size > 0 ? Vec2(tangent / size) : Vec2(Vec2::UnitX());
    const double on = (normal + mu * size) / (1 + mu * mu);
    y_[row] = on - cone.normal_given;
    y_[row + 1] = mu * on * direction[0] - cone.sliding_given[0];
    y_[row + 2] = mu * on * direction[1] - cone.sliding_given[1];
    slope_[row] = 1;  // along the generator
    slope_[row + 1] = 0;
    slope_[row + 2] = size > 0 ? mu * on / size : 0;  // across it
    turn_rows(k, mu, 1, direction);
  }
  if (!cone.twist) return;
  const double spin = cone.spin_given + x_[row + 3];
  y_[row + 3] = std::clamp(spin, -bound_[row + 3], bound_[row + 3]) - cone.spin_given;
  slope_[row + 3] = std::abs(spin) < bound_[row + 3] ? 1 : 0;
  const Vec2 roll = cone.rolling_given + Vec2(x_[row + 4], x_[row + 5]);
  const double turn = roll.norm(), most = bound_[row + 4];
  const Vec2 answer = (turn > most ? Vec2(most / turn * roll) : roll) - cone.rolling_given;
  y_[row + 4] = answer[0];
  y_[row + 5] = answer[1];
  slope_[row + 4] = turn > most ? 0 : 1;
  slope_[row + 5] = turn > most ? most / turn : 1;
  turn_rows(k, 0, 4, turn > most ? Vec2(roll / turn) : Vec2(Vec2::UnitX()));
}

/// Rows of W in which P' is diagonal: tangents along `direction` and across it, the first one with the normal
/// along the generator (1, μ) of the cone.
void ContactNewton::turn_rows(int place, double mu, int first, const Vec2& direction) {
  const Rows& rows = system_.rows();
  const Rows::JointRows& contact = rows.joints()[rows.contact_joint(place)];
  const double length = 1 / std::sqrt(1 + mu * mu);
  for (int s = contact.first_side; s < contact.first_side + contact.side_count; ++s) {
    const double* W = system_.weighted().data() + rows.sides()[s].offset;
    double* turned = turned_.data() + rows.sides()[s].offset;
    for (int k = 0; k < 6; ++k) {
      const double a = W[6 * first + k], b = W[6 * first + 6 + k];
      const double along = direction[0] * a + direction[1] * b;
      turned[6 * first + k] = along;
      turned[6 * first + 6 + k] = direction[0] * b - direction[1] * a;
      if (first == 1) turned[k] = length * (W[k] + mu * along);
    }
  }
}

/// The natural map at λ, with its w.
double ContactNewton::law_error(const Problem& problem, double rate_tolerance) const {
  double error = problem.contacts.error(problem.lambda, problem.w, rate_tolerance);
  for (int r = 0; r < system_.rows().first_contact_row(); ++r) {
    const double s = own_[r], lambda = problem.lambda[r];
    const double off = std::abs(lambda - problem.laws[r].resolve(s, problem.w[r] - s * lambda).lambda);
    if (!(s * off <= rate_tolerance)) error = std::max(error, std::sqrt(s) * off);
  }
  return error;
}

}  // namespace taut
