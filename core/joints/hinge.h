#pragma once

#include "core/world/world.h"

namespace taut {

/// Hinge: point P of A stays on point Q of B and axis a of A along axis b of B.         (core/joints, Eq. 2)
///   φ = (p_WQ − p_WP, u·b, v·b) ∈ ℝ⁵, with u, v, a an orthonormal frame of A [m, m, m, rad, rad].
/// Where a and b point more than a right angle apart, φ₄,₅ is their angle: opposite axes are open by π.
/// λ₁₋₃ is the force on B at Q in world axes; λ₄, λ₅ the torques that keep the axes together.
/// Free axis `angle` [rad]: turn of B against A about a, 0 in the pose where at() made the joint; without
/// references, where the frames that complete_frame() makes of the two axes agree. (core/constraints, Eq. 10)
class Hinge final : public Joint {
 public:
  /// Points from the centres of mass and unit axes, in body axes.
  /// @throws std::invalid_argument if a point is not finite or an axis not of unit length.
  Hinge(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ, const Vec3& axis_B);
  /// The angle is 0 where reference_A of A and reference_B of B point the same way.
  /// @throws std::invalid_argument also if a reference is not a unit vector across its axis (to 1e-9).
  Hinge(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& reference_A, const Vec3& p_BQ,
        const Vec3& axis_B, const Vec3& reference_B);
  /// The joint about the world line through p_W along axis_W in the bodies' present poses.
  static Hinge at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W);
  /// A copy of this joint whose angle is 0 in these poses of A and B.
  Hinge zeroed(const Pose& A, const Pose& B) const;

  std::string_view type() const override { return "hinge"; }
  void append_rows(RowSink& rows) const override;
  void append_axes(AxisSink& axes) const override;
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, axis_A_, p_BQ_, axis_B_;
  Vec3 reference_A_, reference_B_;
};

}  // namespace taut
