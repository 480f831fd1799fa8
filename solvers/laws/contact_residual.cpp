#include "solvers/laws/contact_residual.h"

#include <algorithm>
#include <cmath>

#include "solvers/laws/signorini_coulomb.h"

namespace taut {
namespace {

DiscState disc_state(const ContactRows& contacts, int row, const Vec2& given,
                     const ContactTable::SlipLaw& law, std::span<const double> lambda,
                     std::span<const double> w) {
  const Vec2 impulse(lambda[row], lambda[row + 1]);
  return {given + impulse, Vec2(w[row], w[row + 1]) + law.softness * impulse - law.target,
          std::max(contacts.root(row), contacts.root(row + 1)), law.softness};
}

double normal_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                       std::span<const double> w) {
  const int row = contacts.first_row(k);
  const double root = contacts.root(row);
  const ContactTable::NormalLaw law = normal_law(contacts, k);
  const double normal = contacts.point(k).back + lambda[row];
  const double off = w[row] + law.softness * lambda[row] - law.target;
  const double own = root * root + law.softness;
  return root * std::abs(normal - std::clamp(normal - off / own, 0.0, law.most));
}

/// A contact that begins or ceases to slip in this stage was asked to return by what it had slipped, or not
/// to slip: it is by the smaller of both that its law is met.
double sliding_residual_either_way(const ContactRows& contacts, int k, std::span<const double> lambda,
                                   std::span<const double> w) {
  const double bound = contacts.friction_bound(k, contacts.pressure(k, lambda));
  const double as_told = sliding_state(contacts, k, lambda, w).residual(bound);
  if (contacts.compliance(k) > 0) return as_told;
  ContactTable::Disc other = contacts.point(k).sliding;
  other.slips = !other.slips;
  const int row = contacts.first_row(k) + ContactRows::kSlidingRow;
  return std::min(as_told,
                  disc_state(contacts, row, other.given, other.rigid_law(), lambda, w).residual(bound));
}

double rolling_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                        std::span<const double> w) {
  const double arm = contacts.place(k).material.rolling_friction;
  return rolling_state(contacts, k, lambda, w).residual(arm * contacts.pressure(k, lambda));
}

/// Distance of the three impulses from the normality law of the cone of static friction.
double normality_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                          std::span<const double> w) {
  const ContactTable::Point& point = contacts.point(k);
  const int row = contacts.first_row(k);
  const Vec2& given = point.sliding.given;
  const Vec2& target = point.sliding.target;
  const double root = std::max({contacts.root(row), contacts.root(row + 1), contacts.root(row + 2)});
  const Vec3 impulse(point.back + lambda[row], given[0] + lambda[row + 1], given[1] + lambda[row + 2]);
  const Vec3 off(w[row] - normal_law(contacts, k).target, w[row + 1] - target[0], w[row + 2] - target[1]);
  return root * (impulse - into_cone(impulse - off / (root * root), contacts.friction_bound(k, 1))).norm();
}

}  // namespace

DiscState sliding_state(const ContactRows& contacts, int k, std::span<const double> lambda,
                        std::span<const double> w) {
  return disc_state(contacts, contacts.first_row(k) + ContactRows::kSlidingRow,
                    contacts.point(k).sliding.given, sliding_law(contacts, k), lambda, w);
}

DiscState rolling_state(const ContactRows& contacts, int k, std::span<const double> lambda,
                        std::span<const double> w) {
  const ContactTable::Disc& disc = contacts.point(k).rolling;
  return disc_state(contacts, contacts.first_row(k) + ContactRows::kRollingRow, disc.given, disc.rigid_law(),
                    lambda, w);
}

double spinning_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                         std::span<const double> w) {
  const int row = contacts.first_row(k) + ContactRows::kSpinRow;
  const double bound = contacts.place(k).material.spinning_friction * contacts.pressure(k, lambda);
  const double root = contacts.root(row), spin = contacts.point(k).spin_given + lambda[row];
  return root * std::abs(spin - std::clamp(spin - w[row] / (root * root), -bound, bound));
}

double contact_residual(const ContactRows& contacts, std::span<const double> lambda,
                        std::span<const double> w, double rate_tolerance) {
  double largest = 0;
  const auto add = [&](double residual, int row, double softness = 0) {
    const double root = contacts.root(row);
    if (!((root + softness / root) * residual <= rate_tolerance)) largest = std::max(largest, residual);
  };
  for (int k = 0; k < contacts.count(); ++k) {
    if (!contacts.works(k)) continue;
    const int row = contacts.first_row(k);
    if (contacts.shares(k)) {
      largest = std::max(largest, normality_residual(contacts, k, lambda, w));
    } else {
      const DiscState sliding = sliding_state(contacts, k, lambda, w);
      const double bound = contacts.friction_bound(k, contacts.pressure(k, lambda));
      add(normal_residual(contacts, k, lambda, w), row, normal_law(contacts, k).softness);
      add(sliding.residual(bound), row + ContactRows::kSlidingRow, sliding.softness);
    }
    if (!contacts.has_twist(k)) continue;
    add(spinning_residual(contacts, k, lambda, w), row + ContactRows::kSpinRow);
    add(rolling_residual(contacts, k, lambda, w), row + ContactRows::kRollingRow);
  }
  return largest;
}

double relative_contact_residual(const ContactRows& contacts, std::span<const double> lambda,
                                 std::span<const double> w, double scale, const RateSize& least) {
  double largest = 0;
  for (int k = 0; k < contacts.count(); ++k)
    largest = std::max(largest, relative_contact_residual(contacts, k, lambda, w, scale, least));
  return largest;
}

double relative_contact_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                                 std::span<const double> w, double scale, const RateSize& least) {
  if (!contacts.works(k)) return 0;
  const int row = contacts.first_row(k);
  double largest = 0;
  const auto add = [&](double residual, int r, double rate) {
    if (residual > 0) largest = std::max(largest, residual / std::max(scale, rate / contacts.root(r)));
  };
  add(normal_residual(contacts, k, lambda, w), row, least.linear);
  add(sliding_residual_either_way(contacts, k, lambda, w), row + ContactRows::kSlidingRow, least.linear);
  if (!contacts.has_twist(k)) return largest;
  add(spinning_residual(contacts, k, lambda, w), row + ContactRows::kSpinRow, least.angular);
  add(rolling_residual(contacts, k, lambda, w), row + ContactRows::kRollingRow, least.angular);
  return largest;
}

double DiscState::residual(double bound) const {
  const Vec2 slipped = tau - slip / (root * root + softness);
  return root * (tau - into_disc(slipped, bound)).norm();
}

}  // namespace taut
