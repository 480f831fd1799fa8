#include "scenes/accuracy/reference_contacts.h"

namespace taut::reference {

PairContact pair_contact(const Simulator& simulator, const Pair& pair) {
  PairContact sum;
  for (const ContactReport& report : simulator.contacts()) {
    const bool same = report.contact.A == pair.body_a && report.contact.B == pair.body_b;
    const bool swapped = report.contact.A == pair.body_b && report.contact.B == pair.body_a;
    if (!same && !swapped) continue;
    const Vec3 normal = report.normal_force * report.contact.normal;
    sum.normal_on_b += same ? normal : Vec3(-normal);
    sum.friction_on_b += same ? Vec3(report.force - normal) : Vec3(normal - report.force);
    sum.normal_sum += report.normal_force;
    const Pose& pose = simulator.world().state().poses[report.contact.B.index];
    sum.moment += report.normal_force * pose.point(report.contact.p_BQ);
    sum.sliding = sum.sliding || (report.sliding && report.normal_force > 0);
    if (report.impact_time) sum.impact_time = std::max(report.impact_time, sum.impact_time);
  }
  return sum;
}

}  // namespace taut::reference
