#include "solvers/laws/signorini_coulomb.h"

#include <algorithm>

namespace taut {
ContactConstraints::NormalLaw normal_law(const ContactRows& contacts, int k) {
  const bool strikes = contacts.impact(k).due();
  if (contacts.compliance(k) > 0 && !strikes) return contacts.point(k).soft;
  const double yield = contacts.point(k).yield;
  const double target = contacts.point(k).least_rate;
  return {.target = yield > 0 ? std::min(target, 0.0) : target, .softness = yield};
}

ContactConstraints::SlipLaw sliding_law(const ContactRows& contacts, int k) {
  const ContactConstraints::Disc& disc = contacts.point(k).sliding;
  if (contacts.obeys_normality(k)) return {disc.target, 0};
  return contacts.compliance(k) == 0 ? disc.rigid_law() : contacts.point(k).soft_slip;
}

LinearFriction linear_friction(const ContactRows& contacts, int k) {
  if (!resists_turning_linearly(contacts.slot(k).material)) return {};
  const ContactConstraints::Point& point = contacts.point(k);
  const Material& material = contacts.slot(k).material;
  const row_parts::ContactFrame& frame = contacts.slot(k).point.frame;
  const double spinning = material.spinning_friction_linear, rolling = material.rolling_friction_linear;
  const Vec3 before = (1 - point.present) * point.turning;
  return {.spinning = point.present * spinning,
          .rolling = point.present * rolling,
          .spin_lag = spinning * frame.n.dot(before),
          .rolling_lag = rolling * Vec2(frame.t1.dot(before), frame.t2.dot(before))};
}

ContactCone contact_cone(const ContactRows& contacts, int k) {
  const ContactConstraints::Point& point = contacts.point(k);
  const Material& material = contacts.slot(k).material;
  const ContactConstraints::NormalLaw normal = normal_law(contacts, k);
  return {.works = contacts.works(k),
          .twist = contacts.has_twist(k),
          .normality = contacts.obeys_normality(k),
          .sliding = contacts.friction_bound(k, 1),
          .spinning = material.spinning_friction,
          .rolling = material.rolling_friction,
          .softness = normal.softness,
          .most = normal.most,
          .slip_softness = sliding_law(contacts, k).softness,
          .normal_given = point.back,
          .spin_given = point.spin_given,
          .sliding_given = point.sliding.given,
          .rolling_given = point.rolling.given,
          .linear = linear_friction(contacts, k)};
}

}  // namespace taut
