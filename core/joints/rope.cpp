#include "core/joints/rope.h"

#include "core/base/check.h"

namespace taut {

Rope::Rope(const std::vector<WirePoint>& points, double length, double restitution)
    : Joint(detail::wire_bodies("rope", points)),
      points_(points),
      way_(detail::wire_length("rope", points, std::vector<double>(points.size(), 1), bodies())),
      limits_{-kUnlimited, length, restitution} {
  require_positive("rope length", length);
  check_axis("rope length", limits_);
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
}

}  // namespace taut
