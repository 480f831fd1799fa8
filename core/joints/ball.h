#pragma once

#include <optional>

#include "core/world/world.h"

namespace taut {

/// Ball joint: point P of A stays on point Q of B.  φ = p_WQ − p_WP ∈ ℝ³ [m].            (core/joints, Eq. 1)
/// λ is the force on B at Q in world axes; A receives −λ at P.
/// Free axes only after with_axes(): `swing` [rad], the angle between a direction of A and one of B, from 0;
/// `twist` [rad] about them; `turn_x`, `turn_y`, `turn_z` [rad], turns of B against A about three axes of A,
/// for friction and motors of given velocity; and `swing_x`, `swing_y` [rad], the swing as a rotation vector
/// in axes of A, along which a spring of `swing` with rest 0 acts.  A limit of swing is a cone.
class Ball final : public Joint {
 public:
  /// Points from the centres of mass, in body axes; for the ground, in world axes.
  /// @throws std::invalid_argument if a point is not finite.
  Ball(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ);
  /// The joint that holds A and B together at world point p_W in their present poses.
  static Ball at(const World& world, BodyId a, BodyId b, const Vec3& p_W);
  /// This joint with free axes: z of the frames F in A and G in B are the directions of swing and twist,
  /// which are 0 where F and G agree; turns are about x, y, z of F.
  /// @throws std::invalid_argument if an orientation is not of unit length.
  Ball with_axes(const Quat& q_AF, const Quat& q_BG) const;
  /// This joint with free axes: z of F and G along a world direction, swing and twist 0 in the present poses.
  /// @throws std::invalid_argument if the direction is not of unit length.
  Ball with_axes(const World& world, const Vec3& axis_W) const;

  std::string_view type() const override { return "ball"; }
  void append_rows(RowSink& rows) const override;
  void append_axes(AxisSink& axes) const override;
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  struct Frames {
    Quat q_AF, q_BG;
  };
  Vec3 p_AP_, p_BQ_;
  std::optional<Frames> frames_;
};

}  // namespace taut
