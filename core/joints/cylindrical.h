#pragma once

#include "core/base/check.h"
#include "core/constraints/parallel_part.h"
#include "core/world/world.h"

namespace taut {

/// Cylindrical joint: B turns about an axis of A and slides along it.               (core/joints, Eq. 7)
///   φ = (u·d, v·d, u·b, v·b) ∈ ℝ⁴ [m, m, rad, rad], with d = p_WQ − p_WP and u, v, a an orthonormal frame
///   of A.
/// Where a and b point more than a right angle apart, φ₃,₄ is their angle: opposite axes are open by π.
/// λ₁, λ₂ are the forces on B at Q along u and v; λ₃, λ₄ the torques that keep the axes together.
/// Free axes `angle` [rad] about a and `displacement` a·d [m], both 0 in the pose where at() made the joint;
/// from the constructor the angle is 0 as for Hinge.
class Cylindrical final : public Joint {
 public:
  /// Points from the centres of mass and unit axes, in body axes.
  /// @throws std::invalid_argument if a point is not finite or an axis not of unit length.
  Cylindrical(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ, const Vec3& axis_B)
      : Joint(a, b), p_AP_(p_AP), axis_A_(axis_A), p_BQ_(p_BQ), axis_B_(axis_B) {
    require_all_finite("cylindrical anchor on A", p_AP);
    require_all_finite("cylindrical anchor on B", p_BQ);
    require_unit("cylindrical axis on A", axis_A);
    require_unit("cylindrical axis on B", axis_B);
    Vec3 unused;
    complete_frame(axis_A, reference_A_, unused);
    complete_frame(axis_B, reference_B_, unused);
  }
  /// The joint along the world line through p_W in the bodies' present poses.
  static Cylindrical at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W) {
    require_unit("cylindrical axis", axis_W);
    const Pose &A = world.pose(a), &B = world.pose(b);
    return Cylindrical(a, b, A.local(p_W), A.q.conjugate() * axis_W, B.local(p_W), B.q.conjugate() * axis_W)
        .zeroed(A, B);
  }
  /// A copy of this joint whose angle is 0 in these poses of A and B.
  Cylindrical zeroed(const Pose& A, const Pose& B) const {
    Cylindrical joint = *this;
    joint.reference_B_ = across(B.q.conjugate() * (A.q * reference_A_), axis_B_);
    return joint;
  }

  std::string_view type() const override { return "cylindrical"; }
  void append_rows(RowSink& rows) const override {
    Vec3 u, v;
    complete_frame(axis_A_, u, v);
    rows.add(row_parts::PointInPlane{p_AP_, u, p_BQ_});
    rows.add(row_parts::PointInPlane{p_AP_, v, p_BQ_});
    rows.add(row_parts::Parallel{u, v, axis_B_});
  }
  void append_axes(AxisSink& axes) const override {
    axes.add("angle", row_parts::Angle{axis_A_, reference_A_, reference_B_});
    axes.add("displacement", row_parts::Displacement{{p_AP_, axis_A_, p_BQ_}});
  }
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, axis_A_, p_BQ_, axis_B_;
  Vec3 reference_A_, reference_B_;
};

}  // namespace taut
