#include "solvers/laws/contact_rows.h"

#include <cmath>

namespace taut {

void ContactRows::choose(std::span<const int> slots, const Rows& rows) {
  slots_.assign(slots.begin(), slots.end());
  first_row_.clear();
  for (int k = 0; k < rows.contact_count(); ++k)
    first_row_.push_back(rows.joints()[rows.contact_joint(k)].first_row);
}

void ContactRows::set_effective_masses(std::span<const double> effective_mass) {
  root_diagonal_.resize(effective_mass.size());
  for (std::size_t r = 0; r < effective_mass.size(); ++r)
    root_diagonal_[r] = effective_mass[r] > 0 ? 1 / std::sqrt(effective_mass[r]) : 1;
}

double ContactRows::friction_bound(int k, double normal) const {
  const Material& material = slot(k).material;
  return (point(k).stuck && !point(k).slipping ? material.static_friction : material.dynamic_friction) *
         std::max(0.0, normal);
}

double ContactRows::slip_of(int k, std::span<const double> w) const {
  const Vec2& target = point(k).sliding.target;
  return std::hypot(w[first_row_[k] + 1] - target[0], w[first_row_[k] + 2] - target[1]);
}

bool ContactRows::rest() const {
  for (int k = 0; k < count(); ++k)
    if (point(k).live &&
        (impact(k).let_through() || (point(k).approach < -table_.resting_speed && compliance(k) == 0)))
      return false;
  return true;
}

double ContactRows::restitution() const {
  double largest = 0;
  for (int k = 0; k < count(); ++k)
    if (works(k) && point(k).approach < 0) largest = std::max(largest, slot(k).material.restitution);
  return largest;
}

void ContactRows::weaken_restitution(double part) {
  for (int k = 0; k < count(); ++k)
    point(k).least_rate = -part * slot(k).material.restitution * point(k).approach;
}

bool ContactRows::take_back(std::span<const double> mu) const {
  for (int k = 0; k < count(); ++k)
    if (point(k).active && compliance(k) == 0 && mu[first_row_[k]] < 0) return true;
  return false;
}

bool ContactRows::soft() const {
  for (int k = 0; k < count(); ++k)
    if (point(k).live && compliance(k) > 0) return true;
  return false;
}

bool ContactRows::all_stick(std::span<const double> lambda) const {
  for (int k = 0; k < count(); ++k)
    if (presses(k, lambda) && friction_bound(k, 1) > 0 && !sticks(k)) return false;
  return true;
}

bool ContactRows::slips_where_it_held() const {
  for (int k = 0; k < count(); ++k)
    if (slips_in_vain(k)) return true;
  return false;
}

double ContactRows::sticking_slip(std::span<const double> w) const {
  double largest = 0;
  for (int k = 0; k < count(); ++k)
    if (sticks(k)) largest = std::max(largest, slip_of(k, w));
  return largest;
}

double ContactRows::curved_off(std::span<const double> lambda, std::span<const double> w,
                               std::span<const double> linear) const {
  double off = 0;
  for (int k = 0; k < count(); ++k) {
    if (!presses(k, lambda)) continue;
    const int rows = point(k).sliding.slips ? kSlidingRow : kSpinRow;
    for (int r = first_row_[k]; r < first_row_[k] + rows; ++r)
      if (const double own = std::abs(w[r] - linear[r]); !(own <= point(k).curved)) off = std::max(off, own);
  }
  return off;
}

void ContactRows::clear_idle(std::span<double> lambda) const {
  for (int k = 0; k < count(); ++k)
    if (!works(k)) std::fill_n(lambda.begin() + first_row_[k], row_count(k), 0.0);
}

bool ContactRows::is_clear(std::span<const double> lambda) const {
  for (int k = 0; k < count(); ++k) {
    const auto given = lambda.begin() + first_row_[k];
    if (!works(k) && std::any_of(given, given + row_count(k), [](double l) { return l != 0; })) return false;
  }
  return true;
}

}  // namespace taut
