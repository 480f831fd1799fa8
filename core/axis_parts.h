#pragma once

#include <numbers>
#include <string>

#include "core/row_parts.h"

/// Row parts whose residual is the coordinate of a free axis.  They are ordinary parts (row_parts.h); one
/// that has `kPeriod` is known up to multiples of it, and whoever reads it takes the value next to the last
/// one.
namespace taut {

/// The value next to `near` among value + k period.
inline double unwrapped(double value, double near, double period) {
  return value + period * std::round((near - value) / period);
}

namespace row_parts {

/// Angle about axis a of A from direction u of A to direction e of B, seen along −a (right-handed):
///   θ = atan2(v·e, u·e) [rad],   v = a × u                                         (core/README, Eq. 14)
/// e need not be perpendicular to a; its projection counts, and where that vanishes θ has no meaning.
/// λ [N·m] is the torque on B about j = a − (a·e) p/|p|², p = (u·e) u + (v·e) v; j = a where e ⟂ a.
struct Angle {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = true;
  static constexpr double kPeriod = 2 * std::numbers::pi;
  Vec3 a_A, u_A, e_B;

  /// World axes: a, e, the projection p of e, its square D and z = a·e.
  struct Directions {
    Vec3 a, u, v, e, p;
    double x, y, z, D;
    Vec3 j() const { return a - z / D * p; }
  };
  Directions directions(const Pose& A, const Pose& B) const {
    Directions d;
    d.a = A.q * a_A, d.u = A.q * u_A, d.v = d.a.cross(d.u), d.e = B.q * e_B;
    d.x = d.u.dot(d.e), d.y = d.v.dot(d.e), d.z = d.a.dot(d.e);
    d.p = d.x * d.u + d.y * d.v;
    d.D = d.x * d.x + d.y * d.y;
    return d;
  }
  void residual(const Pose& A, const Pose& B, double* theta) const {
    const Vec3 u = A.q * u_A, v = A.q * a_A.cross(u_A), e = B.q * e_B;
    *theta = std::atan2(v.dot(e), u.dot(e));
  }
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
    const Vec3 j = directions(A, B).j();
    J_A << -j.transpose(), 0, 0, 0;
    J_B << j.transpose(), 0, 0, 0;
  }
  /// From θ̇ D = x ẏ − y ẋ.
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
    const Directions d = directions(A, B);
    const Vec3 e1 = V_B.w.cross(d.e), e2 = V_B.w.cross(e1);
    const auto rates = [&](const Vec3& u, double& first, double& second) {
      const Vec3 u1 = V_A.w.cross(u);
      first = u1.dot(d.e) + u.dot(e1);
      second = V_A.w.cross(u1).dot(d.e) + 2 * u1.dot(e1) + u.dot(e2);
    };
    double x1, x2, y1, y2;
    rates(d.u, x1, x2);
    rates(d.v, y1, y2);
    const double rate = (d.x * y1 - d.y * x1) / d.D;
    *gamma = (d.x * y2 - d.y * x2 - 2 * rate * (d.x * x1 + d.y * y1)) / d.D;
  }
  /// j turns with both bodies together, hence equal symmetric parts on A and B.
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const {
    const Directions d = directions(A, B);
    // ∂j/∂e; the direction e itself changes by −[e]× with the rotation of B.
    const Mat3 G = -(d.p * d.a.transpose() + d.z * (Mat3::Identity() - d.a * d.a.transpose())) / d.D +
                   2 * d.z / (d.D * d.D) * d.p * d.p.transpose();
    const Mat3 turn = *lambda * G * skew(d.e);
    const Mat3 K = 0.5 * (turn + turn.transpose());
    K_A.rotation += K;
    K_B.rotation += K;
  }
  std::string row_name(int) const { return "rotation about the axis"; }
};

/// Displacement of point Q of B from point P of A along direction a of A.   x = a·(p_WQ − p_WP) [m]
/// λ a [N] is the force on B at Q; A receives −λ a at the same place.
struct Displacement : PointInPlane {
  std::string row_name(int) const { return "displacement along the axis"; }
};

}  // namespace row_parts
}  // namespace taut
