#include "core/joints/pulley.h"

#include "core/base/check.h"

namespace taut {

Pulley::Pulley(WirePoint a, WirePoint c1, WirePoint c2, WirePoint b, double length, double ratio)
    : Joint(detail::wire_bodies("pulley", {a, c1, c2, b})), points_{a, c1, c2, b} {
  require_positive("pulley length", length);
  require_positive("pulley ratio", ratio);
  if (c1.body != c2.body) fail("pulley", "both sheaves must belong to one body", c2.body.index);
  if (a.body == b.body) fail("pulley", "must join two bodies", a.body.index);
  if (a.body == c1.body || b.body == c1.body)
    fail("pulley", "the sheaves must belong to a third body", c1.body.index);
  way_ = detail::wire_length("pulley", {a, c1, c2, b}, {1, 0, ratio}, bodies());
  way_.offset = length;
}

Pulley Pulley::at(const World& world, BodyId a, const Vec3& p_a_W, BodyId c, const Vec3& p_c1_W,
                  const Vec3& p_c2_W, BodyId b, const Vec3& p_b_W, double ratio) {
  const Pose& C = world.pose(c);
  return {{a, world.pose(a).local(p_a_W)},
          {c, C.local(p_c1_W)},
          {c, C.local(p_c2_W)},
          {b, world.pose(b).local(p_b_W)},
          (p_c1_W - p_a_W).norm() + ratio * (p_b_W - p_c2_W).norm(),
          ratio};
}

void Pulley::append_rows(RowSink& rows) const { rows.add(way_); }

Vec3 Pulley::reaction_point_B() const { return points_.back().p_BP; }

}  // namespace taut
