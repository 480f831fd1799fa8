#include "solvers/laws/friction_linearization.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct FrictionLinearizationTuning {
  /// A contact that sticks has not slipped by less than this, relative to all impulses: what may be left of
  /// the laws where they are met.
  static constexpr double kStill = 1e-6;
};

}  // namespace

void FrictionLinearization::take_over(std::span<const double> lambda, std::span<const double> w,
                                      double rate_tolerance) {
  scale_ = size_of(lambda);
  residual_ = 0;
  for (int k = 0; k < contacts_.count(); ++k)
    if (contacts_.works(k) && scale_ != 0)
      residual_ = std::max(residual_, renew(k, lambda, w, rate_tolerance) / scale_);
  if (residual_ <= ResidualTuning::kMet) mark_stretched();
}

/// The largest impulse in a normal or tangent [√J].
double FrictionLinearization::size_of(std::span<const double> lambda) const {
  double size = 0;
  for (int k = 0; k < contacts_.count(); ++k)
    for (int i = 0; i < 3 && contacts_.point(k).active; ++i) {
      const int row = contacts_.first_row(k) + i;
      size = std::max(size, contacts_.root_diagonal(row) * std::abs(lambda[row]));
    }
  return size;
}

/// The discs and the spin of a contact by a solution.  Returns its residual with them as they were.
double FrictionLinearization::renew(int k, std::span<const double> lambda, std::span<const double> w,
                                    double rate_tolerance) {
  ContactConstraints::Point& point = contacts_.point(k);
  const Material& material = contacts_.slot(k).material;
  const double normal = contacts_.pressure(k, lambda);
  const double sliding = renew_disc(point.sliding, sliding_state(contacts_, k, lambda, w),
                                    contacts_.friction_bound(k, normal), contacts_.sticks(k), rate_tolerance);
  if (!contacts_.has_twist(k)) return sliding;
  const double spinning = spinning_residual(contacts_, k, lambda, w).size;
  point.spin_bound = material.spinning_friction * normal;
  point.borne = normal;
  const double rolling = renew_disc(point.rolling, rolling_state(contacts_, k, lambda, w),
                                    material.rolling_friction * normal, false, rate_tolerance);
  return std::max({sliding, spinning, rolling});
}

/// `stuck`: it is that of a contact that sticks.
double FrictionLinearization::renew_disc(ContactConstraints::Disc& disc, const DiscState& state, double bound,
                                         bool stuck, double rate_tolerance) {
  const double root = state.root, residual = state.residual(bound).beyond(rate_tolerance);
  disc.bound = bound;
  const double speed = state.slip.norm();
  const double still =
      std::max(FrictionLinearizationTuning::kStill * scale_ * root, contacts_.table().still_rate);
  const bool rests = speed <= std::max(rate_tolerance, stuck ? still : ResidualTuning::kMet * scale_ * root);
  if (rests &&
      state.within().norm() <= bound * (1 + ResidualTuning::kMet) + (stuck ? still / (root * root) : 0)) {
    disc.slips = false;
    return residual;
  }
  disc.slips = true;
  disc.direction = rests ? Vec2(-state.tau.normalized()) : Vec2(state.slip / speed);
  disc.cross_slope = rests ? 0 : bound / speed;
  return residual;
}

/// Compliant contacts that slip where the laws are met have let go.
void FrictionLinearization::mark_stretched() {
  for (int k = 0; k < contacts_.count(); ++k) {
    const ContactConstraints::Disc& sliding = contacts_.point(k).sliding;
    if (contacts_.compliance(k) > 0 && contacts_.works(k) && sliding.slips && sliding.cross_slope > 0)
      contacts_.point(k).slipping = true;
  }
}

}  // namespace taut
