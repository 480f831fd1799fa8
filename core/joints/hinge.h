#pragma once

#include "core/base/check.h"
#include "core/constraints/parallel_part.h"
#include "core/world/world.h"

namespace taut {

/// Hinge: point P of A stays on point Q of B and axis a of A along axis b of B.         (core/joints, Eq. 2)
///   φ = (p_WQ − p_WP, u·b, v·b) ∈ ℝ⁵, with u, v, a an orthonormal frame of A [m, m, m, rad, rad].
/// Where a and b point more than a right angle apart, φ₄,₅ is their angle: opposite axes are open by π.
/// λ₁₋₃ is the force on B at Q in world axes; λ₄, λ₅ the torques that keep the axes together.
/// Free axis `angle` [rad]: turn of B against A about a, 0 in the pose where at() made the joint; without
/// references, where the frames that complete_frame() makes of the two axes agree. (core/constraints, Eq. 9)
class Hinge final : public Joint {
 public:
  /// Points from the centres of mass and unit axes, in body axes.
  /// @throws std::invalid_argument if a point is not finite or an axis not of unit length.
  Hinge(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ, const Vec3& axis_B)
      : Joint(a, b), p_AP_(p_AP), axis_A_(axis_A), p_BQ_(p_BQ), axis_B_(axis_B) {
    require_all_finite("hinge anchor on A", p_AP);
    require_all_finite("hinge anchor on B", p_BQ);
    require_unit("hinge axis on A", axis_A);
    require_unit("hinge axis on B", axis_B);
    Vec3 unused;
    complete_frame(axis_A, reference_A_, unused);
    complete_frame(axis_B, reference_B_, unused);
  }
  /// The angle is 0 where reference_A of A and reference_B of B point the same way.
  /// @throws std::invalid_argument also if a reference is not a unit vector across its axis (to 1e-9).
  Hinge(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& reference_A, const Vec3& p_BQ,
        const Vec3& axis_B, const Vec3& reference_B)
      : Hinge(a, b, p_AP, axis_A, p_BQ, axis_B) {
    require_across("hinge reference on A", reference_A, axis_A);
    require_across("hinge reference on B", reference_B, axis_B);
    reference_A_ = reference_A;
    reference_B_ = reference_B;
  }
  /// The joint about the world line through p_W along axis_W in the bodies' present poses.
  static Hinge at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W) {
    require_unit("hinge axis", axis_W);
    const Pose &A = world.pose(a), &B = world.pose(b);
    return Hinge(a, b, A.local(p_W), A.q.conjugate() * axis_W, B.local(p_W), B.q.conjugate() * axis_W)
        .zeroed(A, B);
  }
  /// A copy of this joint whose angle is 0 in these poses of A and B.
  Hinge zeroed(const Pose& A, const Pose& B) const {
    Hinge joint = *this;
    joint.reference_B_ = across(B.q.conjugate() * (A.q * reference_A_), axis_B_);
    return joint;
  }

  std::string_view type() const override { return "hinge"; }
  void append_rows(RowSink& rows) const override {
    Vec3 u, v;
    complete_frame(axis_A_, u, v);
    rows.add(row_parts::Point{p_AP_, p_BQ_});
    rows.add(row_parts::Parallel{u, v, axis_B_});
  }
  void append_axes(AxisSink& axes) const override {
    axes.add("angle", row_parts::Angle{axis_A_, reference_A_, reference_B_});
  }
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, axis_A_, p_BQ_, axis_B_;
  Vec3 reference_A_, reference_B_;
};

}  // namespace taut
