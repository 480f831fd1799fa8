#include "solvers/laws/contact_laws.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

struct ContactLawsTuning {
  /// Compliance of contacts that yield, over S_rr, and how far they may in a step [m]: more contradicts.
  /// Chosen.
  static constexpr double kYield = 1e-6, kYieldWay = 1e-5;
};

/// A box around `centre`, or just that if it has no width.
RowLaw box_around(double centre, double half, double w) {
  if (!(centre - half < centre + half)) return RowLaw::constant(centre);
  return RowLaw::box(centre - half, centre + half, w);
}

/// A disc that holds is a square around it, or, if a corner of that was used, one inside it that has its own
/// corner there.  A disc that slips along t₁ has the level −bound there, and across it the friction that
/// turns with the slip: the derivative of −bound w/|w|.  `given` is counted from the middle of the disc.
void disc_laws(const ContactConstraints::Disc& disc, const Vec2& given, int row, std::span<RowLaw> laws) {
  const bool holds = !disc.slips || disc.cross_slope == 0 || !(disc.bound > 0);
  for (int i : {0, 1}) {
    const double half = disc.slips ? disc.bound * std::abs(disc.direction[i]) : disc.bound;
    laws[row + i] = box_around(-given[i], half, disc.slips ? 0 : disc.target[i]);
  }
  if (holds) return;
  laws[row + 1] = RowLaw::viscous(disc.cross_slope);
  laws[row + 1].level[0] = -given[1];
}

}  // namespace

void ContactLaws::set_position_springs() {
  for (int k = 0; k < count(); ++k) {
    Point& at = point(k);
    if (!at.active || compliance(k) == 0) continue;
    at.soft = spring(k).position_law(at.gap, slot(k).material.restitution);
    at.soft_slip = spring(k, kSlidingRow).position_slip_law(at.sliding.target);
  }
}

void ContactLaws::set_velocity_springs() {
  for (int k = 0; k < count(); ++k) {
    Point& at = point(k);
    if (!at.active || compliance(k) == 0) continue;
    at.soft = spring(k).velocity_law(at.gap, at.approach, at.back, slot(k).material.restitution);
    set_velocity_slip(k);
  }
}

void ContactLaws::set_velocity_slip(int k) {
  point(k).soft_slip = spring(k, kSlidingRow).velocity_slip_law(point(k).sliding.given);
}

void ContactLaws::set_laws(std::span<RowLaw> laws) const {
  for (int k = 0; k < count(); ++k) {
    const int row = first_row(k);
    const double back = point(k).back;
    std::fill_n(laws.begin() + row, row_count(k), RowLaw::none());
    if (!point(k).live) continue;
    const NormalLaw normal = normal_law(*this, k);
    laws[row] = RowLaw::lower_limit(normal.target);
    laws[row].level[1] -= back;  // both kicks together are the impulse that must not pull
    laws[row].level[0] = normal.most - back;
    friction_laws(k, laws);
  }
}

void ContactLaws::friction_laws(int k, std::span<RowLaw> laws) const {
  const Point& contact = point(k);
  const int row = first_row(k);
  disc_laws(contact.sliding, contact.sliding.given, row + kSlidingRow, laws);
  if (!has_twist(k)) return;
  const double normal = contact.borne;
  const LinearFriction linear = linear_friction(*this, k);
  laws[row + kSpinRow] = box_around(-contact.spin_given - linear.spin_lag * normal, contact.spin_bound, 0);
  disc_laws(contact.rolling, contact.rolling.given + linear.rolling_lag * normal, row + kRollingRow, laws);
  laws[row + kSpinRow].slope += linear.spinning * normal;
  for (int i : {0, 1}) laws[row + kRollingRow + i].slope += linear.rolling * normal;
}

void ContactLaws::held_laws(std::span<const double> lambda, std::span<RowLaw> laws) const {
  for (int k = 0; k < count(); ++k) {
    const int row = first_row(k);
    if (!works(k)) continue;
    const Disc& sliding = point(k).sliding;
    const bool bears = presses(k, lambda), holds = bears && friction_bound(k, 1) > 0;
    laws[row] = bears ? RowLaw::equality(normal_law(*this, k).target) : RowLaw::constant(-point(k).back);
    for (int i : {0, 1})
      laws[row + kSlidingRow + i] =
          holds ? RowLaw::equality(sliding.target[i]) : RowLaw::constant(-sliding.given[i]);
  }
}

bool ContactLaws::let_yield(std::span<const double> lambda, std::span<const double> w, double least,
                            double most) {
  bool any = false;
  for (int k = 0; k < count(); ++k) {
    if (!works(k) || compliance(k) > 0 || point(k).yield > 0) continue;
    const int row = first_row(k);
    const double way = (normal_law(*this, k).target - w[row]) * table().h;
    if (!(way > 0 && way <= ContactLawsTuning::kYieldWay)) continue;
    if (!(root_diagonal(row) * lambda[row] > most &&
          natural_residual(*this, k, lambda, w).normal.size > least))
      continue;
    point(k).yield = ContactLawsTuning::kYield * root_diagonal(row) * root_diagonal(row);
    any = true;
  }
  return any;
}

void ContactLaws::targets(std::span<double> target) const {
  for (int k = 0; k < count(); ++k) {
    const int row = first_row(k);
    target[row] = normal_law(*this, k).target;
    const SlipLaw sliding = sliding_law(*this, k);
    for (int i : {0, 1}) target[row + kSlidingRow + i] = sliding.target[i];
  }
}

}  // namespace taut
