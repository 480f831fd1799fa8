#pragma once

#include "core/joints/axis_coupling.h"

namespace taut {

/// Driver: a free axis has a prescribed value, θ = f(t).                              (core/joints, Eq. 18)
///   φ = θ − f(t),   φ̇ = θ̇ − ḟ
/// λ is the torque or force on the axis.  A prescribed velocity is speed_motion() or linear_motion().
class Driver final : public AxisCoupling {
 public:
  /// @throws std::invalid_argument if the axis is missing or the motion cannot be called.
  Driver(const World& world, AxisId axis, Motion motion);
  std::string_view type() const override { return "driver"; }
  void append_rows(RowSink& rows) const override;

 private:
  row_parts::DrivenCoupling driven_;
};

/// Pose driver: B has a prescribed pose relative to A.                                (core/joints, Eq. 19)
///   φ = (p_AB − p*(t), 2 vec(q*(t)⁻¹ q_AB)) ∈ ℝ⁶ [m, m, m, rad, rad, rad]
/// λ₁₋₃ is the force on B at its centre in axes of A; λ₄₋₆ the torque on B in axes of the target.
class PoseDriver final : public Joint {
 public:
  /// @throws std::invalid_argument if the motion cannot be called.
  PoseDriver(BodyId a, BodyId b, PoseMotion motion);
  std::string_view type() const override { return "pose_driver"; }
  void append_rows(RowSink& rows) const override;
  Vec3 reaction_point_B() const override;

 private:
  PoseMotion motion_;
};

}  // namespace taut
