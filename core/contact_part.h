#pragma once

#include <string>

#include "core/row_parts.h"

/// Row parts of contacts.  Unlike those of joints they are set anew for each state: directions are kept in
/// world axes and hold for that state alone, so that a rolling wheel has no rate along the normal.
namespace taut::row_parts {

/// Right-handed frame of a contact, world axes: n from A to B.
struct ContactFrame {
  Vec3 n = Vec3::UnitZ(), t1 = Vec3::UnitX(), t2 = Vec3::UnitY();
  const Vec3& direction(int i) const { return i == 0 ? n : i == 1 ? t1 : t2; }
};

/// Rates of A and B against each other at the middle X of the points that face each other.
///   w = (n, t₁, t₂)·(v_BX − v_AX) [m/s],   φ = (n, t₁, t₂)·(p_WQ − p_WP) [m]
///                                                                          (solvers/README, "Contacts")
/// λ [N·s] is the impulse on B at X along these directions; A receives the opposite at the same place.
struct ContactPoint {
  static constexpr int kRows = 3;
  static constexpr bool kAngular = false;
  Vec3 p_AP = Vec3::Zero(), p_BQ = Vec3::Zero();
  ContactFrame frame{};

  void residual(const Pose& A, const Pose& B, double* phi) const {
    const Vec3 d = (B.p - A.p) + (B.q * p_BQ - A.q * p_AP);
    for (int i = 0; i < 3; ++i) phi[i] = frame.direction(i).dot(d);
  }
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const {
    const Vec3 X = 0.5 * (A.p + A.q * p_AP + B.p + B.q * p_BQ), r_A = X - A.p, r_B = X - B.p;
    for (int i = 0; i < 3; ++i) {
      const Vec3& d = frame.direction(i);
      J_A.row(i) << -r_A.cross(d).transpose(), -d.transpose();
      J_B.row(i) << r_B.cross(d).transpose(), d.transpose();
    }
  }
  void bias(const Pose&, const Pose&, const Twist&, const Twist&, double* gamma) const {
    gamma[0] = gamma[1] = gamma[2] = 0;
  }
  /// Directions and place are fixed while they hold.
  void stiffness(const Pose&, const Pose&, const double*, StiffnessBlocks&, StiffnessBlocks&) const {}
  std::string row_name(int i) const { return i == 0 ? "contact normal" : "contact tangent"; }
};

/// Rates of rotation of B against A: spin about the normal, rolling about the tangents.
///   w = (n, t₁, t₂)·(ω_B − ω_A) [rad/s],   φ = 0
/// λ [N·m·s] is the angular impulse on B; A receives the opposite.
struct ContactTwist {
  static constexpr int kRows = 3;
  static constexpr bool kAngular = true;
  ContactFrame frame{};

  void residual(const Pose&, const Pose&, double* phi) const { phi[0] = phi[1] = phi[2] = 0; }
  void jacobian(const Pose&, const Pose&, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const {
    for (int i = 0; i < 3; ++i) {
      J_A.row(i) << -frame.direction(i).transpose(), 0, 0, 0;
      J_B.row(i) << frame.direction(i).transpose(), 0, 0, 0;
    }
  }
  void bias(const Pose&, const Pose&, const Twist&, const Twist&, double* gamma) const {
    gamma[0] = gamma[1] = gamma[2] = 0;
  }
  void stiffness(const Pose&, const Pose&, const double*, StiffnessBlocks&, StiffnessBlocks&) const {}
  std::string row_name(int i) const { return i == 0 ? "spin about the contact normal" : "rolling"; }
};

}  // namespace taut::row_parts
