#pragma once

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
  Cylindrical(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ, const Vec3& axis_B);
  /// The joint along the world line through p_W in the bodies' present poses.
  static Cylindrical at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W);
  /// A copy of this joint whose angle is 0 in these poses of A and B.
  Cylindrical zeroed(const Pose& A, const Pose& B) const;

  std::string_view type() const override { return "cylindrical"; }
  void append_rows(RowSink& rows) const override;
  void append_axes(AxisSink& axes) const override;
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, axis_A_, p_BQ_, axis_B_;
  Vec3 reference_A_, reference_B_;
};

}  // namespace taut
