#pragma once

#include "core/world/world.h"

namespace taut {

/// Screw (helical joint): B turns about an axis of A and moves along it by `pitch` per turn.
///   φ = (u·d, v·d, u·b, v·b, a·d − pitch θ/2π) ∈ ℝ⁵ [m, m, rad, rad, m]               (core/joints, Eq. 8)
/// The first four rows are those of Cylindrical; λ₅ is the force of the thread along a on B, with the torque
/// −λ₅ pitch/2π about a.  The last row is known up to multiples of the pitch; the one next to 0 is meant.
/// Free axis `angle` [rad] about a, 0 in the pose where at() made the joint, where the displacement is 0 too.
class Screw final : public Joint {
 public:
  /// Points from the centres of mass and unit axes, in body axes; pitch in m per turn, negative for a
  /// left-handed thread.  The angle is 0 where reference_A of A and reference_B of B point the same way.
  /// @throws std::invalid_argument if a point is not finite, an axis not of unit length, a reference no unit
  /// vector across its axis, or the pitch not finite or 0.
  Screw(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& axis_A, const Vec3& reference_A, const Vec3& p_BQ,
        const Vec3& axis_B, const Vec3& reference_B, double pitch);
  /// The joint along the world line through p_W in the bodies' present poses.
  static Screw at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& axis_W, double pitch);

  std::string_view type() const override { return "screw"; }
  void append_rows(RowSink& rows) const override;
  void append_axes(AxisSink& axes) const override;
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  row_parts::Angle angle() const;

  Vec3 p_AP_, axis_A_, reference_A_, p_BQ_, axis_B_, reference_B_;
  double pitch_;
};

}  // namespace taut
