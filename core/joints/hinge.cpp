#include "core/joints/hinge.h"

#include "core/base/check.h"
#include "core/constraints/parallel_part.h"

namespace taut {

Hinge::Hinge(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ, const Vec3& axis_B)
    : Joint(a, b), p_AP_(p_AP), axis_A_(axis_A), p_BQ_(p_BQ), axis_B_(axis_B) {
  require_all_finite("hinge anchor on A", p_AP);
  require_all_finite("hinge anchor on B", p_BQ);
  require_unit("hinge axis on A", axis_A);
  require_unit("hinge axis on B", axis_B);
  Vec3 unused;
  complete_frame(axis_A, reference_A_, unused);
  complete_frame(axis_B, reference_B_, unused);
}

Hinge::Hinge(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& reference_A,
             const Vec3& p_BQ, const Vec3& axis_B, const Vec3& reference_B)
    : Hinge(a, b, p_AP, axis_A, p_BQ, axis_B) {
  require_across("hinge reference on A", reference_A, axis_A);
  require_across("hinge reference on B", reference_B, axis_B);
  reference_A_ = reference_A;
  reference_B_ = reference_B;
}

Hinge Hinge::at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W) {
  require_unit("hinge axis", axis_W);
  const Pose &A = world.pose(a), &B = world.pose(b);
  return Hinge(a, b, A.local(p_W), A.q.conjugate() * axis_W, B.local(p_W), B.q.conjugate() * axis_W)
      .zeroed(A, B);
}

Hinge Hinge::zeroed(const Pose& A, const Pose& B) const {
  Hinge joint = *this;
  joint.reference_B_ = across(B.q.conjugate() * (A.q * reference_A_), axis_B_);
  return joint;
}

void Hinge::append_rows(RowSink& rows) const {
  Vec3 u, v;
  complete_frame(axis_A_, u, v);
  rows.add(row_parts::Point{p_AP_, p_BQ_});
  rows.add(row_parts::Parallel{u, v, axis_B_});
}

void Hinge::append_axes(AxisSink& axes) const {
  axes.add("angle", row_parts::Angle{axis_A_, reference_A_, reference_B_});
}

}  // namespace taut
