#pragma once

#include "core/base/check.h"
#include "core/constraints/ball_parts.h"
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
  Universal(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ, const Vec3& axis_B)
      : Joint(a, b), p_AP_(p_AP), axis_A_(axis_A), p_BQ_(p_BQ), axis_B_(axis_B) {
    require_all_finite("universal anchor on A", p_AP);
    require_all_finite("universal anchor on B", p_BQ);
    require_unit("universal axis on A", axis_A);
    require_unit("universal axis on B", axis_B);
    Vec3 unused;
    complete_frame(axis_A, reference_A_, unused);
    complete_frame(axis_B, reference_B_, unused);
  }
  /// The joint at world point p_W with cross arms along the world axes axis_a_W (in A) and axis_b_W (in B).
  /// @throws std::invalid_argument also if the arms are not perpendicular (to 1e-9).
  static Universal at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_a_W,
                      const Vec3& axis_b_W) {
    require_unit("universal axis on A", axis_a_W);
    require_unit("universal axis on B", axis_b_W);
    if (std::abs(axis_a_W.dot(axis_b_W)) > kUnitTolerance)
      fail("universal axes", "must be perpendicular (cosine)", axis_a_W.dot(axis_b_W));
    const Pose &A = world.pose(a), &B = world.pose(b);
    return Universal(a, b, A.local(p_W), A.q.conjugate() * axis_a_W, B.local(p_W), B.q.conjugate() * axis_b_W)
        .zeroed(A, B);
  }
  /// A copy of this joint whose angles are 0 in these poses of A and B.
  Universal zeroed(const Pose& A, const Pose& B) const {
    Universal joint = *this;
    joint.reference_A_ = across(A.q.conjugate() * (B.q * axis_B_), axis_A_);
    joint.reference_B_ = across(B.q.conjugate() * (A.q * axis_A_), axis_B_);
    return joint;
  }

  std::string_view type() const override { return "universal"; }
  void append_rows(RowSink& rows) const override {
    rows.add(row_parts::Point{p_AP_, p_BQ_});
    rows.add(row_parts::Perpendicular{axis_A_, axis_B_});
  }
  void append_axes(AxisSink& axes) const override {
    axes.add("angle_1", row_parts::Angle{axis_A_, reference_A_, axis_B_});
    // Seen from B, the arm of A turns the other way.
    axes.add("angle_2", row_parts::Angle{-axis_B_, reference_B_, axis_A_}, {1, 0});
    const Vec3 a_A = axis_A_.cross(reference_A_), b_B = reference_B_.cross(axis_B_);
    axes.add("swing", row_parts::Swing{a_A, b_B, {.turns = {0, 1}, .components = {3, 4}}});
    axes.add("swing_1", row_parts::SwingComponent{a_A, b_B, axis_A_});
    axes.add("swing_2", row_parts::SwingComponent{a_A, b_B, reference_A_});
  }
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, axis_A_, p_BQ_, axis_B_;
  Vec3 reference_A_, reference_B_;  // across the axes, where the angles are 0
};

}  // namespace taut
