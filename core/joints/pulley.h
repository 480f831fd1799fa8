#pragma once

#include "core/joints/wire.h"

namespace taut {

/// Pulley: a wire from A over points of a third body to B keeps its length.            (core/joints, Eq. 20)
///   φ = |p_C1 − p_A| + ratio |p_B − p_C2| − L [m]
/// With a ratio n the side of B counts n times, as in a tackle with n strands: its force is n times that of
/// A. −λ [N] is the tension on the side of A.  The wire can push; a rope over points cannot.
class Pulley final : public Joint {
 public:
  /// Points from the centres of mass, in body axes; C1 and C2 are where the wire leaves the sheaves.
  /// @throws std::invalid_argument if a point is not finite, or length or ratio are not positive.
  Pulley(WirePoint a, WirePoint c1, WirePoint c2, WirePoint b, double length, double ratio = 1)
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
  /// The wire through four world points in the bodies' present poses, with the length that it has there.
  static Pulley at(const World& world, BodyId a, const Vec3& p_a_W, BodyId c, const Vec3& p_c1_W,
                   const Vec3& p_c2_W, BodyId b, const Vec3& p_b_W, double ratio = 1) {
    const Pose& C = world.pose(c);
    return {{a, world.pose(a).local(p_a_W)},
            {c, C.local(p_c1_W)},
            {c, C.local(p_c2_W)},
            {b, world.pose(b).local(p_b_W)},
            (p_c1_W - p_a_W).norm() + ratio * (p_b_W - p_c2_W).norm(),
            ratio};
  }

  std::string_view type() const override { return "pulley"; }
  void append_rows(RowSink& rows) const override { rows.add(way_); }
  Vec3 reaction_point_B() const override { return points_.back().p_BP; }
  std::vector<WirePoint> course() const override { return points_; }

 private:
  std::vector<WirePoint> points_;
  row_parts::Coupling way_;
};

}  // namespace taut
