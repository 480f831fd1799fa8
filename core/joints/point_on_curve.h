#pragma once

#include "core/constraints/curve_part.h"
#include "core/world/world.h"

namespace taut {

/// Point on curve: point Q of B stays on a twice continuously differentiable spline fixed in A, free to turn.
///   φ = (n₁·e, n₂·e) ∈ ℝ² [m, m], e from the nearest place of the curve to Q
/// (core/joints, Eq. 13)
/// λ [N] are the forces on B at Q along the normals n₁, n₂ of the curve; A receives the opposite there.
/// Free axis `parameter`: where Q is on the curve; rounds of a closed curve are counted.  An open curve goes
/// on straight beyond its ends.  The curve must keep clear of itself: the nearest place counts.
class PointOnCurve final : public Joint {
 public:
  /// Spline through points of A; p_BQ from the centre of mass, in body axes.
  /// @throws std::invalid_argument if the point is not finite or the curve stands still somewhere.
  PointOnCurve(BodyId a, BodyId b, CubicSpline<3> curve_A, const Vec3& p_BQ);
  /// The curve through world points in the present pose of A; their distances are the steps of the parameter.
  /// A closed curve must end with its first point.
  /// @throws std::invalid_argument also as CubicSpline.
  static PointOnCurve through(const World& world, BodyId a, BodyId b, const std::vector<Vec3>& points_W,
                              const Vec3& p_b_W, bool closed = false);

  std::string_view type() const override { return "point_on_curve"; }
  void append_rows(RowSink& rows) const override;
  void append_axes(AxisSink& axes) const override;
  Vec3 reaction_point_B() const override { return p_BQ_; }
  const BodyCurve& curve() const { return *curve_; }  ///< fixed in A

 private:
  std::shared_ptr<const BodyCurve> curve_;
  Vec3 p_BQ_;
};

}  // namespace taut
