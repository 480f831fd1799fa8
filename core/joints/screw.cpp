#include "core/joints/screw.h"

#include "core/base/check.h"
#include "core/constraints/parallel_part.h"

namespace taut {

Screw::Screw(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& reference_A,
             const Vec3& p_BQ, const Vec3& axis_B, const Vec3& reference_B, double pitch)
    : Joint(a, b),
      p_AP_(p_AP),
      axis_A_(axis_A),
      reference_A_(reference_A),
      p_BQ_(p_BQ),
      axis_B_(axis_B),
      reference_B_(reference_B),
      pitch_(pitch) {
  require_all_finite("screw anchor on A", p_AP);
  require_all_finite("screw anchor on B", p_BQ);
  require_unit("screw axis on A", axis_A);
  require_unit("screw axis on B", axis_B);
  require_across("screw reference on A", reference_A, axis_A);
  require_across("screw reference on B", reference_B, axis_B);
  require_finite("screw pitch", pitch);
  if (pitch == 0) fail("screw pitch", "must not be 0", pitch);
}

Screw Screw::at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W, double pitch) {
  require_unit("screw axis", axis_W);
  const Pose &A = world.pose(a), &B = world.pose(b);
  const Vec3 axis_A = A.q.conjugate() * axis_W;
  Vec3 u, v;
  complete_frame(axis_A, u, v);
  return {
      a,    b, A.local(p_W), axis_A, u, B.local(p_W), B.q.conjugate() * axis_W, B.q.conjugate() * (A.q * u),
      pitch};
}

void Screw::append_rows(RowSink& rows) const {
  Vec3 u, v;
  complete_frame(axis_A_, u, v);
  rows.add(row_parts::PointInPlane{p_AP_, u, p_BQ_});
  rows.add(row_parts::PointInPlane{p_AP_, v, p_BQ_});
  rows.add(row_parts::Parallel{u, v, axis_B_});
  rows.add(row_parts::Screw{{{p_AP_, axis_A_, p_BQ_}}, angle(), pitch_});
}

void Screw::append_axes(AxisSink& axes) const { axes.add("angle", angle()); }

row_parts::Angle Screw::angle() const { return {axis_A_, reference_A_, reference_B_}; }

}  // namespace taut
