#include "solvers/laws/contact_residual.h"

#include <algorithm>
#include <cmath>

#include "solvers/laws/signorini_coulomb.h"

namespace taut {
namespace {

DiscState disc_state(const ContactRows& contacts, int row, const Vec2& given,
                     const ContactConstraints::SlipLaw& law, std::span<const double> lambda,
                     std::span<const double> w) {
  const Vec2 impulse(lambda[row], lambda[row + 1]);
  return {given + impulse, Vec2(w[row], w[row + 1]) + law.softness * impulse - law.target,
          std::max(contacts.root_diagonal(row), contacts.root_diagonal(row + 1)), law.softness};
}

NaturalResidual normal_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                                std::span<const double> w) {
  const int row = contacts.first_row(k);
  const double root = contacts.root_diagonal(row);
  const ContactConstraints::NormalLaw law = normal_law(contacts, k);
  const double normal = contacts.point(k).back + lambda[row];
  const double off = w[row] + law.softness * lambda[row] - law.target;
  const double diagonal = root * root + law.softness;
  return {root, diagonal, normal - std::clamp(normal - off / diagonal, 0.0, law.most)};
}

/// Of a disc, with the rate that its first row would take it for.
NaturalResidual disc_residual(const ContactRows& contacts, int row, const DiscState& disc, double bound) {
  NaturalResidual of = disc.residual(bound);
  const double root = contacts.root_diagonal(row);
  of.rate = (root + disc.softness / root) * of.size;
  return of;
}

NaturalResidual sliding_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                                 std::span<const double> w) {
  return disc_residual(contacts, contacts.first_row(k) + ContactRows::kSlidingRow,
                       sliding_state(contacts, k, lambda, w),
                       contacts.friction_bound(k, contacts.pressure(k, lambda)));
}

/// A contact that begins or ceases to slip in this stage was asked to return by what it had slipped, or not
/// to slip: what it was not asked.
NaturalResidual other_sliding_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                                       std::span<const double> w) {
  ContactConstraints::Disc other = contacts.point(k).sliding;
  other.slips = !other.slips;
  return disc_state(contacts, contacts.first_row(k) + ContactRows::kSlidingRow, other.given,
                    other.rigid_law(), lambda, w)
      .residual(contacts.friction_bound(k, contacts.pressure(k, lambda)));
}

NaturalResidual rolling_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                                 std::span<const double> w) {
  const double length = contacts.slot(k).material.rolling_friction;
  return disc_residual(contacts, contacts.first_row(k) + ContactRows::kRollingRow,
                       rolling_state(contacts, k, lambda, w), length * contacts.pressure(k, lambda));
}

/// Of the three impulses and the normality law of the cone of static friction.
NaturalResidual cone_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                              std::span<const double> w) {
  const ContactConstraints::Point& point = contacts.point(k);
  const int row = contacts.first_row(k);
  const Vec2& given = point.sliding.given;
  const Vec2& target = point.sliding.target;
  const double root = std::max(
      {contacts.root_diagonal(row), contacts.root_diagonal(row + 1), contacts.root_diagonal(row + 2)});
  const double diagonal = root * root;
  const Vec3 impulse(point.back + lambda[row], given[0] + lambda[row + 1], given[1] + lambda[row + 2]);
  const Vec3 off(w[row] - normal_law(contacts, k).target, w[row + 1] - target[0], w[row + 2] - target[1]);
  return {root, diagonal,
          (impulse - into_cone(impulse - off / diagonal, contacts.friction_bound(k, 1))).norm()};
}

}  // namespace

DiscState sliding_state(const ContactRows& contacts, int k, std::span<const double> lambda,
                        std::span<const double> w) {
  return disc_state(contacts, contacts.first_row(k) + ContactRows::kSlidingRow,
                    contacts.point(k).sliding.given, sliding_law(contacts, k), lambda, w);
}

DiscState rolling_state(const ContactRows& contacts, int k, std::span<const double> lambda,
                        std::span<const double> w) {
  const ContactConstraints::Disc& disc = contacts.point(k).rolling;
  const double normal = contacts.pressure(k, lambda);
  const LinearFriction linear = linear_friction(contacts, k);
  DiscState state = disc_state(contacts, contacts.first_row(k) + ContactRows::kRollingRow,
                               disc.given + linear.rolling_lag * normal, disc.rigid_law(), lambda, w);
  state.slope = linear.rolling * normal;
  return state;
}

NaturalResidual spinning_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                                  std::span<const double> w) {
  const int row = contacts.first_row(k) + ContactRows::kSpinRow;
  const double normal = contacts.pressure(k, lambda);
  const double bound = contacts.slot(k).material.spinning_friction * normal;
  const LinearFriction linear = linear_friction(contacts, k);
  const double root = contacts.root_diagonal(row), diagonal = root * root;
  const double spin = contacts.point(k).spin_given + linear.spin_lag * normal + lambda[row];
  const double part = part_of_slope(linear.spinning * normal, diagonal);
  return {root, diagonal, spin - into_interval(spin - w[row] / diagonal, bound, part)};
}

ContactResidual natural_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                                 std::span<const double> w) {
  ContactResidual of;
  if (!contacts.works(k)) return of;
  if (contacts.obeys_normality(k)) {
    of.cone = cone_residual(contacts, k, lambda, w);
  } else {
    of.normal = normal_residual(contacts, k, lambda, w);
    of.sliding = sliding_residual(contacts, k, lambda, w);
  }
  if (!contacts.has_twist(k)) return of;
  of.spinning = spinning_residual(contacts, k, lambda, w);
  of.rolling = rolling_residual(contacts, k, lambda, w);
  return of;
}

void add_contacts(const ContactRows& contacts, std::span<const double> lambda, std::span<const double> w,
                  double rate_tolerance, LargestResidual& largest) {
  for (int k = 0; k < contacts.count(); ++k) {
    const ContactResidual of = natural_residual(contacts, k, lambda, w);
    largest.add(of.cone.size);
    for (const NaturalResidual* law : {&of.normal, &of.sliding, &of.spinning, &of.rolling})
      largest.add(law->beyond(rate_tolerance));
  }
}

/// It is by the smaller of both that the law of a contact that begins or ceases to slip is met.
double relative_contact_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                                 std::span<const double> w, double scale, const RateSize& least) {
  const ContactResidual of = natural_residual(contacts, k, lambda, w);
  LargestResidual largest;
  const auto add = [&](double residual, int behind, double rate) {
    if (!(residual > 0)) return;
    const double least_size = rate / contacts.root_diagonal(contacts.first_row(k) + behind);
    largest.add(residual / std::max(scale, least_size));
  };
  double sliding = of.sliding.size;
  if (sliding > 0 && contacts.compliance(k) == 0)
    sliding = std::min(sliding, other_sliding_residual(contacts, k, lambda, w).size);
  add(of.normal.size, 0, least.linear);
  add(sliding, ContactRows::kSlidingRow, least.linear);
  add(of.spinning.size, ContactRows::kSpinRow, least.angular);
  add(of.rolling.size, ContactRows::kRollingRow, least.angular);
  return largest.size();
}

}  // namespace taut
