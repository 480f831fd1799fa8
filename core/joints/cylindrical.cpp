#include "core/joints/cylindrical.h"

#include "core/base/check.h"
#include "core/constraints/parallel_part.h"

namespace taut {

Cylindrical::Cylindrical(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ,
                         const Vec3& axis_B)
    : Joint(a, b), p_AP_(p_AP), axis_A_(axis_A), p_BQ_(p_BQ), axis_B_(axis_B) {
  require_all_finite("cylindrical anchor on A", p_AP);
  require_all_finite("cylindrical anchor on B", p_BQ);
  require_unit("cylindrical axis on A", axis_A);
  require_unit("cylindrical axis on B", axis_B);
  Vec3 unused;
  complete_frame(axis_A, reference_A_, unused);
  complete_frame(axis_B, reference_B_, unused);
}

Cylindrical Cylindrical::at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W) {
  require_unit("cylindrical axis", axis_W);
  const Pose &A = world.pose(a), &B = world.pose(b);
  return Cylindrical(a, b, A.local(p_W), A.q.conjugate() * axis_W, B.local(p_W), B.q.conjugate() * axis_W)
      .zeroed(A, B);
}

Cylindrical Cylindrical::zeroed(const Pose& A, const Pose& B) const {
  Cylindrical joint = *this;
  joint.reference_B_ = across(B.q.conjugate() * (A.q * reference_A_), axis_B_);
  return joint;
}

void Cylindrical::append_rows(RowSink& rows) const {
  Vec3 u, v;
  complete_frame(axis_A_, u, v);
  rows.add(row_parts::PointInPlane{p_AP_, u, p_BQ_});
  rows.add(row_parts::PointInPlane{p_AP_, v, p_BQ_});
  rows.add(row_parts::Parallel{u, v, axis_B_});
}

void Cylindrical::append_axes(AxisSink& axes) const {
  axes.add("angle", row_parts::Angle{axis_A_, reference_A_, reference_B_});
  axes.add("displacement", row_parts::Displacement{{p_AP_, axis_A_, p_BQ_}});
}

}  // namespace taut
