#include "solvers/simulator/sleeping_loads.h"

#include <algorithm>

namespace taut {

bool SleepingLoads::rests(JointId joint) const {
  if (source_.asleep_count() == 0) return false;
  const std::span<const BodyId> bodies = source_.joint(joint).bodies();
  return std::any_of(bodies.begin(), bodies.end(), [&](BodyId b) { return source_.is_asleep(b); });
}

bool SleepingLoads::rests(const ContactReport& report) const {
  const BodyId A = report.contact.A, B = report.contact.B;
  return !source_.moves(A) && !source_.moves(B) && (source_.is_asleep(A) || source_.is_asleep(B));
}

void SleepingLoads::forget_woken() {
  std::erase_if(contacts_, [&](const ContactReport& c) { return !rests(c); });
}

Reaction SleepingLoads::reaction(JointId joint) const {
  const auto then = reactions_.find(joint);
  return then == reactions_.end() ? Reaction{} : then->second;
}

AxisReport SleepingLoads::axis(AxisId axis) const {
  const auto then = axes_.find(axis);
  return then == axes_.end() ? AxisReport{} : then->second;
}

void SleepingLoads::append_contacts(std::vector<ContactReport>& reports) const {
  for (const ContactReport& report : contacts_)
    if (rests(report)) reports.push_back(report);
}

}  // namespace taut
