#include "core/state/axis.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "core/base/check.h"

namespace taut {
namespace {

std::string of(const char* what, std::string_view axis) { return what + (" of " + std::string(axis)); }

/// A damping table gives no force at rest but for this part of its largest.
constexpr double kTableRoundOff = 1e-14;

/// Not negative; infinity means unlimited.
void require_bound(const std::string& name, double value) {
  if (!(value >= 0)) fail(name, "must not be negative", value);
}

}  // namespace

Curve::Curve(std::vector<Point> points) : points_(std::move(points)) {
  if (points_.empty()) fail("curve", "must have a point", 0);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const std::string name = "curve point " + std::to_string(i + 1);
    require_finite(name, points_[i].x);
    require_finite(name, points_[i].y);
    if (i > 0 && points_[i].x <= points_[i - 1].x)
      fail(name, "must lie to the right of the point before it", points_[i].x);
  }
}

/// Index of the left end of the piece that holds x, or the nearest one; needs two points.
std::size_t Curve::piece(double x) const {
  const auto right = std::upper_bound(points_.begin() + 1, points_.end() - 1, x,
                                      [](double value, const Point& p) { return value < p.x; });
  return static_cast<std::size_t>(right - points_.begin()) - 1;
}

double Curve::held(double x) const {
  if (!(x > points_.front().x)) return points_.front().y;
  return x < points_.back().x ? extended(x) : points_.back().y;
}

double Curve::extended(double x) const {
  if (points_.size() == 1) return points_[0].y;
  const std::size_t i = piece(x);
  return points_[i].y + slope(x) * (x - points_[i].x);
}

double Curve::slope(double x) const {
  if (points_.size() == 1) return 0;
  const std::size_t i = piece(x);
  return (points_[i + 1].y - points_[i].y) / (points_[i + 1].x - points_[i].x);
}

/// Trapezoids, exact for a function that is linear between its points.
double Curve::integral(double from, double to) const {
  const double low = std::min(from, to), high = std::max(from, to);
  double at = low, sum = 0;
  const auto add = [&](double next) {
    sum += 0.5 * (next - at) * (extended(at) + extended(next));
    at = next;
  };
  for (const Point& p : points_)
    if (p.x > low && p.x < high) add(p.x);
  add(high);
  return from <= to ? sum : -sum;
}

/// d/db (1/(b − a) ∫ f) = (f(b) − mean)/(b − a): in one piece half its slope, and never more than the
/// steepest has, whatever round-off makes of it.
Curve::Mean Curve::mean(double from, double to) const {
  if (points_.size() < 3 || piece(from) == piece(to))
    return {0.5 * (extended(from) + extended(to)), 0.5 * slope(to)};
  const double value = integral(from, to) / (to - from);
  double steepest = 0;
  for (std::size_t i = std::min(piece(from), piece(to)); i <= std::max(piece(from), piece(to)); ++i)
    steepest = std::max(steepest, std::abs(slope(points_[i].x)));
  return {value, std::clamp((extended(to) - value) / (to - from), -steepest, steepest)};
}

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

double beyond(const AxisLimits& limits, double theta) {
  return theta > limits.upper ? theta - limits.upper : std::min(0.0, theta - limits.lower);
}

double limit_energy(const AxisLimits& limits, double theta) {
  if (limits.compliance == 0) return 0;
  const double stretch = beyond(limits, theta);
  return 0.5 * stretch * stretch / limits.compliance;
}

double AxisSpring::energy(double theta) const { return spring_energy(*this, theta); }

double AxisLimits::energy(double theta) const { return limit_energy(*this, theta); }

std::string AxisLimits::start_problem(double theta, double tolerance) const {
  const bool low = theta < lower - tolerance;
  if (compliance > 0 || (!low && !(theta > upper + tolerance))) return {};
  std::ostringstream message;
  message << "starts at " << theta << ", " << (low ? "below its lower limit " : "above its upper limit ")
          << (low ? lower : upper);
  return message.str();
}

bool AxisProperties::any() const {
  return with_all(*this, [](const auto&... all) { return (all.has_value() || ...); });
}

bool AxisProperties::stores_energy() const {
  bool stores = false;
  each([&](const auto& property) {
    if constexpr (requires { property.stores_energy(); }) stores = stores || property.stores_energy();
  });
  return stores;
}

void AxisProperties::add_energy(double theta, double& energy) const {
  each([&](const auto& property) {
    if constexpr (requires { property.stores_energy(); })
      if (property.stores_energy()) energy += property.energy(theta);
  });
}

bool AxisProperties::keeps_going() const {
  bool goes = false;
  each([&](const auto& property) {
    if constexpr (requires { property.keeps_going(); }) goes = goes || property.keeps_going();
  });
  return goes;
}

void check_axis(std::string_view axis, const AxisLimits& limits) {
  if (std::isnan(limits.lower) || limits.lower == kUnlimited)
    fail(of("lower limit", axis), "must be a number or −infinity", limits.lower);
  if (std::isnan(limits.upper) || limits.upper == -kUnlimited)
    fail(of("upper limit", axis), "must be a number or infinity", limits.upper);
  if (limits.lower > limits.upper)
    fail(of("lower limit", axis), "must not exceed the upper limit " + std::to_string(limits.upper),
         limits.lower);
  if (!(limits.restitution >= 0 && limits.restitution <= 1))
    fail(of("restitution", axis), "must be from 0 to 1", limits.restitution);
  require_not_negative(of("limit compliance", axis), limits.compliance);
  require_not_negative(of("limit damping", axis), limits.damping);
  if (limits.compliance > 0 && limits.restitution > 0)
    fail(of("restitution", axis), "must be 0 beside a compliance", limits.restitution);
  if (limits.compliance == 0 && limits.damping > 0)
    fail(of("limit damping", axis), "needs a compliance", limits.damping);
}

void check_axis(std::string_view axis, const AxisMotor& motor) {
  require_finite(of("motor target", axis), motor.target);
  if (motor.mode == AxisMotor::Mode::kTrajectory && !motor.trajectory)
    fail(of("motor trajectory", axis), "must be given in its mode", "null");
  require_bound(of("motor max_force", axis), motor.max_force);
  if (!(motor.max_speed > 0)) fail(of("motor max_speed", axis), "must be positive", motor.max_speed);
  if (motor.mode == AxisMotor::Mode::kVelocity && motor.max_speed != kUnlimited)
    fail(of("motor max_speed", axis), "is for a position or trajectory, not beside a velocity",
         motor.max_speed);
  require_not_negative(of("motor stiffness", axis), motor.stiffness);
  require_not_negative(of("motor damping", axis), motor.damping);
  if (motor.mode == AxisMotor::Mode::kVelocity && motor.stiffness != 0)
    fail(of("motor stiffness", axis), "is for a position or trajectory, not beside a velocity",
         motor.stiffness);
  if (motor.has_gains() && motor.max_speed != kUnlimited)
    fail(of("motor max_speed", axis), "is for a motor without stiffness and damping", motor.max_speed);
  if (motor.has_gains() && motor.pulls_only)
    fail(of("motor stiffness and damping", axis), "must be 0 where it only pulls",
         motor.stiffness > 0 ? motor.stiffness : motor.damping);
  if (!motor.force_of_speed) return;
  for (const Curve::Point& p : motor.force_of_speed->points()) {
    require_not_negative(of("speed in the motor curve", axis), p.x);
    require_not_negative(of("force in the motor curve", axis), p.y);
  }
}

void check_axis(std::string_view axis, const AxisFriction& friction) {
  require_not_negative(of("static friction", axis), friction.static_friction);
  require_not_negative(of("dynamic friction", axis), friction.dynamic_friction);
  require_not_negative(of("viscous friction", axis), friction.viscous);
  require_not_negative(of("friction per load", axis), friction.per_load);
  if (friction.dynamic_friction > friction.static_friction)
    fail(of("dynamic friction", axis),
         "must not exceed the static friction " + std::to_string(friction.static_friction),
         friction.dynamic_friction);
}

void check_axis(std::string_view axis, const AxisSpring& spring) {
  require_not_negative(of("spring stiffness", axis), spring.stiffness);
  require_not_negative(of("spring damping", axis), spring.damping);
  require_finite(of("spring rest", axis), spring.rest);
  if (spring.table && spring.stiffness != 0)
    fail(of("spring stiffness", axis), "must be 0 beside a table", spring.stiffness);
  if (!spring.damping_table) return;
  if (spring.damping != 0)
    fail(of("spring damping", axis), "must be 0 beside a damping table", spring.damping);
  // So that it takes energy at every rate and has one answer to every load.
  const double at_rest = spring.damping_table->extended(0);
  const std::vector<Curve::Point>& points = spring.damping_table->points();
  const double largest = std::max(std::abs(points.front().y), std::abs(points.back().y));
  if (!(std::abs(at_rest) <= kTableRoundOff * largest))
    fail(of("damping table", axis), "must give no force at rest", at_rest);
  for (std::size_t i = 1; i < points.size(); ++i)
    if (points[i].y < points[i - 1].y)
      fail(of("damping table", axis), "must not fall with the rate", points[i].y);
}

}  // namespace taut
