#include "solvers/laws/friction_linearization.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace taut {
namespace {

/// A contact that sticks has not slipped by less than this, relative to all impulses: what may be left of the
/// laws where they are met.
constexpr double kStill = 1e-6;
/// Slip that turned by more than this (sine) gets its own tangents.
constexpr double kArmTurn = 0.05;
/// Smallest component of a direction that counts as half way between the tangents.
constexpr double kHalfWay = 0.6;

}  // namespace

bool FrictionLinearization::adapt(std::span<const double> lambda, std::span<const double> w,
                                  double rate_tolerance) {
  turns_.clear();
  scale_ = size_of(lambda);
  residual_ = 0;
  for (int k = 0; k < contacts_.count(); ++k)
    if (contacts_.works(k) && scale_ != 0)
      residual_ = std::max(residual_, renew(k, lambda, w, rate_tolerance) / scale_);
  if (residual_ > kMetResidual) return true;
  mark_stretched();
  return false;
}

/// The largest impulse in a normal or tangent [√J].
double FrictionLinearization::size_of(std::span<const double> lambda) const {
  double size = 0;
  for (int k = 0; k < contacts_.count(); ++k)
    for (int i = 0; i < 3 && contacts_.point(k).active; ++i) {
      const int row = contacts_.first_row(k) + i;
      size = std::max(size, contacts_.root(row) * std::abs(lambda[row]));
    }
  return size;
}

/// The discs and the spin of a contact by a solution.  Returns its residual with them as they were.
double FrictionLinearization::renew(int k, std::span<const double> lambda, std::span<const double> w,
                                    double rate_tolerance) {
  ContactTable::Point& point = contacts_.point(k);
  const Material& material = contacts_.place(k).material;
  const double normal = contacts_.pressure(k, lambda);
  const double sliding = renew_disc(k, point.sliding, sliding_state(contacts_, k, lambda, w),
                                    contacts_.friction_bound(k, normal), contacts_.sticks(k), rate_tolerance);
  if (!contacts_.has_twist(k)) return sliding;
  const double spinning = spinning_residual(contacts_, k, lambda, w).size;
  point.spin_bound = material.spinning_friction * normal;
  const double rolling = renew_disc(k, point.rolling, rolling_state(contacts_, k, lambda, w),
                                    material.rolling_friction * normal, false, rate_tolerance);
  return std::max({sliding, spinning, rolling});
}

/// `stuck`: it is that of a contact that sticks.
double FrictionLinearization::renew_disc(int k, ContactTable::Disc& disc, const DiscState& state,
                                         double bound, bool stuck, double rate_tolerance) {
  const double root = state.root, residual = state.residual(bound).beyond(rate_tolerance);
  disc.bound = bound;
  const double speed = state.slip.norm();
  const bool rests = speed <= std::max(rate_tolerance, (stuck ? kStill : kMetResidual) * scale_ * root);
  if (rests && state.tau.norm() <= bound * (1 + kMetResidual) + (stuck ? kStill * scale_ / root : 0)) {
    disc.slips = false;
    return residual;
  }
  disc.slips = true;
  disc.direction = rests ? Vec2(-state.tau.normalized()) : Vec2(state.slip / speed);
  disc.weight = rests ? 0 : bound / speed;
  if (residual > kMetResidual * scale_) ask_for_turn(k, disc);
  return residual;
}

/// The slip along t₁; the impulse of a disc that holds half way between t₁ and t₂.
void FrictionLinearization::ask_for_turn(int k, const ContactTable::Disc& disc) {
  const Vec2& d = disc.direction;
  if (disc.weight > 0 && std::abs(d[1]) > kArmTurn)
    turns_.push_back({k, d[0], d[1]});
  else if (disc.weight == 0 && std::min(std::abs(d[0]), std::abs(d[1])) < kHalfWay)
    turns_.push_back({k, std::numbers::sqrt2 / 2 * (d[0] + d[1]), std::numbers::sqrt2 / 2 * (d[1] - d[0])});
}

void FrictionLinearization::turned(ConstraintSystem& system) {
  for (const Turn& turn : turns_) {
    system.turn_tangents(turn.place, contacts_.contact_point(turn.place), turn.cos, turn.sin);
    for (ContactTable::Disc* disc :
         {&contacts_.point(turn.place).sliding, &contacts_.point(turn.place).rolling})
      for (Vec2* v : {&disc->direction, &disc->given, &disc->target})
        *v = Vec2(turn.cos * v->x() + turn.sin * v->y(), turn.cos * v->y() - turn.sin * v->x());
  }
  turns_.clear();
}

/// Compliant contacts that slip where the laws are met have let go.
void FrictionLinearization::mark_stretched() {
  for (int k = 0; k < contacts_.count(); ++k) {
    const ContactTable::Disc& sliding = contacts_.point(k).sliding;
    if (contacts_.compliance(k) > 0 && contacts_.works(k) && sliding.slips && sliding.weight > 0)
      contacts_.point(k).broken = true;
  }
}

}  // namespace taut
