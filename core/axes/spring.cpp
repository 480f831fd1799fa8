#include "core/axes/spring.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/check.h"

namespace taut {
namespace {

/// A damping table gives no force at rest but for this part of its largest.
constexpr double kTableRoundOff = 1e-14;

}  // namespace

double spring_force(const AxisSpring& spring, double theta) {
  const double x = theta - spring.rest;
  return spring.table ? -spring.table->extended(x) : -spring.stiffness * x;
}

double damping_force(const AxisSpring& spring, double rate) {
  return spring.damping_table ? -spring.damping_table->extended(rate) : -spring.damping * rate;
}

double spring_energy(const AxisSpring& spring, double theta) {
  const double x = theta - spring.rest;
  return spring.table ? spring.table->integral(0, x) : 0.5 * spring.stiffness * x * x;
}

double AxisSpring::energy(double theta) const { return spring_energy(*this, theta); }

void AxisSpring::check(std::string_view axis) const {
  using detail::of_axis;
  if (table && stiffness != 0) fail(of_axis("spring stiffness", axis), "must be 0 beside a table", stiffness);
  if (!damping_table) return;
  if (damping != 0) fail(of_axis("spring damping", axis), "must be 0 beside a damping table", damping);
  // So that it takes energy at every rate and has one answer to every load.
  const double at_rest = damping_table->extended(0);
  const std::vector<Curve::Point>& points = damping_table->points();
  const double largest = std::max(std::abs(points.front().y), std::abs(points.back().y));
  if (!(std::abs(at_rest) <= kTableRoundOff * largest))
    fail(of_axis("damping table", axis), "must give no force at rest", at_rest);
  for (std::size_t i = 1; i < points.size(); ++i)
    if (points[i].y < points[i - 1].y)
      fail(of_axis("damping table", axis), "must not fall with the rate", points[i].y);
}

}  // namespace taut
