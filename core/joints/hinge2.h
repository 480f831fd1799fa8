#pragma once

#include "core/world/world.h"

namespace taut {

/// Hinge-2 (car wheel): A is the chassis, B the wheel.  The wheel's centre moves along the steering axis a of
/// A, the wheel is steered about a and spins about its own axis b ⟂ a.                 (core/joints, Eq. 11)
///   φ = (u·d, v·d, a·b) ∈ ℝ³ [m, m, rad], with d = p_WQ − p_WP and u, v, a an orthonormal frame of A.
/// λ₁, λ₂ are the forces on B at Q along u and v; λ₃ the torque on B about b × a (camber).
/// Free axes `travel` a·d [m], `steering` [rad] about a and `spin` [rad] of the wheel about b against the
/// steered knuckle; all are 0 in the pose where at() made the joint, and otherwise the angles as for
/// Universal.
class Hinge2 final : public Joint {
 public:
  /// Points from the centres of mass and unit axes, in body axes.
  /// @throws std::invalid_argument if a point is not finite or an axis not of unit length.
  Hinge2(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& steering_A, const Vec3& p_BQ, const Vec3& spin_B);
  /// The joint with the wheel's centre at p_W in the bodies' present poses.
  /// @throws std::invalid_argument also if the axes are not perpendicular (to 1e-9).
  static Hinge2 at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& steering_W,
                   const Vec3& spin_W);
  /// A copy of this joint whose angles are 0 in these poses of A and B.
  Hinge2 zeroed(const Pose& A, const Pose& B) const;

  std::string_view type() const override { return "hinge2"; }
  void append_rows(RowSink& rows) const override;
  void append_axes(AxisSink& axes) const override;
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, steering_A_, p_BQ_, spin_B_;
  Vec3 reference_A_, reference_B_;  // across the axes, where the angles are 0
};

}  // namespace taut
