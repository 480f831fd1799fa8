#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/constraints/part_store.h"
#include "core/constraints/row_parts.h"
#include "core/state/motion.h"

/// Row parts of several bodies, or that change with time.  They know the indices of their bodies in the world
/// and their sides in Joint::bodies(); their Jacobian blocks come zeroed.  Those here are `kCarried`: a
/// relocation to bodies that carry theirs moves them into the axes of these.
namespace taut {
namespace row_parts {

/// A linear relation between free axes (core/constraints, Eq. 9).   φ = Σ c_k θ_k(q) − offset
/// λ is the force or torque along the last axis, whose unit φ has, if its factor is 1; c_k λ along axis k.
struct Coupling {
  static constexpr bool kWide = true;
  static constexpr bool kCarried = true;
  static constexpr int kRows = 1;
  static constexpr std::size_t kMaxBodies = 8;                ///< of one axis
  struct Term {                                               ///< One of the axes.
    double factor = 1;                                        ///< c_k
    std::shared_ptr<const detail::PartStoreBase> coordinate;  ///< θ_k
    std::vector<int> sides;                                   ///< of the coordinate's bodies, in the joint
  };
  std::vector<Term> terms;  ///< of the sum
  double offset = 0;        ///< [unit of the last axis]
  bool is_angle = false;    ///< that unit is the radian; otherwise the metre

  bool angular() const { return is_angle; }
  void residual(const Configuration& at, double* phi) const;
  void jacobian(const Configuration& at, detail::SideBlocks J) const;
  void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const;
  void stiffness(const Configuration& at, const double* lambda, std::span<StiffnessBlocks> bodies) const;
  void update_axes(const Configuration& at, std::span<double> axes) const;
  std::string row_name(int) const;
  Coupling relocated(const Relocation& to) const;
};

/// A relation between free axes that follows the time.   φ = Σ c_k θ_k(q) − offset − f(t)
struct DrivenCoupling : Coupling {
  Motion motion;  ///< f

  void residual(const Configuration& at, double* phi) const;
  void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const;
  void add_rate(const Configuration& at, double* out) const;
  std::string row_name(int) const;
  DrivenCoupling relocated(const Relocation& to) const;
};

/// B has a pose X*(t) = (q*, p*) relative to A.
///   φ = (p_AB − p*, 2 vec(q*⁻¹ q_AB)) ∈ ℝ⁶ [m, m, m, rad, rad, rad], p_AB = R_AW (p_B − p_A)
/// λ₁₋₃ is the force on B in axes of A, at its centre; λ₄₋₆ the torque on B in axes of the target frame.
/// Translation and rotation are two parts, so that a row is of one kind.
struct DrivenPosition {
  static constexpr bool kWide = true;
  static constexpr bool kCarried = true;
  static constexpr int kRows = 3;
  static constexpr bool kAngular = false;
  int body_a, body_b;  ///< indices in the world
  PoseMotion motion;   ///< X*
  Pose X_A{}, X_B{};   ///< of the frames meant by A and B on the bodies

  PointInPlane row(int i) const;  ///< along axis i of A
  void residual(const Configuration& at, double* phi) const;
  void jacobian(const Configuration& at, detail::SideBlocks J) const;
  void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const;
  void add_rate(const Configuration& at, double* out) const;
  void stiffness(const Configuration& at, const double* lambda, std::span<StiffnessBlocks> bodies) const;
  std::string row_name(int i) const;
  DrivenPosition relocated(const Relocation& to) const;
};
/// The rows of rotation of such a driver, φ = 2 vec(q*⁻¹ q_AB) ∈ ℝ³ [rad].
struct DrivenOrientation {
  static constexpr bool kWide = true;
  static constexpr bool kCarried = true;
  static constexpr int kRows = 3;
  static constexpr bool kAngular = true;
  int body_a, body_b;  ///< indices in the world
  PoseMotion motion;   ///< X*
  Pose X_A{}, X_B{};   ///< of the frames meant by A and B on the bodies

  Orientation part(const PosePoint& target) const;  ///< at rest there
  void residual(const Configuration& at, double* phi) const;
  void jacobian(const Configuration& at, detail::SideBlocks J) const;
  /// The target frame F turns with ω_F = ω_A + R_WA ω*: the bias is that of an orientation row against a body
  /// that turns so, less E R_FW (R_WA ω̇* + ω_A × R_WA ω*), the acceleration of F that A does not have.
  void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const;
  void add_rate(const Configuration& at, double* out) const;
  void stiffness(const Configuration&, const double*, std::span<StiffnessBlocks>) const {}
  std::string row_name(int i) const;
  DrivenOrientation relocated(const Relocation& to) const;

 private:
  /// E R_FW with φ̇ = E R_FW (ω_B − ω_F).
  Mat3 rate_matrix(const Configuration& at, const PosePoint& target) const;
};

}  // namespace row_parts

}  // namespace taut
