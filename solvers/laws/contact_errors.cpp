#include <algorithm>
#include <cmath>
#include <numbers>

#include "solvers/laws/contact_laws.h"

// How far a solution is from what contacts ask of it, and what they take over from it.
namespace taut {
namespace {

/// Distance from Coulomb's law that is accepted, relative to the largest impulse.
constexpr double kTolerance = 1e-9;
/// A contact that sticks has not slipped by less than this, relative to all impulses: what may be left of the
/// laws where they are met.
constexpr double kStill = 1e-6;
/// Slip that turned by more than this (sine) gets its own tangents.
constexpr double kArmTurn = 0.05;
/// Smallest component of a direction that counts as half way between the tangents.
constexpr double kHalfWay = 0.6;

}  // namespace

/// Distance of a disc's impulse from Coulomb's answer to it and the slip, P(τ − u/S) [√J].
double ContactLaws::disc_error(int k, const Disc& disc, int row, double bound, std::span<const double> lambda,
                               std::span<const double> w) const {
  const Vec2 tau = disc.given + Vec2(lambda[row], lambda[row + 1]);
  const SlipLaw law = slip_law(k, disc);
  const Vec2 slip = Vec2(w[row], w[row + 1]) + law.softness * Vec2(lambda[row], lambda[row + 1]) - law.target;
  const double root = std::max(root_[row], root_[row + 1]);
  const Vec2 slipped = tau - slip / (root * root + law.softness);
  return root * (tau - into_disc(slipped, bound)).norm();
}

double ContactLaws::spin_error(int k, double bound, std::span<const double> lambda,
                               std::span<const double> w) const {
  const int row = first_row_[k] + 3;
  const double spin = contact(k).spin_given + lambda[row];
  return root_[row] * std::abs(spin - std::clamp(spin - w[row] / (root_[row] * root_[row]), -bound, bound));
}

/// The same for the normal impulse.
double ContactLaws::normal_error(int k, std::span<const double> lambda, std::span<const double> w) const {
  const int row = first_row_[k];
  const NormalLaw law = normal_law(k);
  const double normal = contact(k).back + lambda[row];
  const double off = w[row] + law.softness * lambda[row] - law.target;
  const double own = root_[row] * root_[row] + law.softness;
  return root_[row] * std::abs(normal - std::clamp(normal - off / own, 0.0, law.most));
}

double ContactLaws::sliding_error(int k, const Disc& disc, std::span<const double> lambda,
                                  std::span<const double> w) const {
  return disc_error(k, disc, first_row_[k] + 1, friction_bound(k, pressure(k, lambda)), lambda, w);
}

double ContactLaws::spinning_error(int k, std::span<const double> lambda, std::span<const double> w) const {
  return spin_error(k, place_of(k).material.spinning_friction * pressure(k, lambda), lambda, w);
}

double ContactLaws::rolling_error(int k, std::span<const double> lambda, std::span<const double> w) const {
  const double bound = place_of(k).material.rolling_friction * pressure(k, lambda);
  return disc_error(k, contact(k).rolling, first_row_[k] + 4, bound, lambda, w);
}

double ContactLaws::pressure(int k, std::span<const double> lambda) const {
  return std::max(0.0, contact(k).back + lambda[first_row_[k]]);
}

double ContactLaws::friction_bound(int k, double normal) const {
  const Material& material = place_of(k).material;
  return (contact(k).stuck && !contact(k).broken ? material.static_friction : material.dynamic_friction) *
         std::max(0.0, normal);
}

double ContactLaws::error(std::span<const double> lambda, std::span<const double> w,
                          double rate_tolerance) const {
  double largest = 0;
  for (int k = 0; k < count(); ++k) {
    const int row = first_row_[k];
    if (!works(k)) continue;
    const auto add = [&](double error, int r, double softness = 0) {
      if (!((root_[r] + softness / root_[r]) * error <= rate_tolerance)) largest = std::max(largest, error);
    };
    if (sharing_ && sticks(k)) {
      largest = std::max(largest, cone_error(k, lambda, w));
    } else {
      add(normal_error(k, lambda, w), row, softness(k));
      add(sliding_error(k, contact(k).sliding, lambda, w), row + 1, slip_softness(k));
    }
    if (!has_twist(k)) continue;
    add(spinning_error(k, lambda, w), row + 3);
    add(rolling_error(k, lambda, w), row + 4);
  }
  return largest;
}

double ContactLaws::natural_error(std::span<const double> lambda, std::span<const double> w, double scale,
                                  const RateSize& least) const {
  double largest = 0;
  for (int k = 0; k < count(); ++k) largest = std::max(largest, natural_error(k, lambda, w, scale, least));
  return largest;
}

/// A contact that begins or ceases to slip in this stage was asked to return by what it had slipped, or not
/// to slip: it is by the smaller of both that its law is met.
double ContactLaws::natural_error(int k, std::span<const double> lambda, std::span<const double> w,
                                  double scale, const RateSize& least) const {
  if (!works(k)) return 0;
  const int row = first_row_[k];
  double largest = 0;
  const auto add = [&](double error, int r, double rate) {
    if (error > 0) largest = std::max(largest, error / std::max(scale, rate / root_[r]));
  };
  double sliding = sliding_error(k, contact(k).sliding, lambda, w);
  if (compliance(k) == 0) {
    Disc other = contact(k).sliding;
    other.slips = !other.slips;
    sliding = std::min(sliding, sliding_error(k, other, lambda, w));
  }
  add(normal_error(k, lambda, w), row, least.linear);
  add(sliding, row + 1, least.linear);
  if (!has_twist(k)) return largest;
  add(spinning_error(k, lambda, w), row + 3, least.angular);
  add(rolling_error(k, lambda, w), row + 4, least.angular);
  return largest;
}

bool ContactLaws::adapt(std::span<const double> lambda, std::span<const double> w, double rate_tolerance) {
  turns_.clear();
  scale_ = 0;
  residual_ = 0;
  for (int k = 0; k < count(); ++k)
    for (int i = 0; i < 3 && contact(k).active; ++i)
      scale_ = std::max(scale_, root_[first_row_[k] + i] * std::abs(lambda[first_row_[k] + i]));
  for (int k = 0; k < count(); ++k) {
    Point& point = contact(k);
    const int row = first_row_[k];
    if (!works(k) || scale_ == 0) continue;
    const Material& material = place_of(k).material;
    const double normal = std::max(0.0, point.back + lambda[row]);
    const double bound = friction_bound(k, normal);
    double error = adapt_disc(k, point.sliding, row + 1, bound, lambda, w, rate_tolerance);
    if (has_twist(k)) {
      const double arm = material.spinning_friction * normal;
      error = std::max(error, spin_error(k, arm, lambda, w));
      point.spin_bound = arm;
      error = std::max(error, adapt_disc(k, point.rolling, row + 4, material.rolling_friction * normal,
                                         lambda, w, rate_tolerance));
    }
    residual_ = std::max(residual_, error / scale_);
  }
  if (residual_ > kTolerance) return true;
  for (int k = 0; k < count(); ++k)
    if (compliance(k) > 0 && works(k) && contact(k).sliding.slips && contact(k).sliding.weight > 0)
      contact(k).broken = true;
  return false;
}

/// The disc by the impulse τ and the slip u of a solution.  Returns disc_error() of the disc as it was.
double ContactLaws::adapt_disc(int k, Disc& disc, int row, double bound, std::span<const double> lambda,
                               std::span<const double> w, double rate_tolerance) {
  const Vec2 tau = disc.given + Vec2(lambda[row], lambda[row + 1]);
  const SlipLaw law = slip_law(k, disc);
  const Vec2 slip = Vec2(w[row], w[row + 1]) + law.softness * Vec2(lambda[row], lambda[row + 1]) - law.target;
  const double root = std::max(root_[row], root_[row + 1]);
  double error = disc_error(k, disc, row, bound, lambda, w);
  if ((root + law.softness / root) * error <= rate_tolerance) error = 0;
  disc.bound = bound;
  const double speed = slip.norm();
  const bool stuck = &disc == &contact(k).sliding && sticks(k);
  if (speed <= std::max(rate_tolerance, (stuck ? kStill : kTolerance) * scale_ * root)) {  // it rests
    if (tau.norm() <= bound * (1 + kTolerance) + (stuck ? kStill * scale_ / root : 0)) {
      disc.slips = false;
      return error;
    }
    disc.slips = true;
    disc.direction = -tau.normalized();
    disc.weight = 0;
  } else {
    disc.slips = true;
    disc.direction = slip / speed;
    disc.weight = bound / speed;
  }
  if (error > kTolerance * scale_) ask_for_turn(k, disc);
  return error;
}

/// The slip along t₁; the impulse of a disc that holds half way between t₁ and t₂.
void ContactLaws::ask_for_turn(int place, const Disc& disc) {
  const Vec2& d = disc.direction;
  if (disc.weight > 0 && std::abs(d[1]) > kArmTurn)
    turns_.push_back({place, d[0], d[1]});
  else if (disc.weight == 0 && std::min(std::abs(d[0]), std::abs(d[1])) < kHalfWay)
    turns_.push_back(
        {place, std::numbers::sqrt2 / 2 * (d[0] + d[1]), std::numbers::sqrt2 / 2 * (d[1] - d[0])});
}

}  // namespace taut
