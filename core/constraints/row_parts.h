#pragma once

#include <string>

#include "core/constraints/part_store.h"
#include "core/constraints/row_sinks.h"
#include "core/math/so3.h"
#include "core/state/state.h"

/// The elementary constraints that joints are made of.  Each part ties body A to body B and gives, in world
/// axes,
///
///   residual   φ(q)                                                              [m] or [rad]
///   jacobian   J_A, J_B with φ̇ = J_A V_A + J_B V_B, V = (ω, v)                (core/constraints, Eq. 1)
///   bias       γ = J̇ V, so that φ̈ = J V̇ + γ                                  (core/constraints, Eq. 2)
///   stiffness  the diagonal blocks of K = −∂(Jᵀλ)/∂q, symmetric part        (core/constraints, Eq. 3)
///   row_name   which motion a row holds, for reports
///   carried    the same part between bodies that carry A and B at fixed poses X_CA, X_CB (merged_world.h)
///
/// A positive λ acts on B along +J_Bᵀ, and on A along +J_Aᵀ = the opposite wrench (Newton's third law).
/// A new kind is one more struct like these; nothing else has to know of it.
/// tests/core/constraints/row_parts_test.cpp checks every part against finite differences with one shared
/// checker.
namespace taut {

namespace row_parts {

/// K += sym −∂(r × f)/∂θ for a force f at an arm r that turns with the body: (f·r) 1 − sym(r fᵀ).
[[gnu::always_inline]] inline void add_lever_stiffness(const Vec3& r, const Vec3& f, Mat3& K) {
  const double xx = r[0] * f[0], yy = r[1] * f[1], zz = r[2] * f[2];
  const double xy = 0.5 * (r[0] * f[1] + r[1] * f[0]), xz = 0.5 * (r[0] * f[2] + r[2] * f[0]),
               yz = 0.5 * (r[1] * f[2] + r[2] * f[1]);
  K(0, 0) += yy + zz, K(1, 1) += xx + zz, K(2, 2) += xx + yy;
  K(0, 1) -= xy, K(1, 0) -= xy, K(0, 2) -= xz, K(2, 0) -= xz, K(1, 2) -= yz, K(2, 1) -= yz;
}

const char* axis_name(int i);  ///< "x", "y" or "z"

/// "y", "−y" for the axes themselves, else "(0.6, 0.8, 0)".
std::string direction_name(const Vec3& d);

/// Point P of A coincides with point Q of B.   φ = p_WQ − p_WP ∈ ℝ³ [m], world axes
/// λ [N] is the force on B at Q.  A receives −λ at P, so an open point leaves the couple φ × λ.
struct Point {
  static constexpr int kRows = 3;
  static constexpr bool kAngular = false;
  Vec3 p_AP, p_BQ;  ///< from the centres of mass, body axes [m]

  Point carried(const Pose& X_CA, const Pose& X_CB) const;
  void residual(const Pose& A, const Pose& B, double* phi) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const;
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
  std::string row_name(int i) const;
};

/// A Point that is alone in its joint: of J = ([a]×, −1), (−[b]×, 1) only the arms a and b are kept, from
/// the centres to P and Q in world axes [m].
struct CompactPoint : Point {
  void arms(const Pose& A, const Pose& B, double* a, double* b) const;  ///< three numbers each
  CompactPoint carried(const Pose& X_CA, const Pose& X_CB) const;
};

/// Point Q of B stays in the plane through P of A with normal a fixed in A.   φ = a·(p_WQ − p_WP) [m]
/// λ a [N] is the force on B at Q; A receives −λ a at the same place, whether the joint is closed or not.
struct PointInPlane {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = false;
  Vec3 p_AP, a_A, p_BQ;  ///< points [m] and unit normal, body axes

  PointInPlane carried(const Pose& X_CA, const Pose& X_CB) const;
  void residual(const Pose& A, const Pose& B, double* phi) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const;
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
  std::string row_name(int) const;
};

/// Direction a of A stays perpendicular to direction b of B.   φ = a·b [rad, sine of the angle off]
/// λ [N·m] is the torque on B about b × a.
struct Perpendicular {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = true;
  Vec3 a_A, b_B;  ///< unit vectors, body axes

  Perpendicular carried(const Pose& X_CA, const Pose& X_CB) const;
  void residual(const Pose& A, const Pose& B, double* phi) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const;
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
  std::string row_name(int) const;
};

/// Frame F of A and frame G of B keep the same orientation.   φ = 2 vec(q_FG) ∈ ℝ³ [rad], in axes of F;
/// its length is 2 sin(angle / 2).  Half a turn away the sign of φ flips and J has rank 2.
/// λ [N·m] is the torque on B in axes of F (where φ = 0; in general R_WF (s λ + vec × λ), q_FG = (s, vec)).
struct Orientation {
  static constexpr int kRows = 3;
  static constexpr bool kAngular = true;
  Quat q_AF, q_BG;  ///< frame F in A and frame G in B

  Orientation carried(const Pose& X_CA, const Pose& X_CB) const;
  /// q_FG on the hemisphere of small angles.
  Quat relative(const Pose& A, const Pose& B) const;
  void residual(const Pose& A, const Pose& B, double* phi) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const;
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  /// The torque turns with A and the blocks on the diagonal are skew: no symmetric part at φ = 0.
  void stiffness(const Pose&, const Pose&, const double*, StiffnessBlocks&, StiffnessBlocks&) const {}
  std::string row_name(int i) const;
};

/// Points P of A and Q of B keep their distance.   φ = |p_WQ − p_WP| − L [m], L > 0
/// λ [N] is the force on B along the line from P to Q: positive in compression.
struct Distance {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = false;
  Vec3 p_AP, p_BQ;  ///< from the centres of mass, body axes [m]
  double length;    ///< L [m]

  Distance carried(const Pose& X_CA, const Pose& X_CB) const;
  void residual(const Pose& A, const Pose& B, double* phi) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const;
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
  std::string row_name(int) const;

 private:
  /// Any direction will do where the points coincide; the residual −L then pushes them apart along it.
  static Vec3 direction(const Vec3& d);
};

/// The length of a spring, φ = ‖d‖; ends that have passed each other within a step are on a straight line
/// through 0 (`kSigned`).
struct Stretch {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = false;
  static constexpr bool kSigned = true;
  Vec3 p_AP, p_BQ;  ///< from the centres of mass, body axes [m]

  Stretch carried(const Pose& X_CA, const Pose& X_CB) const;
  void residual(const Pose& A, const Pose& B, double* phi) const { line().residual(A, B, phi); }
  /// That d has turned round since the ends were at A0 and B0.
  bool turned_round(const Pose& A0, const Pose& B0, const Pose& A, const Pose& B) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
    line().jacobian(A, B, J_A, J_B);
  }
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
    line().bias(A, B, V_A, V_B, gamma);
  }
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const {
    line().stiffness(A, B, lambda, K_A, K_B);
  }
  std::string row_name(int) const { return "length of a spring"; }

 private:
  Distance line() const { return {p_AP, p_BQ, 0}; }
};

}  // namespace row_parts

}  // namespace taut
