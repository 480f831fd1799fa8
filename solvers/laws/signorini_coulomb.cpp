#include "solvers/laws/signorini_coulomb.h"

#include <algorithm>

namespace taut {
namespace {

/// Bodies may come together by their gap in a step, and bodies inside each other part slowly.
double closing_rate(const ContactRows& contacts, int k) {
  const double h = contacts.table().h;
  return std::clamp(-contacts.point(k).gap / h, -kUnreachedRate, std::max(kReturnRate, kTouch / h));
}

}  // namespace

ContactTable::NormalLaw normal_law(const ContactRows& contacts, int k) {
  const bool strikes = contacts.impact(k).due();
  if (contacts.compliance(k) > 0 && !strikes) return contacts.point(k).soft;
  const double yield = contacts.point(k).yield;
  const double target = contacts.table().in_velocities ? contacts.point(k).bounce : closing_rate(contacts, k);
  return {.target = yield > 0 ? std::min(target, 0.0) : target, .softness = yield};
}

ContactTable::NormalLaw spring_law(const ContactRows& contacts, int k) {
  const ContactTable::Point& point = contacts.point(k);
  const double restitution = contacts.place(k).material.restitution;
  const ContactSpring spring = contacts.spring(k);
  return contacts.table().in_velocities
             ? spring.velocity_law(point.gap, point.approach, point.back, restitution)
             : spring.position_law(point.gap, restitution);
}

ContactTable::SlipLaw sliding_law(const ContactRows& contacts, int k) {
  const ContactTable::Disc& disc = contacts.point(k).sliding;
  if (contacts.shares(k)) return {disc.target, 0};
  if (contacts.compliance(k) == 0) return disc.rigid_law();
  const ContactSpring spring = contacts.spring(k, ContactRows::kSlidingRow);
  return contacts.table().in_velocities ? spring.velocity_slip_law(disc.given)
                                        : spring.position_slip_law(disc.target);
}

ContactCone contact_cone(const ContactRows& contacts, int k) {
  const ContactTable::Point& point = contacts.point(k);
  const Material& material = contacts.place(k).material;
  const ContactTable::NormalLaw normal = normal_law(contacts, k);
  return {.works = contacts.works(k),
          .twist = contacts.has_twist(k),
          .shares = contacts.shares(k),
          .sliding = contacts.friction_bound(k, 1),
          .spinning = material.spinning_friction,
          .rolling = material.rolling_friction,
          .softness = normal.softness,
          .most = normal.most,
          .slip_softness = sliding_law(contacts, k).softness,
          .normal_given = point.back,
          .spin_given = point.spin_given,
          .sliding_given = point.sliding.given,
          .rolling_given = point.rolling.given};
}

}  // namespace taut
