#pragma once

#include "core/world/world.h"

namespace taut {

/// Point on line: point Q of B stays on the line of A through P along the axis, free to turn.
///   φ = (u·d, v·d) ∈ ℝ² [m, m], d = p_WQ − p_WP and u, v two normals of the axis in A. (core/joints, Eq. 10)
/// λ [N] are the forces on B at Q along u and v; A receives the opposite there.
/// Free axis `displacement` [m]: a·d.
class PointOnLine final : public Joint {
 public:
  /// Points from the centres of mass and a unit axis, in body axes.
  /// @throws std::invalid_argument if a point is not finite or the axis not of unit length.
  PointOnLine(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ);
  /// The joint along the world line through p_W in the bodies' present poses.
  static PointOnLine at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W);

  std::string_view type() const override { return "point_on_line"; }
  void append_rows(RowSink& rows) const override;
  void append_axes(AxisSink& axes) const override;
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, axis_A_, p_BQ_;
};

}  // namespace taut
