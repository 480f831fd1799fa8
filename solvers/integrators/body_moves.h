#pragma once

#include <algorithm>
#include <span>

#include "core/state/state.h"
#include "solvers/system/mass_matrix.h"

// Moves of bodies that impulses j = Jᵀ λ stand for: each by M⁻¹ j, in world axes; and what forces do to
// bodies without joints.
namespace taut {

/// Chosen, where nothing else is said.
struct BodyMovesTuning {
  /// Longest rotation of a body in one step of Newton's method from poses that may be far from closed [rad];
  /// a step beyond that means nothing, since rows are linear in small rotations.
  static constexpr double kLongestTurn = 0.5;
};

/// q ← q ⊕ (turn, shift), of one body in world axes.
inline void move_pose(Pose& pose, const Vec3& turn, const Vec3& shift) {
  pose.p += shift;
  pose.q = (exp_so3(turn) * pose.q).normalized();
}
/// The part of a step of Newton's method in which no body turns by more than kLongestTurn.
inline double part_of_step(double turn) {
  return turn > BodyMovesTuning::kLongestTurn ? BodyMovesTuning::kLongestTurn / turn : 1;
}

/// q ← q ⊕ scale M⁻¹ j.
inline void move_bodies(const MassMatrix& mass, std::span<const Wrench> impulse, double scale,
                        std::span<Pose> poses) {
  for (int b = 0; b < mass.size(); ++b) {
    if (mass[b].fixed) continue;
    move_pose(poses[b], scale * mass.angular_velocity(b, poses[b], impulse[b].torque),
              scale * mass[b].inverse_mass * impulse[b].force);
  }
}

/// The largest rotation in M⁻¹ j [rad].
inline double largest_turn(const MassMatrix& mass, std::span<const Wrench> impulse,
                           std::span<const Pose> poses) {
  double turn = 0;
  for (int b = 0; b < mass.size(); ++b)
    if (!mass[b].fixed) turn = std::max(turn, mass.angular_velocity(b, poses[b], impulse[b].torque).norm());
  return turn;
}

/// The largest displacement of a centre of mass in M⁻¹ j [m].
inline double largest_displacement(const MassMatrix& mass, std::span<const Wrench> impulse) {
  double largest = 0;
  for (int b = 0; b < mass.size(); ++b)
    if (!mass[b].fixed) largest = std::max(largest, mass[b].inverse_mass * impulse[b].force.norm());
  return largest;
}

/// V̇ of the free bodies: M⁻¹ (f − ω × Iω).
inline void free_accelerations(const MassMatrix& mass, const State& state, std::span<const Wrench> forces,
                               std::span<Twist> accelerations) {
  for (int b = 0; b < mass.size(); ++b) {
    if (mass[b].fixed) continue;
    const Vec3& w = state.twists[b].w;
    const Vec3 torque = forces[b].torque - w.cross(mass.angular_momentum(b, state.poses[b], w));
    accelerations[b] = {mass.angular_velocity(b, state.poses[b], torque),
                        mass[b].inverse_mass * forces[b].force};
  }
}

}  // namespace taut
