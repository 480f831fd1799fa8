#pragma once

#include <string>

#include "core/constraints/row_parts.h"
#include "core/state/swing_axes.h"

/// Coordinates of joints that leave rotations free which are no single angle.
namespace taut {
namespace row_parts {

/// Swing: angle between direction a of A and direction b of B, from 0 to π.    (core/constraints, Eq. 12)
///   θ = atan2(|a × b|, a·b) [rad]
/// λ [N·m] is the torque on B about j = a × b/|a × b|, away from a; where that vanishes any j across a is
/// taken, and friction and springs act along other axes of the joint, `across` (AxisInfo).
struct Swing {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = true;
  Vec3 a_A, b_B;       ///< unit vectors a, b in axes of A, B
  SwingAxes across{};  ///< other axes of the joint

  Swing carried(const Pose& X_CA, const Pose& X_CB) const;
  struct Directions {       ///< World axes.
    Vec3 a, b, j;           ///< j = a × b/|a × b|
    double sine = 0;        ///< |a × b|
    bool straight = false;  ///< sine vanishes: j is any direction across a
  };
  Directions directions(const Pose& A, const Pose& B) const;  ///< at these poses
  void residual(const Pose& A, const Pose& B, double* theta) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const;
  /// j̇ = (1 − j jᵀ) d(a × b)/dt / |a × b|.
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  /// With P = (1 − j jᵀ)/|a × b|:  K_A = λ sym(P [b]× [a]×),  K_B = λ sym(P [a]× [b]×).
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
  std::string row_name(int) const;
};

/// Component of the swing along direction x of A across a, of the rotation vector that takes a to b:
///   s = (θ/sin θ) (a × b)·x [rad]                                               (core/constraints, Eq. 13)
/// With a second one along a × x, s₁² + s₂² = θ².
/// Smooth at a swing of 0, without meaning at π, where both change their sign.
/// λ [N·m] is the torque on B about g = f (C x − (x·b) a) + h (n·x) n, n = a × b, C = a·b, f = θ/sin θ,
/// h = (sin θ − θ C)/sin³θ.
struct SwingComponent {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = true;
  Vec3 a_A, b_B, x_A;  ///< unit vectors a, b and x ⟂ a in axes of A, B and A

  SwingComponent carried(const Pose& X_CA, const Pose& X_CB) const;
  /// World axes; k is dh/dt over n·w, which is sin θ dθ/dt.
  struct Directions {
    Vec3 a, b, x, n;    ///< n = a × b
    double C, f, h, k;  ///< C = a·b, f = θ/sin θ, h = (sin θ − θ C)/sin³θ
    Vec3 g() const;     ///< along which λ acts
    /// ġ in A when B turns against A with w.
    Vec3 turning(const Vec3& w) const;
  };
  Directions directions(const Pose& A, const Pose& B) const;  ///< at these poses
  void residual(const Pose& A, const Pose& B, double* s) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const;
  /// ṡ = g·w with w = ω_B − ω_A, so γ = ġ·w, ġ = ω_A × g + ġ in A.
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  /// g turns with both bodies together, hence equal symmetric parts on A and B.
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
  std::string row_name(int) const;
};

/// Twist: the turn of B against A about their common axis once the swing that takes a to b is undone.
///   q_FG = (s, u), z along a in F of A, b in G of B:  θ = 2 atan2(u_z, s) [rad]  (core/constraints, Eq. 14)
/// Without meaning at a swing of π.  λ [N·m] is the torque on B about j = R_WF (e_z + ((s u_y + u_z u_x)/D,
/// (u_z u_y − s u_x)/D, 0)), D = s² + u_z².
struct TwistAngle {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = true;
  static constexpr double period() { return 2 * 3.14159265358979323846; }
  Quat q_AF, q_BG;  ///< frame F in A and frame G in B, z along a and b

  TwistAngle carried(const Pose& X_CA, const Pose& X_CB) const;
  struct Directions {      ///< q_FG and what follows from it.
    Mat3 R_WF;             ///< axes of F
    double s, x, y, z, D;  ///< q_FG = (s, x, y, z), D = s² + z²
    Vec3 j() const;        ///< along which λ acts, world axes
    /// j̇ in F when the parts of q_FG have these rates.
    Vec3 turning(double s1, double x1, double y1, double z1) const;
    /// j̇ in F when B turns against A with w, in axes of F.
    Vec3 turning(const Vec3& w) const;
  };
  Directions directions(const Pose& A, const Pose& B) const;  ///< at these poses
  void residual(const Pose& A, const Pose& B, double* theta) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const;
  /// θ̇ = j·w with w = R_FW (ω_B − ω_A), so γ = j̇·w + j·ẇ, ẇ = −(R_FW ω_A) × w.
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
  std::string row_name(int) const;
};

/// Turn of B against A about direction a of A: θ̇ = a·(ω_B − ω_A).  Three of them are no coordinates of the
/// rotation, so that θ accumulates: over a step it grows by the part along a of the rotation vector of B
/// against A.                                                               (core/constraints, Eq. 15)
/// λ [N·m] is the torque on B about a.
struct Turn {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = true;
  static constexpr bool kAccumulates = true;
  Vec3 a_A;  ///< unit vector a in axes of A

  Turn carried(const Pose& X_CA, const Pose&) const;
  double increment(const Pose& A_from, const Pose& B_from, const Pose& A, const Pose& B) const;  ///< of θ
  void jacobian(const Pose& A, const Pose&, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const;
  void bias(const Pose& A, const Pose&, const Twist& V_A, const Twist& V_B, double* gamma) const;
  /// The torque turns with A: a skew block, no symmetric part.
  void stiffness(const Pose&, const Pose&, const double*, StiffnessBlocks&, StiffnessBlocks&) const {}
  std::string row_name(int) const;
};

}  // namespace row_parts

}  // namespace taut
