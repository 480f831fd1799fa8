#pragma once

#include <cmath>
#include <sstream>
#include <string>

#include "core/so3.h"
#include "core/state.h"

/// The elementary constraints that joints are made of.  Each part ties body A to body B and gives, in world
/// axes,
///
///   residual   φ(q)                                                              [m] or [rad]
///   jacobian   J_A, J_B with φ̇ = J_A V_A + J_B V_B, V = (ω, v)                     (core/README, Eq. 2)
///   bias       γ = J̇ V, so that φ̈ = J V̇ + γ                                      (core/README, Eq. 3)
///   stiffness  the diagonal blocks of K = −∂(Jᵀλ)/∂q, symmetric part             (core/README, Eq. 4)
///   row_name   which motion a row holds, for reports
///
/// A positive λ acts on B along +J_Bᵀ, and on A along +J_Aᵀ = the opposite wrench (Newton's third law).
/// A new kind is one more struct like these; nothing else has to know of it.  tests/core/row_parts_test.cpp
/// checks every part against finite differences with one shared checker.
namespace taut {

/// One row-major block of N rows by 6 columns (ω, v).
template <int N>
using JacobianBlock = Eigen::Map<Eigen::Matrix<double, N, 6, Eigen::RowMajor>>;

/// Geometric stiffness that a joint's load gives to one of its bodies: rotation–rotation [N·m/rad] and
/// translation–translation [N/m] block, symmetric parts.
struct StiffnessBlocks {
  Mat3 rotation = Mat3::Zero();
  Mat3 translation = Mat3::Zero();
};

namespace row_parts {

/// sym −∂(r × f)/∂θ for a force f at an arm r that turns with the body: (f·r) 1 − sym(r fᵀ).
inline Mat3 lever_stiffness(const Vec3& r, const Vec3& f) {
  const double dot = f.dot(r);
  const double xy = -0.5 * (r[0] * f[1] + r[1] * f[0]), xz = -0.5 * (r[0] * f[2] + r[2] * f[0]),
               yz = -0.5 * (r[1] * f[2] + r[2] * f[1]);
  Mat3 K;
  K << dot - r[0] * f[0], xy, xz, xy, dot - r[1] * f[1], yz, xz, yz, dot - r[2] * f[2];
  return K;
}

inline const char* axis_name(int i) { return i == 0 ? "x" : i == 1 ? "y" : "z"; }

/// "y", "−y" for the axes themselves, else "(0.6, 0.8, 0)".
inline std::string direction_name(const Vec3& d) {
  for (int i = 0; i < 3; ++i)
    if (std::abs(std::abs(d[i]) - 1) < 1e-9) return std::string(d[i] < 0 ? "−" : "") + axis_name(i);
  std::ostringstream text;
  text.precision(3);
  text << "(" << d[0] + 0.0 << ", " << d[1] + 0.0 << ", " << d[2] + 0.0 << ")";
  return text.str();
}

/// Point P of A coincides with point Q of B.   φ = p_WQ − p_WP ∈ ℝ³ [m], world axes
/// λ [N] is the force on B at Q.  A receives −λ at P, so an open point leaves the couple φ × λ.
struct Point {
  static constexpr int kRows = 3;
  static constexpr bool kAngular = false;
  Vec3 p_AP, p_BQ;

  void residual(const Pose& A, const Pose& B, double* phi) const {
    Eigen::Map<Vec3> out(phi);
    out = (B.p - A.p) + (B.q * p_BQ - A.q * p_AP);
  }
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const {
    J_A.leftCols<3>() = skew(A.q * p_AP);
    J_A.rightCols<3>() = -Mat3::Identity();
    J_B.leftCols<3>() = -skew(B.q * p_BQ);
    J_B.rightCols<3>() = Mat3::Identity();
  }
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
    Eigen::Map<Vec3> out(gamma);
    out = V_B.w.cross(V_B.w.cross(B.q * p_BQ)) - V_A.w.cross(V_A.w.cross(A.q * p_AP));
  }
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const {
    const Vec3 f(lambda[0], lambda[1], lambda[2]);
    K_A.rotation -= lever_stiffness(A.q * p_AP, f);
    K_B.rotation += lever_stiffness(B.q * p_BQ, f);
  }
  std::string row_name(int i) const { return std::string("translation along world ") + axis_name(i); }
};

/// Point Q of B stays in the plane through P of A with normal a fixed in A.   φ = a·(p_WQ − p_WP) [m]
/// λ a [N] is the force on B at Q; A receives −λ a at the same place, whether the joint is closed or not.
struct PointInPlane {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = false;
  Vec3 p_AP, a_A, p_BQ;

  void residual(const Pose& A, const Pose& B, double* phi) const {
    *phi = (A.q * a_A).dot((B.p - A.p) + (B.q * p_BQ - A.q * p_AP));
  }
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
    const Vec3 a = A.q * a_A, r_B = B.q * p_BQ, s = B.p + r_B - A.p;  // s: from the centre of A to Q
    J_A << a.cross(s).transpose(), -a.transpose();
    J_B << r_B.cross(a).transpose(), a.transpose();
  }
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
    const Vec3 a = A.q * a_A, r_A = A.q * p_AP, r_B = B.q * p_BQ;
    const Vec3 d = (B.p - A.p) + (r_B - r_A), d_dot = V_B.at(r_B) - V_A.at(r_A);
    const Vec3 a_dot = V_A.w.cross(a);
    *gamma = a.dot(V_B.w.cross(V_B.w.cross(r_B)) - V_A.w.cross(V_A.w.cross(r_A))) + 2 * a_dot.dot(d_dot) +
             V_A.w.cross(a_dot).dot(d);
  }
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const {
    const Vec3 f = *lambda * (A.q * a_A), r_B = B.q * p_BQ;
    K_A.rotation += lever_stiffness(B.p + r_B - A.p, f);
    K_B.rotation += lever_stiffness(r_B, f);
  }
  std::string row_name(int) const { return "translation along " + direction_name(a_A) + " of A"; }
};

/// Direction a of A stays perpendicular to direction b of B.   φ = a·b [rad, sine of the angle off]
/// λ [N·m] is the torque on B about b × a.
struct Perpendicular {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = true;
  Vec3 a_A, b_B;

  void residual(const Pose& A, const Pose& B, double* phi) const { *phi = (A.q * a_A).dot(B.q * b_B); }
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
    const Vec3 axb = (A.q * a_A).cross(B.q * b_B);
    J_A << axb.transpose(), 0, 0, 0;
    J_B << -axb.transpose(), 0, 0, 0;
  }
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
    const Vec3 a = A.q * a_A, b = B.q * b_B, a_dot = V_A.w.cross(a), b_dot = V_B.w.cross(b);
    *gamma = V_A.w.cross(a_dot).dot(b) + 2 * a_dot.dot(b_dot) + a.dot(V_B.w.cross(b_dot));
  }
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const {
    const Mat3 K = lever_stiffness(A.q * a_A, *lambda * (B.q * b_B));
    K_A.rotation += K;
    K_B.rotation += K;
  }
  std::string row_name(int) const {
    return "rotation that tilts the axis towards " + direction_name(a_A) + " of A";
  }
};

/// Frame F of A and frame G of B keep the same orientation.   φ = 2 vec(q_FG) ∈ ℝ³ [rad], in axes of F;
/// its length is 2 sin(angle / 2).  Half a turn away the sign of φ flips and J has rank 2.
/// λ [N·m] is the torque on B in axes of F (where φ = 0; in general R_WF (s λ + vec × λ), q_FG = (s, vec)).
struct Orientation {
  static constexpr int kRows = 3;
  static constexpr bool kAngular = true;
  Quat q_AF, q_BG;

  /// q_FG on the hemisphere of small angles.
  Quat relative(const Pose& A, const Pose& B) const {
    Quat q = (A.q * q_AF).conjugate() * (B.q * q_BG);
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    return q;
  }
  void residual(const Pose& A, const Pose& B, double* phi) const {
    Eigen::Map<Vec3> out(phi);
    out = 2 * relative(A, B).vec();
  }
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const {
    const Quat q = relative(A, B);
    // d/dt 2 vec(q_FG) = (s 1 − [vec]×) R_FW ω_rel with s the scalar part.
    const Mat3 J = (q.w() * Mat3::Identity() - skew(q.vec())) * (A.q * q_AF).toRotationMatrix().transpose();
    J_A << -J, Mat3::Zero();
    J_B << J, Mat3::Zero();
  }
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
    const Quat q = relative(A, B), q_FW = (A.q * q_AF).conjugate();
    const Vec3 v = q.vec(), w = q_FW * (V_B.w - V_A.w), w_dot = -(q_FW * V_A.w).cross(w);
    const double s = q.w(), s_dot = -0.5 * w.dot(v);
    const Vec3 v_dot = 0.5 * (s * w + w.cross(v));
    Eigen::Map<Vec3> out(gamma);
    out = s_dot * w + w.cross(v_dot) + s * w_dot + w_dot.cross(v);
  }
  /// The torque turns with A and the blocks on the diagonal are skew: no symmetric part at φ = 0.
  void stiffness(const Pose&, const Pose&, const double*, StiffnessBlocks&, StiffnessBlocks&) const {}
  std::string row_name(int i) const { return std::string("rotation about joint ") + axis_name(i); }
};

/// Points P of A and Q of B keep their distance.   φ = |p_WQ − p_WP| − L [m], L > 0
/// λ [N] is the force on B along the line from P to Q: positive in compression.
struct Distance {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = false;
  Vec3 p_AP, p_BQ;
  double length;

  void residual(const Pose& A, const Pose& B, double* phi) const {
    *phi = ((B.p - A.p) + (B.q * p_BQ - A.q * p_AP)).norm() - length;
  }
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
    const Vec3 r_A = A.q * p_AP, r_B = B.q * p_BQ, n = direction((B.p - A.p) + (r_B - r_A));
    J_A << -r_A.cross(n).transpose(), -n.transpose();
    J_B << r_B.cross(n).transpose(), n.transpose();
  }
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
    const Vec3 r_A = A.q * p_AP, r_B = B.q * p_BQ, d = (B.p - A.p) + (r_B - r_A);
    const Vec3 n = direction(d), d_dot = V_B.at(r_B) - V_A.at(r_A);
    const double along = n.dot(d_dot), distance = d.norm();
    const double turning = distance > 0 ? (d_dot.squaredNorm() - along * along) / distance : 0;
    *gamma = n.dot(V_B.w.cross(V_B.w.cross(r_B)) - V_A.w.cross(V_A.w.cross(r_A))) + turning;
  }
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const {
    const Vec3 r_A = A.q * p_AP, r_B = B.q * p_BQ, d = (B.p - A.p) + (r_B - r_A), n = direction(d);
    // The force λn swings with the line between the points: −λ (1 − nnᵀ)/|d| on translations.
    // Where the points coincide there is no line; nothing swings.
    const double distance = d.norm(), per_distance = distance > 0 ? -*lambda / distance : 0;
    const Mat3 swing = per_distance * (Mat3::Identity() - n * n.transpose());
    K_A.translation += swing;
    K_B.translation += swing;
    K_A.rotation += skew(r_A) * swing * skew(r_A).transpose() - lever_stiffness(r_A, *lambda * n);
    K_B.rotation += skew(r_B) * swing * skew(r_B).transpose() + lever_stiffness(r_B, *lambda * n);
  }
  std::string row_name(int) const { return "distance"; }

 private:
  /// Any direction will do where the points coincide; the residual −L then pushes them apart along it.
  static Vec3 direction(const Vec3& d) {
    const double norm = d.norm();
    return norm > 0 ? Vec3(d / norm) : Vec3(Vec3::UnitX());
  }
};

}  // namespace row_parts
}  // namespace taut
