#include "core/joints/universal.h"

#include "core/base/check.h"
#include "core/constraints/ball_parts.h"

namespace taut {

Universal::Universal(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ,
                     const Vec3& axis_B)
    : Joint(a, b), p_AP_(p_AP), axis_A_(axis_A), p_BQ_(p_BQ), axis_B_(axis_B) {
  require_all_finite("universal anchor on A", p_AP);
  require_all_finite("universal anchor on B", p_BQ);
  require_unit("universal axis on A", axis_A);
  require_unit("universal axis on B", axis_B);
  Vec3 unused;
  complete_frame(axis_A, reference_A_, unused);
  complete_frame(axis_B, reference_B_, unused);
}

Universal Universal::at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_a_W,
                        const Vec3& axis_b_W) {
  require_unit("universal axis on A", axis_a_W);
  require_unit("universal axis on B", axis_b_W);
  if (std::abs(axis_a_W.dot(axis_b_W)) > kUnitTolerance)
    fail("universal axes", "must be perpendicular (cosine)", axis_a_W.dot(axis_b_W));
  const Pose &A = world.pose(a), &B = world.pose(b);
  return Universal(a, b, A.local(p_W), A.q.conjugate() * axis_a_W, B.local(p_W), B.q.conjugate() * axis_b_W)
      .zeroed(A, B);
}

Universal Universal::zeroed(const Pose& A, const Pose& B) const {
  Universal joint = *this;
  joint.reference_A_ = across(A.q.conjugate() * (B.q * axis_B_), axis_A_);
  joint.reference_B_ = across(B.q.conjugate() * (A.q * axis_A_), axis_B_);
  return joint;
}

void Universal::append_rows(RowSink& rows) const {
  rows.add(row_parts::Point{p_AP_, p_BQ_});
  rows.add(row_parts::Perpendicular{axis_A_, axis_B_});
}

void Universal::append_axes(AxisSink& axes) const {
  axes.add("angle_1", row_parts::Angle{axis_A_, reference_A_, axis_B_});
  // Seen from B, the arm of A turns the other way.
  axes.add("angle_2", row_parts::Angle{-axis_B_, reference_B_, axis_A_}, {1, 0});
  const Vec3 a_A = axis_A_.cross(reference_A_), b_B = reference_B_.cross(axis_B_);
  axes.add("swing", row_parts::Swing{a_A, b_B, {.turns = {0, 1}, .components = {3, 4}}});
  axes.add("swing_1", row_parts::SwingComponent{a_A, b_B, axis_A_});
  axes.add("swing_2", row_parts::SwingComponent{a_A, b_B, reference_A_});
}

}  // namespace taut
