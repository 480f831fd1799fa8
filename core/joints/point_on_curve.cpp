#include "core/joints/point_on_curve.h"

#include "core/base/check.h"

namespace taut {

PointOnCurve::PointOnCurve(BodyId a, BodyId b, CubicSpline<3> curve_A, const Vec3& p_BQ)
    : Joint(a, b), curve_(std::make_shared<const BodyCurve>(std::move(curve_A))), p_BQ_(p_BQ) {
  require_all_finite("point-on-curve anchor on B", p_BQ);
}

PointOnCurve PointOnCurve::through(const World& world, BodyId a, BodyId b, const std::vector<Vec3>& points_W,
                                   const Vec3& p_b_W, bool closed) {
  std::vector<double> parameters;
  std::vector<Vec3> points_A;
  for (std::size_t i = 0; i < points_W.size(); ++i) {
    parameters.push_back(i == 0 ? 0 : parameters.back() + (points_W[i] - points_W[i - 1]).norm());
    const bool last = closed && i + 1 == points_W.size() && points_W[i] == points_W[0];
    points_A.push_back(last ? points_A[0] : world.pose(a).local(points_W[i]));
  }
  return {a, b, CubicSpline<3>(parameters, points_A, closed), world.pose(b).local(p_b_W)};
}

void PointOnCurve::append_rows(RowSink& rows) const { rows.add(row_parts::PointOnCurve{curve_, p_BQ_}); }

void PointOnCurve::append_axes(AxisSink& axes) const {
  axes.add("parameter", row_parts::CurveParameter{curve_, p_BQ_});
}

}  // namespace taut
