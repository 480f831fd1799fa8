#include "solvers/laws/contact_impacts.h"

#include <algorithm>
#include <cmath>

#include "solvers/laws/time_of_meeting.h"

namespace taut {

bool ContactImpacts::seek(std::span<const double> lambda) {
  bool any = false;
  for (int k = 0; k < std::ssize(table_.points); ++k) {
    ContactTable::Point& point = table_.points[k];
    ContactTable::Impact& impact = table_.impacts[k];
    if (!point.live || !contacts_.locates_impacts(k) || impact.spent || contacts_.spring(k).impact_is_seen())
      continue;
    if (!(lambda[contacts_.first_row(k)] > 0)) continue;
    if (std::min(point.approach, -point.gap / table_.h) > -table_.resting_speed) continue;
    impact.stage = ContactTable::Impact::Stage::kSought;
    point.live = false;
    any = true;
  }
  if (any) ++count_;
  return any;
}

/// When the points of contact k meet; h if they do not.
double ContactImpacts::crossing(int k, double w) const {
  const ContactTable::Point& point = table_.points[k];
  return time_of_meeting(point.gap, point.approach, w, table_.h);
}

double ContactImpacts::first(std::span<const double> w) const {
  double earliest = table_.h;
  for (int k = 0; k < std::ssize(table_.points); ++k)
    if (table_.impacts[k].stage == ContactTable::Impact::Stage::kSought && count_ <= kMostImpacts)
      earliest = std::min(earliest, crossing(k, w[contacts_.first_row(k)]));
  return earliest;
}

void ContactImpacts::take(double until, std::span<const double> w) {
  for (int k = 0; k < std::ssize(table_.points); ++k) {
    ContactTable::Impact& impact = table_.impacts[k];
    // What was due at the end of a longer step goes on to be if it closes until then, too.
    const bool due =
        impact.stage != ContactTable::Impact::Stage::kNone && crossing(k, w[contacts_.first_row(k)]) <= until;
    impact.stage = due ? ContactTable::Impact::Stage::kDue : ContactTable::Impact::Stage::kNone;
  }
}

void ContactImpacts::forget(bool for_good) {
  for (ContactTable::Impact& impact : table_.impacts) {
    if (for_good && impact.stage != ContactTable::Impact::Stage::kNone) impact.spent = true;
    impact.stage = ContactTable::Impact::Stage::kNone;
  }
}

void ContactImpacts::clear() {
  count_ = 0;
  for (ContactTable::Impact& impact : table_.impacts) impact = {};
}

}  // namespace taut
