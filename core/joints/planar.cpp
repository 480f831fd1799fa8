#include "core/joints/planar.h"

#include "core/base/check.h"
#include "core/constraints/parallel_part.h"

namespace taut {

Planar::Planar(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& normal_A, const Vec3& x_A, const Vec3& p_BQ,
               const Vec3& normal_B, const Vec3& x_B)
    : Joint(a, b), p_AP_(p_AP), normal_A_(normal_A), x_A_(x_A), p_BQ_(p_BQ), normal_B_(normal_B), x_B_(x_B) {
  require_all_finite("planar anchor on A", p_AP);
  require_all_finite("planar anchor on B", p_BQ);
  require_unit("planar normal on A", normal_A);
  require_unit("planar normal on B", normal_B);
  require_across("planar x on A", x_A, normal_A);
  require_across("planar x on B", x_B, normal_B);
}

Planar Planar::at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& normal_W,
                  const Vec3& x_W) {
  require_unit("planar normal", normal_W);
  require_across("planar x", x_W, normal_W);
  const Pose &A = world.pose(a), &B = world.pose(b);
  const Quat to_A = A.q.conjugate(), to_B = B.q.conjugate();
  return {a, b, A.local(p_W), to_A * normal_W, to_A * x_W, B.local(p_W), to_B * normal_W, to_B * x_W};
}

void Planar::append_rows(RowSink& rows) const {
  rows.add(row_parts::PointInPlane{p_AP_, normal_A_, p_BQ_});
  rows.add(row_parts::Parallel{x_A_, normal_A_.cross(x_A_), normal_B_});
}

void Planar::append_axes(AxisSink& axes) const {
  axes.add("x", row_parts::Displacement{{p_AP_, x_A_, p_BQ_}});
  axes.add("y", row_parts::Displacement{{p_AP_, normal_A_.cross(x_A_), p_BQ_}});
  axes.add("angle", row_parts::Angle{normal_A_, x_A_, x_B_});
}

}  // namespace taut
