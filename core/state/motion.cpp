#include "core/state/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/check.h"
#include "core/math/spline.h"

namespace taut {

Motion linear_motion(double value, double rate, double start) {
  require_finite("motion value", value);
  require_finite("motion rate", rate);
  require_finite("motion start", start);
  return [=](double t) { return MotionPoint{value + rate * (t - start), rate, 0}; };
}

Motion harmonic_motion(double mean, double amplitude, double omega, double phase) {
  return harmonics_motion(mean, {{amplitude, omega, phase}});
}

Motion harmonics_motion(double mean, std::vector<Harmonic> terms) {
  require_finite("motion mean", mean);
  for (const Harmonic& term : terms) {
    require_finite("motion amplitude", term.amplitude);
    require_finite("motion omega", term.omega);
    require_finite("motion phase", term.phase);
  }
  return [mean, terms = std::move(terms)](double t) {
    MotionPoint at{mean, 0, 0};
    for (const auto& [amplitude, omega, phase] : terms) {
      const double s = std::sin(omega * t + phase), c = std::cos(omega * t + phase);
      at.value += amplitude * s;
      at.rate += amplitude * omega * c;
      at.acceleration -= amplitude * omega * omega * s;
    }
    return at;
  };
}

Motion table_motion(Curve table, bool periodic) {
  const double first = table.points().front().x, last = table.points().back().x, period = last - first;
  if (periodic && !(period > 0)) fail("periodic table", "must have two points or more", 1);
  return [=, table = std::move(table)](double t) {
    if (periodic) t = first + std::clamp(t - first - period * std::floor((t - first) / period), 0.0, period);
    const bool inside = t >= first && t < last;
    return MotionPoint{table.held(t), inside ? table.slope(t) : 0, 0};
  };
}

Motion ramp_motion(double from, double to, double start, double duration, bool smooth) {
  require_finite("ramp from", from);
  require_finite("ramp to", to);
  require_finite("ramp start", start);
  require_positive("ramp duration", duration);
  return [=](double t) {
    const double part = (t - start) / duration, rise = to - from, turn = std::numbers::pi / duration;
    if (part <= 0) return MotionPoint{from, 0, 0};
    if (part >= 1) return MotionPoint{to, 0, 0};
    if (!smooth) return MotionPoint{from + rise * part, rise / duration, 0};
    const double s = std::sin(std::numbers::pi * part), c = std::cos(std::numbers::pi * part);
    return MotionPoint{from + 0.5 * rise * (1 - c), 0.5 * rise * turn * s, 0.5 * rise * turn * turn * c};
  };
}

Motion gust_motion(double peak, double start, double duration) {
  require_finite("gust peak", peak);
  require_finite("gust start", start);
  require_positive("gust duration", duration);
  return [=](double t) {
    const double omega = 2 * std::numbers::pi / duration, angle = omega * (t - start);
    if (!(t > start && t < start + duration)) return MotionPoint{};
    const double s = std::sin(angle), c = std::cos(angle);
    return MotionPoint{0.5 * peak * (1 - c), 0.5 * peak * omega * s, 0.5 * peak * omega * omega * c};
  };
}

Motion spline_motion(const std::vector<double>& times, const std::vector<double>& values) {
  std::vector<Eigen::Matrix<double, 1, 1>> points;
  for (double v : values) points.emplace_back(v);
  return [spline = CubicSpline<1>(times, points)](double t) {
    const auto at = spline.at(t);
    return MotionPoint{at.value[0], at.first[0], at.second[0]};
  };
}

Motion speed_motion(const Curve& speed, double value) {
  require_finite("motion value", value);
  std::vector<double> passed{value};
  const std::vector<Curve::Point>& p = speed.points();
  for (std::size_t i = 1; i < p.size(); ++i)
    passed.push_back(passed.back() + 0.5 * (p[i].y + p[i - 1].y) * (p[i].x - p[i - 1].x));
  return [speed, passed](double t) {
    const std::vector<Curve::Point>& points = speed.points();
    std::size_t i = 0;
    while (i + 1 < points.size() && t >= points[i + 1].x) ++i;
    const bool inside = t >= points.front().x && i + 1 < points.size();
    const double since = t - points[i].x, slope = inside ? speed.slope(t) : 0;
    return MotionPoint{passed[i] + points[i].y * since + 0.5 * slope * since * since,
                       points[i].y + slope * since, slope};
  };
}

PoseMotion pose_motion(std::array<Motion, 3> position, std::vector<Turning> turns, const Quat& orientation) {
  require_unit("pose motion orientation", orientation.coeffs());
  for (const Turning& turn : turns) require_unit("pose motion axis", turn.axis);
  return [position = std::move(position), turns = std::move(turns), q0 = orientation.normalized()](double t) {
    PosePoint at;
    for (int i = 0; i < 3; ++i) {
      if (!position[i]) continue;
      const MotionPoint along = position[i](t);
      at.pose.p[i] = along.value, at.velocity.v[i] = along.rate, at.acceleration.v[i] = along.acceleration;
    }
    for (const Turning& turn : turns) {
      if (!turn.angle) continue;
      // The axis u turns with the frame of the turns before it: u̇ = ω × u.
      const MotionPoint angle = turn.angle(t);
      const Vec3 u = at.pose.q * turn.axis;
      at.acceleration.w += angle.acceleration * u + angle.rate * at.velocity.w.cross(u);
      at.velocity.w += angle.rate * u;
      at.pose.q = (at.pose.q * exp_so3(angle.value * turn.axis)).normalized();
    }
    at.pose.q = (at.pose.q * q0).normalized();
    return at;
  };
}

}  // namespace taut
