#include "core/joints/rope.h"

#include <algorithm>
#include <string>

#include "core/base/check.h"

namespace taut {
namespace {

/// A section as short as the stop has a direction, which one of no length has not.
constexpr double kStop = 0.01, kStopPart = 0.01;  // [m], and as a part of the length

}  // namespace

Rope::Rope(const std::vector<WirePoint>& points, double length, double restitution,
           std::optional<double> stop)
    : Joint(detail::wire_bodies("rope", points)),
      points_(points),
      way_(detail::wire_length("rope", points, std::vector<double>(points.size(), 1), bodies())),
      limits_{-kUnlimited, length, restitution} {
  require_positive("rope length", length);
  check_axis("rope length", limits_);
  if (stop) require_not_negative("rope stop", *stop);
  if (points.size() > 2) stop_ = stop.value_or(std::min(kStop, kStopPart * length));
  for (const WirePoint& p : points)
    if (p.body == b()) point_B_ = p.p_BP;
}

Rope::Rope(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ, double length, double restitution)
    : Rope({{a, p_AP}, {b, p_BQ}}, length, restitution) {}

Rope Rope::between(const World& world, BodyId a, BodyId b, const Vec3& p_a_W, const Vec3& p_b_W) {
  return {a, b, world.pose(a).local(p_a_W), world.pose(b).local(p_b_W), (p_b_W - p_a_W).norm()};
}

void Rope::append_axes(AxisSink& axes) const {
  axes.add("length", way_);
  axes.limit(limits_);
  axes.wind();
  if (stop_ == 0) return;
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    if (points_[i].body == points_[i + 1].body) continue;
    axes.add("span_" + std::to_string(i + 1),
             detail::wire_length("rope", {points_[i], points_[i + 1]}, {1}, bodies()));
    axes.limit({.lower = stop_});
  }
}

}  // namespace taut
