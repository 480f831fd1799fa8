#pragma once

#include "core/base/check.h"
#include "core/constraints/parallel_part.h"
#include "core/world/world.h"

namespace taut {

/// Screw (helical joint): B turns about an axis of A and moves along it by `pitch` per turn.
///   φ = (u·d, v·d, u·b, v·b, a·d − pitch θ/2π) ∈ ℝ⁵ [m, m, rad, rad, m]               (core/joints, Eq. 8)
/// The first four rows are those of Cylindrical; λ₅ is the force of the thread along a on B, with the torque
/// −λ₅ pitch/2π about a.  The last row is known up to multiples of the pitch; the one next to 0 is meant.
/// Free axis `angle` [rad] about a, 0 in the pose where at() made the joint, where the displacement is 0 too.
class Screw final : public Joint {
 public:
  /// Points from the centres of mass and unit axes, in body axes; pitch in m per turn, negative for a
  /// left-handed thread.  The angle is 0 where reference_A of A and reference_B of B point the same way.
  /// @throws std::invalid_argument if a point is not finite, an axis not of unit length, a reference no unit
  /// vector across its axis, or the pitch not finite or 0.
  Screw(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& reference_A, const Vec3& p_BQ,
        const Vec3& axis_B, const Vec3& reference_B, double pitch)
      : Joint(a, b),
        p_AP_(p_AP),
        axis_A_(axis_A),
        reference_A_(reference_A),
        p_BQ_(p_BQ),
        axis_B_(axis_B),
        reference_B_(reference_B),
        pitch_(pitch) {
    require_all_finite("screw anchor on A", p_AP);
    require_all_finite("screw anchor on B", p_BQ);
    require_unit("screw axis on A", axis_A);
    require_unit("screw axis on B", axis_B);
    require_across("screw reference on A", reference_A, axis_A);
    require_across("screw reference on B", reference_B, axis_B);
    require_finite("screw pitch", pitch);
    if (pitch == 0) fail("screw pitch", "must not be 0", pitch);
  }
  /// The joint along the world line through p_W in the bodies' present poses.
  static Screw at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W, double pitch) {
    require_unit("screw axis", axis_W);
    const Pose &A = world.pose(a), &B = world.pose(b);
    const Vec3 axis_A = A.q.conjugate() * axis_W;
    Vec3 u, v;
    complete_frame(axis_A, u, v);
    return {
        a,    b, A.local(p_W), axis_A, u, B.local(p_W), B.q.conjugate() * axis_W, B.q.conjugate() * (A.q * u),
        pitch};
  }

  std::string_view type() const override { return "screw"; }
  void append_rows(RowSink& rows) const override {
    Vec3 u, v;
    complete_frame(axis_A_, u, v);
    rows.add(row_parts::PointInPlane{p_AP_, u, p_BQ_});
    rows.add(row_parts::PointInPlane{p_AP_, v, p_BQ_});
    rows.add(row_parts::Parallel{u, v, axis_B_});
    rows.add(row_parts::Screw{{{p_AP_, axis_A_, p_BQ_}}, angle(), pitch_});
  }
  void append_axes(AxisSink& axes) const override { axes.add("angle", angle()); }
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  row_parts::Angle angle() const { return {axis_A_, reference_A_, reference_B_}; }

  Vec3 p_AP_, axis_A_, reference_A_, p_BQ_, axis_B_, reference_B_;
  double pitch_;
};

}  // namespace taut
