#include "core/joints/point_on_line.h"

#include "core/base/check.h"

namespace taut {

PointOnLine::PointOnLine(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ)
    : Joint(a, b), p_AP_(p_AP), axis_A_(axis_A), p_BQ_(p_BQ) {
  require_all_finite("point-on-line anchor on A", p_AP);
  require_all_finite("point-on-line anchor on B", p_BQ);
  require_unit("point-on-line axis on A", axis_A);
}

PointOnLine PointOnLine::at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W) {
  require_unit("point-on-line axis", axis_W);
  return {a, b, world.pose(a).local(p_W), world.pose(a).q.conjugate() * axis_W, world.pose(b).local(p_W)};
}

void PointOnLine::append_rows(RowSink& rows) const {
  Vec3 u, v;
  complete_frame(axis_A_, u, v);
  rows.add(row_parts::PointInPlane{p_AP_, u, p_BQ_});
  rows.add(row_parts::PointInPlane{p_AP_, v, p_BQ_});
}

void PointOnLine::append_axes(AxisSink& axes) const {
  axes.add("displacement", row_parts::Displacement{{p_AP_, axis_A_, p_BQ_}});
}

}  // namespace taut
