#pragma once

#include <numbers>
#include <string>

#include "core/row_parts.h"

/// Row parts whose residual is the coordinate of a free axis.  They are ordinary parts (row_parts.h); one
/// that has a period() is known up to multiples of it, and whoever reads it takes the value next to the last
/// one.
namespace taut {

/// The value next to `near` among value + k period; an infinite period leaves it alone.
inline double unwrapped(double value, double near, double period) {
  if (!std::isfinite(period)) return value;
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
  static constexpr double period() { return 2 * std::numbers::pi; }
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

/// Distance of points P of A and Q of B.   x = |p_WQ − p_WP| [m]
/// λ [N] is the force on B along the line from P to Q, pushing the points apart.
struct Length : Distance {
  Length(const Vec3& P, const Vec3& Q) : Distance{P, Q, 0} {}
  std::string row_name(int) const { return "length"; }
};

/// Screw: the displacement x along an axis follows the turn θ about it.   φ = x − k θ [m], k = pitch / 2π
/// Known up to multiples of the pitch, since θ is up to turns; next to 0 is meant.
/// λ [N] is the force on B along the axis, with the torque −k λ about it.
struct Screw {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = false;
  Displacement displacement;
  Angle angle;
  double pitch;  ///< [m per turn], not 0; negative for a left-handed thread

  double period() const { return std::abs(pitch); }
  double k() const { return pitch / (2 * std::numbers::pi); }
  void residual(const Pose& A, const Pose& B, double* phi) const {
    double theta;
    displacement.residual(A, B, phi);
    angle.residual(A, B, &theta);
    *phi -= k() * theta;
  }
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
    double of_a[6], of_b[6];
    JacobianBlock<1> angle_A(of_a), angle_B(of_b);
    displacement.jacobian(A, B, J_A, J_B);
    angle.jacobian(A, B, angle_A, angle_B);
    J_A -= k() * angle_A;
    J_B -= k() * angle_B;
  }
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
    double of_angle;
    displacement.bias(A, B, V_A, V_B, gamma);
    angle.bias(A, B, V_A, V_B, &of_angle);
    *gamma -= k() * of_angle;
  }
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const {
    const double torque = -k() * *lambda;
    displacement.stiffness(A, B, lambda, K_A, K_B);
    angle.stiffness(A, B, &torque, K_A, K_B);
  }
  std::string row_name(int) const { return "displacement by the thread"; }
};

}  // namespace row_parts
}  // namespace taut
