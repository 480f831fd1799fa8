#pragma once

#include "core/world/world.h"

namespace taut {

/// Fixed joint (weld): B keeps its pose relative to A.                                 (core/joints, Eq. 4)
///   φ = (p_WQ − p_WP, 2 vec q_FG) ∈ ℝ⁶ [m, m, m, rad, rad, rad].
/// λ₁₋₃ is the force on B at Q in world axes; λ₄₋₆ the torque on B in the axes of A's joint frame F.
class Fixed final : public Joint {
 public:
  /// Points from the centres of mass; q_AB the orientation of B in A that is kept.
  /// @throws std::invalid_argument if a point is not finite or q_AB not of unit length.
  Fixed(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ, const Quat& q_AB);
  /// The joint at world point p_W that keeps the bodies' present poses.
  static Fixed at(const World& world, BodyId a, BodyId b, const Vec3& p_W);

  std::string_view type() const override { return "fixed"; }
  void append_rows(RowSink& rows) const override;
  Vec3 reaction_point_B() const override { return p_BQ_; }
  std::optional<Pose> rigid_pose() const override;

 private:
  Vec3 p_AP_, p_BQ_;
  Quat q_AB_;
};

}  // namespace taut
