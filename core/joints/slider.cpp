#include "core/joints/slider.h"

#include "core/base/check.h"

namespace taut {

Slider::Slider(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ, const Quat& q_AB)
    : Joint(a, b), p_AP_(p_AP), axis_A_(axis_A), p_BQ_(p_BQ), q_AB_(q_AB) {
  require_all_finite("slider anchor on A", p_AP);
  require_all_finite("slider anchor on B", p_BQ);
  require_unit("slider axis on A", axis_A);
  require_unit("slider orientation of B in A", q_AB.coeffs());
}

Slider Slider::at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W) {
  require_unit("slider axis", axis_W);
  const Pose &A = world.pose(a), &B = world.pose(b);
  return {a, b, A.local(p_W), A.q.conjugate() * axis_W, B.local(p_W), relative(A.q, B.q)};
}

void Slider::append_rows(RowSink& rows) const {
  Vec3 u, v;
  complete_frame(axis_A_, u, v);
  rows.add(row_parts::PointInPlane{p_AP_, u, p_BQ_});
  rows.add(row_parts::PointInPlane{p_AP_, v, p_BQ_});
  rows.add(row_parts::Orientation{q_AB_, Quat::Identity()});
}

void Slider::append_axes(AxisSink& axes) const {
  axes.add("displacement", row_parts::Displacement{{p_AP_, axis_A_, p_BQ_}});
}

}  // namespace taut
