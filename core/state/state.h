#pragma once

#include <span>
#include <vector>

#include "core/math/so3.h"

namespace taut {

/// Index of a body in its World.  0 is the ground.
struct BodyId {
  int index = 0;  ///< 0: the ground
  friend auto operator<=>(BodyId, BodyId) = default;
};
/// Index of a joint in its World.
struct JointId {
  int index = -1;  ///< −1: none
  friend auto operator<=>(JointId, JointId) = default;
};
/// Index of a force element in its World.
struct ForceId {
  int index = -1;  ///< −1: none
  friend auto operator<=>(ForceId, ForceId) = default;
};

/// A free axis of a joint, for instance the angle of a hinge.
struct AxisId {
  JointId joint;  ///< whose axis it is
  int axis = -1;  ///< its place among those of the joint; −1: none
  friend auto operator<=>(const AxisId&, const AxisId&) = default;
};

inline constexpr BodyId kGround{0};  ///< the ground, which never moves

/// X_WB: orientation of body B in the world and position of its centre of mass [m].
struct Pose {
  Quat q = Quat::Identity();  ///< R_WB
  Vec3 p = Vec3::Zero();      ///< p_WB [m]

  /// p_WP of a point fixed in the body, p_BP measured from the centre of mass.
  Vec3 point(const Vec3& p_BP) const { return p + rotate(q, p_BP); }
  /// p_BP of a world point.
  Vec3 local(const Vec3& p_WP) const { return rotate(q.conjugate(), p_WP - p); }
};

/// Composition of poses, X_WB = X_WA X_AB.
inline Pose operator*(const Pose& X_WA, const Pose& X_AB) { return {X_WA.q * X_AB.q, X_WA.point(X_AB.p)}; }

/// V_WB: angular velocity [rad/s] and velocity of the centre of mass [m/s], both in world axes.
struct Twist {
  Vec3 w = Vec3::Zero();  ///< ω [rad/s]
  Vec3 v = Vec3::Zero();  ///< velocity of the centre of mass [m/s]

  /// Velocity of the body point at offset r (world axes, from the centre of mass).
  Vec3 at(const Vec3& r_W) const { return v + w.cross(r_W); }
};

/// Torque about the centre of mass [N·m] and force [N] (or their impulses) in world axes; dual to Twist.
struct Wrench {
  Vec3 torque = Vec3::Zero();  ///< [N·m or N·m·s]
  Vec3 force = Vec3::Zero();   ///< [N or N·s]
};
/// Sum, difference and multiple of wrenches.  @{
inline Wrench operator+(const Wrench& a, const Wrench& b) { return {a.torque + b.torque, a.force + b.force}; }
inline Wrench operator-(const Wrench& a, const Wrench& b) { return {a.torque - b.torque, a.force - b.force}; }
inline Wrench operator*(double s, const Wrench& a) { return {s * a.torque, s * a.force}; }  /// @}
/// Power of a wrench on a body with this twist [W], τ·ω + f·v; of an impulse its work [J].
inline double dot(const Wrench& f, const Twist& V) { return f.torque.dot(V.w) + f.force.dot(V.v); }

/// Everything that changes with time.  Entry 0 is the ground.
struct State {
  double time = 0;            ///< [s]
  std::vector<Pose> poses;    ///< X_WB of each body
  std::vector<Twist> twists;  ///< V_WB of each body
  /// One value per free axis of the joints [rad or m], at World::axis_index().  Angles count turns: a pose
  /// gives an angle up to whole turns, and the value here says which of them is meant.  Solvers keep the
  /// entries of axes with properties up to date; others stay as they were set.
  std::vector<double> axes;
};

/// The part of a state that the rows of joints read: poses, the time that drivers follow, and the values next
/// to which angles are unwrapped (empty: 0).  It only refers to what it was made from.
struct Configuration {
  std::span<const Pose> poses;     ///< X_WB of each body
  double time = 0;                 ///< [s]
  std::span<const double> axes{};  ///< next to which angles are unwrapped; empty: 0
  std::span<const Pose> from{};    ///< the poses at which `axes` holds; empty: `poses` themselves

  Configuration(std::span<const Pose> all_poses, double at_time = 0, std::span<const double> axes_near = {},
                std::span<const Pose> axes_from = {})
      : poses(all_poses), time(at_time), axes(axes_near), from(axes_from) {}
  Configuration(const std::vector<Pose>& all_poses) : poses(all_poses) {}
  Configuration(const State& state) : poses(state.poses), time(state.time), axes(state.axes) {}

  /// Value of the axis at `index` that angles are unwrapped next to.
  double near(int index) const { return index >= 0 && !axes.empty() ? axes[index] : 0; }
};

}  // namespace taut
