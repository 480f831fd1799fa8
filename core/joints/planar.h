#pragma once

#include "core/world/world.h"

namespace taut {

/// Planar joint: B slides on a plane of A and turns about its normal.                (core/joints, Eq. 9)
///   φ = (n·d, u·b, v·b) ∈ ℝ³ [m, rad, rad], with d = p_WQ − p_WP, u, v, n an orthonormal frame of A and b
///   the normal fixed in B.
/// Where n and b point more than a right angle apart, φ₂,₃ is their angle: opposite normals are open by π.
/// λ₁ is the force on B at Q along n; λ₂, λ₃ the torques that keep the normals together.
/// Free axes `x` = u·d, `y` = v·d [m] and `angle` [rad] about n from u to the direction of B that is along u
/// in the pose where at() made the joint; all three are 0 there.
class Planar final : public Joint {
 public:
  /// Points from the centres of mass, in body axes; normal and x direction of either body.
  /// @throws std::invalid_argument if a point is not finite, a normal not of unit length, or an x direction
  /// no unit vector across its normal.
  Planar(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& normal_A, const Vec3& x_A, const Vec3& p_BQ,
         const Vec3& normal_B, const Vec3& x_B);
  /// The joint in the world plane through p_W in the bodies' present poses.
  static Planar at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& normal_W,
                   const Vec3& x_W);

  std::string_view type() const override { return "planar"; }
  void append_rows(RowSink& rows) const override;
  void append_axes(AxisSink& axes) const override;
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, normal_A_, x_A_, p_BQ_, normal_B_, x_B_;
};

}  // namespace taut
