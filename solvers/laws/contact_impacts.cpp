#include "solvers/laws/contact_impacts.h"

#include <algorithm>

namespace taut {

bool ContactImpacts::let_through(std::size_t i, std::span<const double> lambda,
                                 std::span<const double> /*w*/) {
  const int k = static_cast<int>(i);
  ContactConstraints::Point& point = table_.points[i];
  if (!point.live || !contacts_.locates_impacts(k) || contacts_.spring(k).impact_is_seen()) return false;
  if (!(lambda[contacts_.first_row(k)] > 0)) return false;
  if (std::min(point.approach, -point.gap / table_.h) > -table_.resting_speed) return false;
  point.live = false;
  return true;
}

double ContactImpacts::meeting(std::size_t i, std::span<const double> w, double h) const {
  const ContactConstraints::Point& point = table_.points[i];
  return time_of_meeting(point.gap, point.approach, w[contacts_.first_row(static_cast<int>(i))], h);
}

void ContactImpacts::clear() {
  count_ = 0;
  for (ImpactState& impact : table_.impacts) impact = {};
}

}  // namespace taut
