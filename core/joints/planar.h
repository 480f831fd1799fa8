#pragma once

#include "core/base/check.h"
#include "core/constraints/parallel_part.h"
#include "core/world/world.h"

namespace taut {

/// Planar joint: B slides on a plane of A and turns about its normal.                (core/joints, Eq. 9)
///   φ = (n·d, u·b, v·b) ∈ ℝ³ [m, rad, rad], with d = p_WQ − p_WP, u, v, n an orthonormal frame of A and b
///   the normal fixed in B.
/// Where n and b point more than a right angle apart, φ₂,₃ is their angle: opposite normals are open by π.
/// λ₁ is the force on B at Q along n; λ₂, λ₃ the torques that keep the normals together.
/// Free axes `x` = u·d, `y` = v·d [m] and `angle` [rad] about n from u to the direction of B that is along u
/// in the pose where at() made the joint; all three are 0 there.
class Planar final : public Joint {
 public:
  /// Points from the centres of mass, in body axes; normal and x direction of either body.
  /// @throws std::invalid_argument if a point is not finite, a normal not of unit length, or an x direction
  /// no unit vector across its normal.
  Planar(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& normal_A, const Vec3& x_A, const Vec3& p_BQ,
         const Vec3& normal_B, const Vec3& x_B)
      : Joint(a, b),
        p_AP_(p_AP),
        normal_A_(normal_A),
        x_A_(x_A),
        p_BQ_(p_BQ),
        normal_B_(normal_B),
        x_B_(x_B) {
    require_all_finite("planar anchor on A", p_AP);
    require_all_finite("planar anchor on B", p_BQ);
    require_unit("planar normal on A", normal_A);
    require_unit("planar normal on B", normal_B);
    require_across("planar x on A", x_A, normal_A);
    require_across("planar x on B", x_B, normal_B);
  }
  /// The joint in the world plane through p_W in the bodies' present poses.
  static Planar at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& normal_W,
                   const Vec3& x_W) {
    require_unit("planar normal", normal_W);
    require_across("planar x", x_W, normal_W);
    const Pose &A = world.pose(a), &B = world.pose(b);
    const Quat to_A = A.q.conjugate(), to_B = B.q.conjugate();
    return {a, b, A.local(p_W), to_A * normal_W, to_A * x_W, B.local(p_W), to_B * normal_W, to_B * x_W};
  }

  std::string_view type() const override { return "planar"; }
  void append_rows(RowSink& rows) const override {
    rows.add(row_parts::PointInPlane{p_AP_, normal_A_, p_BQ_});
    rows.add(row_parts::Parallel{x_A_, normal_A_.cross(x_A_), normal_B_});
  }
  void append_axes(AxisSink& axes) const override {
    axes.add("x", row_parts::Displacement{{p_AP_, x_A_, p_BQ_}});
    axes.add("y", row_parts::Displacement{{p_AP_, normal_A_.cross(x_A_), p_BQ_}});
    axes.add("angle", row_parts::Angle{normal_A_, x_A_, x_B_});
  }
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, normal_A_, x_A_, p_BQ_, normal_B_, x_B_;
};

}  // namespace taut
