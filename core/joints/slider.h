#pragma once

#include "core/world/world.h"

namespace taut {

/// Slider (prismatic joint): B moves along an axis of A without turning.                (core/joints, Eq. 3)
///   φ = (u·d, v·d, 2 vec q_FG) ∈ ℝ⁵, with d = p_WQ − p_WP and u, v two normals of the axis, fixed in A.
/// λ₁, λ₂ are the forces on B at Q along u and v; λ₃₋₅ the torque on B in the axes of A's joint frame F.
/// Free axis `displacement` [m]: a·d, 0 where P and Q coincide, as at() makes them.
class Slider final : public Joint {
 public:
  /// Points from the centres of mass, unit axis in A, q_AB the orientation of B in A that is kept.
  /// @throws std::invalid_argument if a point is not finite, the axis or q_AB not of unit length.
  Slider(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& p_BQ, const Quat& q_AB);
  /// The joint along the world line through p_W in the bodies' present poses.
  static Slider at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W);

  std::string_view type() const override { return "slider"; }
  void append_rows(RowSink& rows) const override;
  void append_axes(AxisSink& axes) const override;
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, axis_A_, p_BQ_;
  Quat q_AB_;
};

}  // namespace taut
