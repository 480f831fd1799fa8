#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "core/constraints/row_parts.h"

/// Row parts whose residual is the coordinate of a free axis.  They are ordinary parts (row_parts.h); one
/// that has a period() is known up to multiples of it, and whoever reads it takes the value next to the last
/// one.
namespace taut {
namespace row_parts {

/// Angle about axis a of A from direction u of A to direction e of B, seen along −a (right-handed):
///   θ = atan2(v·e, u·e) [rad],   v = a × u                                      (core/constraints, Eq. 10)
/// e need not be perpendicular to a; its projection counts, and where that vanishes θ has no meaning.
/// λ [N·m] is the torque on B about j = a − (a·e) p/|p|², p = (u·e) u + (v·e) v; j = a where e ⟂ a.
struct Angle {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = true;
  static constexpr double period() { return 2 * std::numbers::pi; }
  Vec3 a_A, u_A, e_B;  ///< unit vectors a and u ⟂ a in axes of A, e in axes of B

  Angle carried(const Pose& X_CA, const Pose& X_CB) const;
  /// World axes: a, e, the projection p of e, its square D and z = a·e.
  struct Directions {
    Vec3 a, u, v, e, p;  ///< p is the projection of e across a
    double x, y, z, D;   ///< x = u·e, y = v·e, z = a·e, D = x² + y²
    Vec3 j() const;      ///< along which λ acts
  };
  Directions directions(const Pose& A, const Pose& B) const;  ///< at these poses
  void residual(const Pose& A, const Pose& B, double* theta) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const;
  /// From θ̇ D = x ẏ − y ẋ.
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  /// K_A = K_B = λ sym(G [e]×), G = ∂j/∂e, since j turns with both bodies together.
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
  std::string row_name(int) const;
};

/// Displacement of point Q of B from point P of A along direction a of A.   x = a·(p_WQ − p_WP) [m]
/// λ a [N] is the force on B at Q; A receives −λ a at the same place.
struct Displacement : PointInPlane {
  Displacement carried(const Pose& X_CA, const Pose& X_CB) const;
  std::string row_name(int) const;
};

/// Distance of points P of A and Q of B.   x = |p_WQ − p_WP| [m]
/// λ [N] is the force on B along the line from P to Q, pushing the points apart.
struct Length : Distance {
  Length(const Vec3& P, const Vec3& Q) : Distance{P, Q, 0} {}  ///< [m] in A, B
  Length carried(const Pose& X_CA, const Pose& X_CB) const;
  std::string row_name(int) const;
};

/// Screw: the displacement x along an axis follows the turn θ about it.   φ = x − k θ [m], k = pitch / 2π
/// Known up to multiples of the pitch, since θ is up to turns; next to 0 is meant.
/// λ [N] is the force on B along the axis, with the torque −k λ about it.
struct Screw {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = false;
  Displacement displacement;  ///< x
  Angle angle;                ///< θ
  double pitch;               ///< [m per turn], not 0; negative for a left-handed thread

  Screw carried(const Pose& X_CA, const Pose& X_CB) const;
  double period() const { return std::abs(pitch); }
  double k() const { return pitch / (2 * std::numbers::pi); }  ///< [m/rad]
  void residual(const Pose& A, const Pose& B, double* phi) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const;
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
  std::string row_name(int) const;
};

}  // namespace row_parts

}  // namespace taut
