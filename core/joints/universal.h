#pragma once

#include "core/world/world.h"

namespace taut {

/// Universal joint (cross, Cardan): point P of A stays on point Q of B, and axis a of A perpendicular to axis
/// b of B.
///   φ = (p_WQ − p_WP, a·b) ∈ ℝ⁴ [m, m, m, rad].                                        (core/joints, Eq. 5)
/// λ₁₋₃ is the force on B at Q in world axes; λ₄ the torque on B about b × a.
/// Free axes `angle_1` [rad]: turn of the cross against A about a, and `angle_2`: turn of B against the cross
/// about b.  Both are 0 in the pose where at() made the joint; otherwise angle_1 where b points along the
/// first vector that complete_frame() gives to a, and angle_2 where a does so for b.  (core/joints, Eq. 22)
/// `swing` [rad] is the angle by which the joint bends, between the directions of A and B that are a × b
/// where both angles are 0: cos swing = cos angle_1 cos angle_2.  A limit of it is a cone.  `swing_1`,
/// `swing_2` [rad] are its components as a rotation vector, along the arm of A and that of B where both are
/// 0: swing² = swing_1² + swing_2².  A spring of `swing` with rest 0 acts along these.
class Universal final : public Joint {
 public:
  /// Points from the centres of mass and unit axes of the cross, in body axes.
  /// @throws std::invalid_argument if a point is not finite or an axis not of unit length.
  Universal(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ, const Vec3& axis_B);
  /// The joint at world point p_W with cross arms along the world axes axis_a_W (in A) and axis_b_W (in B).
  /// @throws std::invalid_argument also if the arms are not perpendicular (to 1e-9).
  static Universal at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_a_W,
                      const Vec3& axis_b_W);
  /// A copy of this joint whose angles are 0 in these poses of A and B.
  Universal zeroed(const Pose& A, const Pose& B) const;

  std::string_view type() const override { return "universal"; }
  void append_rows(RowSink& rows) const override;
  void append_axes(AxisSink& axes) const override;
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, axis_A_, p_BQ_, axis_B_;
  Vec3 reference_A_, reference_B_;  // across the axes, where the angles are 0
};

}  // namespace taut
