#pragma once

#include <vector>

#include "core/so3.h"

namespace taut {

/// Index of a body in its World.  0 is the ground.
struct BodyId {
  int index = 0;
  friend auto operator<=>(BodyId, BodyId) = default;
};
/// Index of a joint in its World.
struct JointId {
  int index = -1;
  friend auto operator<=>(JointId, JointId) = default;
};
/// Index of a force element in its World.
struct ForceId {
  int index = -1;
  friend auto operator<=>(ForceId, ForceId) = default;
};

inline constexpr BodyId kGround{0};

/// X_WB: orientation of body B in the world and position of its centre of mass [m].
struct Pose {
  Quat q = Quat::Identity();
  Vec3 p = Vec3::Zero();

  /// p_WP of a point fixed in the body, p_BP measured from the centre of mass.
  Vec3 point(const Vec3& p_BP) const { return p + q * p_BP; }
  /// p_BP of a world point.
  Vec3 local(const Vec3& p_WP) const { return q.conjugate() * (p_WP - p); }
};

/// V_WB: angular velocity [rad/s] and velocity of the centre of mass [m/s], both in world axes.
struct Twist {
  Vec3 w = Vec3::Zero();
  Vec3 v = Vec3::Zero();

  /// Velocity of the body point at offset r (world axes, from the centre of mass).
  Vec3 at(const Vec3& r_W) const { return v + w.cross(r_W); }
};

/// Torque about the centre of mass [N·m] and force [N] (or their impulses) in world axes; dual to Twist.
struct Wrench {
  Vec3 torque = Vec3::Zero();
  Vec3 force = Vec3::Zero();
};

/// Everything that changes with time.  Entry 0 is the ground.
struct State {
  double time = 0;
  std::vector<Pose> poses;
  std::vector<Twist> twists;
};

}  // namespace taut
