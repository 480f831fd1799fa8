#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/constraints/row_parts.h"
#include "core/math/spline.h"

/// A point that stays on a curve.                                                 (core/constraints, Eq. 8)
namespace taut {

/// A spline fixed in a body, with normals that turn with it as little as possible.
class BodyCurve {
 public:
  /// What a point x, in axes of the body, sees of the curve c(s): its nearest place and the normals there.
  struct Near {
    double s = 0;          ///< parameter of the nearest place
    CubicSpline<3>::At c;  ///< c(s) and its derivatives
    Vec3 e;                ///< x − c(s), perpendicular to c'
    Vec3 tangent;          ///< c'/|c'|
    Vec3 tangent_rate;     ///< its derivative by s
    Vec3 gradient;         ///< ∂s/∂x = c'/(|c'|² − c''·e)
    double D;              ///< |c'|² − c''·e
    Vec3 normal[2];        ///< right-handed with the tangent: n₁ × n₂ = t
    double twist;          ///< how fast the normals turn about the tangent, per s
  };

  explicit BodyCurve(CubicSpline<3> spline);

  const CubicSpline<3>& spline() const { return spline_; }  ///< in axes of the body
  /// The curve in axes of a body that carries its own, with the same normals.
  BodyCurve carried(const Pose& X_CA) const;

  /// The nearest place: the nearest node, then Newton's method on c'(s)·(x − c(s)) = 0.
  Near near(const Vec3& x) const;

 private:
  struct Node {
    double s = 0;
    Vec3 p = Vec3::Zero(), tangent = Vec3::Zero(), normal = Vec3::Zero();
  };
  static constexpr int kCells = 16;  ///< per segment of the spline
  static constexpr int kMaxIterations = 30;

  /// From the node at or before s the normals turn with the tangent by the least rotation.
  void place_frame(Near& at) const;

  CubicSpline<3> spline_;
  std::vector<Node> nodes_;
};

namespace row_parts {

/// What both parts below need: point Q of B in axes of A, x = R_AW (p_WQ − p_A), and its rates.
struct PointInBody {
  Vec3 s, r_B, x;  ///< p_WQ − p_A and R p_BQ in world axes; x in axes of A
  PointInBody(const Pose& A, const Pose& B, const Vec3& p_BQ);
  /// Row of the gradient g (axes of A): g·ẋ.
  void row(const Pose& A, const Vec3& g, double* J_A, double* J_B) const;
  /// ẋ and the part of ẍ without accelerations, both in axes of A.
  void rates(const Pose& A, const Twist& V_A, const Twist& V_B, Vec3& first, Vec3& second) const;
  /// K of a force with gradient g and Hessian H (axes of A), times λ: as a point in a plane, and the force
  /// changes with x by H.
  void stiffness(const Pose& A, const Vec3& g, const Mat3& H, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
};

/// Point Q of B stays on a curve fixed in A.   φ = (n₁·e, n₂·e) ∈ ℝ² [m], e = x − c(s(x))
/// λ [N] are the forces on B at Q along the normals; A receives the opposite there.
/// γ and K are those of a closed joint; they leave out terms of the order of e.
struct PointOnCurve {
  static constexpr int kRows = 2;
  static constexpr bool kAngular = false;
  std::shared_ptr<const BodyCurve> curve;  ///< in axes of A
  Vec3 p_BQ;                               ///< from the centre of mass, axes of B [m]

  PointOnCurve carried(const Pose& X_CA, const Pose& X_CB) const;
  void residual(const Pose& A, const Pose& B, double* phi) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<2> J_A, JacobianBlock<2> J_B) const;
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
  std::string row_name(int) const;

 private:
  /// ∂φ_i/∂x = n_i + τ (t × n_i)·e ∇s, since n' = −(n·t') t + τ t × n with the twist τ.
  static Vec3 gradient(const BodyCurve::Near& at, int i);
  /// −(n_i·t') t ∇sᵀ + τ (t × n_i ∇sᵀ + ∇s (t × n_i)ᵀ), for e = 0.
  static Mat3 hessian(const BodyCurve::Near& at, int i);
};

/// Parameter s of the curve at point Q of B, and of a closed curve with its rounds.   ∇s = c'/D
/// λ acts on B at Q along ∇s, which is a force [N] where the curve passes 1 m per unit of s.
struct CurveParameter {
  static constexpr int kRows = 1;
  static constexpr bool kAngular = false;
  std::shared_ptr<const BodyCurve> curve;  ///< in axes of A
  Vec3 p_BQ;                               ///< from the centre of mass, axes of B [m]

  CurveParameter carried(const Pose& X_CA, const Pose& X_CB) const;
  double period() const;
  void residual(const Pose& A, const Pose& B, double* s) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const;
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
  std::string row_name(int) const;

 private:
  /// (∇s c''ᵀ + c'' ∇sᵀ + (c'''·e − 3 c'·c'') ∇s ∇sᵀ)/D, from D ṡ = c'·ẋ, differentiated.
  static Mat3 hessian(const BodyCurve::Near& at);
};

}  // namespace row_parts

}  // namespace taut
