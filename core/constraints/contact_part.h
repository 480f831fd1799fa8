#pragma once

#include <string>

#include "core/constraints/row_parts.h"

/// Row parts of contacts.  Unlike those of joints they are set anew for each state: directions are kept in
/// world axes and hold for that state alone, so that a rolling wheel has no rate along the normal.
namespace taut {
namespace row_parts {

/// Right-handed frame of a contact, world axes: n from A to B.
struct ContactFrame {
  Vec3 n{0, 0, 1}, t1{1, 0, 0}, t2{0, 1, 0};                                    ///< normal, and two tangents
  const Vec3& direction(int i) const { return i == 0 ? n : i == 1 ? t1 : t2; }  ///< n, t₁, t₂
};

/// Rates of A and B against each other at the middle X of the points that face each other.
///   w = (n, t₁, t₂)·(v_BX − v_AX) [m/s],   φ = (n, t₁, t₂)·(p_WQ − p_WP) [m]
///                                                                            (solvers/laws, "Contacts")
/// λ [N·s] is the impulse on B at X along these directions; A receives the opposite at the same place.
struct ContactPoint {
  static constexpr int kRows = 3;
  static constexpr bool kAngular = false;
  Vec3 p_AP = Vec3::Zero(), p_BQ = Vec3::Zero();  ///< from the centres of mass, body axes [m]
  ContactFrame frame{};                           ///< directions of the rows

  void residual(const Pose& A, const Pose& B, double* phi) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const;
  void bias(const Pose&, const Pose&, const Twist&, const Twist&, double* gamma) const;
  /// Directions and place are fixed while they hold.
  void stiffness(const Pose&, const Pose&, const double*, StiffnessBlocks&, StiffnessBlocks&) const {}
  std::string row_name(int i) const;
};

/// Rates of rotation of B against A: spin about the normal, rolling about the tangents.
///   w = (n, t₁, t₂)·(ω_B − ω_A) [rad/s],   φ = 0
/// λ [N·m·s] is the angular impulse on B; A receives the opposite.
struct ContactTwist {
  static constexpr int kRows = 3;
  static constexpr bool kAngular = true;
  ContactFrame frame{};  ///< directions of the rows

  void residual(const Pose&, const Pose&, double* phi) const;
  void jacobian(const Pose&, const Pose&, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const;
  void bias(const Pose&, const Pose&, const Twist&, const Twist&, double* gamma) const;
  void stiffness(const Pose&, const Pose&, const double*, StiffnessBlocks&, StiffnessBlocks&) const {}
  std::string row_name(int i) const;
};

}  // namespace row_parts

}  // namespace taut
