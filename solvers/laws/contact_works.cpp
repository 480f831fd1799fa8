#include "solvers/laws/contact_works.h"

namespace taut {

void ContactWorks::record_kick(std::span<const double> lambda, std::span<const double> rates) {
  for (int k = 0; k < contacts_.count(); ++k)
    if (contacts_.point(k).active)
      record(k, lambda, rates, contacts_.table().single_kick || contacts_.compliance(k) > 0);
}

void ContactWorks::record_impact(std::span<const double> impulses, std::span<const double> rates) {
  for (int k = 0; k < contacts_.count(); ++k)
    if (contacts_.works(k)) record(k, impulses, rates, true);
}

double ContactWorks::of_rigid(std::span<const double> impulses, std::span<const double> rates) const {
  double sum = 0;
  for (int k = 0; k < contacts_.count(); ++k) {
    if (!contacts_.point(k).active || contacts_.compliance(k) > 0) continue;
    const int first = contacts_.first_row(k);
    for (int r = first; r < first + contacts_.row_count(k); ++r) sum += impulses[r] * rates[r];
  }
  return sum;
}

void ContactWorks::record(int k, std::span<const double> lambda, std::span<const double> rates, bool all) {
  constexpr int kSliding = ContactRows::kSlidingRow, kSpin = ContactRows::kSpinRow,
                kRolling = ContactRows::kRollingRow;
  const ContactConstraints::Point& point = contacts_.point(k);
  const bool stops = all || point.approach < -contacts_.table().resting_speed;
  const int row = contacts_.first_row(k);
  const auto work = [&](int r) { return lambda[row + r] * rates[row + r]; };
  if (stops) sum_.normal += work(0);
  if (stops || point.sliding.slips) sum_.friction += work(kSliding) + work(kSliding + 1);
  if (!contacts_.has_twist(k)) return;
  sum_.friction += work(kSpin);
  if (stops || point.rolling.slips || resists_turning_linearly(contacts_.slot(k).material))
    sum_.friction += work(kRolling) + work(kRolling + 1);
}

}  // namespace taut
