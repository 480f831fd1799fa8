#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/motion.h"
#include "core/part_store.h"

/// Row parts of several bodies, or that change with time.  They know the indices of their bodies in the world
/// and their sides in Joint::bodies(); their Jacobian blocks come zeroed.
namespace taut::row_parts {

/// A linear relation between free axes.   φ = Σ c_k θ_k(q) − offset [unit of the last axis]
/// λ is the force or torque along the last axis if its factor is 1; c_k λ acts along axis k.  (Eq. 16)
struct Coupling {
  static constexpr bool kWide = true;
  static constexpr int kRows = 1;
  static constexpr std::size_t kMaxBodies = 8;  ///< of one axis
  struct Term {
    double factor = 1;
    std::shared_ptr<const detail::PartStoreBase> coordinate;
    std::vector<int> sides;  ///< of the coordinate's bodies, in the joint
  };
  std::vector<Term> terms;
  double offset = 0;
  bool is_angle = false;

  bool angular() const { return is_angle; }
  void residual(const Configuration& at, double* phi) const {
    *phi = -offset;
    for (const Term& term : terms) {
      double theta;
      term.coordinate->residual(at, &theta);
      *phi += term.factor * theta;
    }
  }
  void jacobian(const Configuration& at, detail::SideBlocks J) const {
    std::array<double, 6 * kMaxBodies> values;
    for (const Term& term : terms) {
      values.fill(0);
      term.coordinate->jacobian(at, values.data());
      for (std::size_t s = 0; s < term.sides.size(); ++s)
        for (int k = 0; k < 6; ++k) J[term.sides[s]][k] += term.factor * values[6 * s + k];
    }
  }
  void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const {
    *gamma = 0;
    for (const Term& term : terms) {
      double bias;
      term.coordinate->bias(at, twists, &bias);
      *gamma += term.factor * bias;
    }
  }
  void stiffness(const Configuration& at, const double* lambda, std::span<StiffnessBlocks> bodies) const {
    for (const Term& term : terms) {
      const double along = term.factor * *lambda;
      term.coordinate->stiffness(at, &along, bodies);
    }
  }
  void update_axes(const Configuration& at, std::span<double> axes) const {
    for (const Term& term : terms) term.coordinate->update_axes(at, axes);
  }
  std::string row_name(int) const { return is_angle ? "rotation by the coupling" : "coupling"; }
};

/// A relation between free axes that follows the time.   φ = Σ c_k θ_k(q) − offset − f(t)
struct DrivenCoupling : Coupling {
  Motion motion;

  void residual(const Configuration& at, double* phi) const {
    Coupling::residual(at, phi);
    *phi -= motion(at.time).value;
  }
  void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const {
    Coupling::bias(at, twists, gamma);
    *gamma -= motion(at.time).acceleration;
  }
  void add_rate(const Configuration& at, double* out) const { *out -= motion(at.time).rate; }
  std::string row_name(int) const { return is_angle ? "rotation by the driver" : "driver"; }
};

/// B has a pose X*(t) = (q*, p*) relative to A.
///   φ = (p_AB − p*, 2 vec(q*⁻¹ q_AB)) ∈ ℝ⁶ [m, m, m, rad, rad, rad], p_AB = R_AW (p_B − p_A)   (Eq. 17)
/// λ₁₋₃ is the force on B in axes of A, at its centre; λ₄₋₆ the torque on B in axes of the target frame.
/// Translation and rotation are two parts, so that a row is of one kind.
struct DrivenPosition {
  static constexpr bool kWide = true;
  static constexpr int kRows = 3;
  static constexpr bool kAngular = false;
  int body_a, body_b;
  PoseMotion motion;

  static PointInPlane row(int i) { return {Vec3::Zero(), Vec3::Unit(i), Vec3::Zero()}; }
  void residual(const Configuration& at, double* phi) const {
    const Vec3 target = motion(at.time).pose.p;
    for (int i = 0; i < 3; ++i) {
      row(i).residual(at.poses[body_a], at.poses[body_b], phi + i);
      phi[i] -= target[i];
    }
  }
  void jacobian(const Configuration& at, detail::SideBlocks J) const {
    for (int i = 0; i < 3; ++i)
      row(i).jacobian(at.poses[body_a], at.poses[body_b], JacobianBlock<1>(J[0] + 6 * i),
                      JacobianBlock<1>(J[1] + 6 * i));
  }
  void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const {
    const Vec3 target = motion(at.time).acceleration.v;
    for (int i = 0; i < 3; ++i) {
      row(i).bias(at.poses[body_a], at.poses[body_b], twists[body_a], twists[body_b], gamma + i);
      gamma[i] -= target[i];
    }
  }
  void add_rate(const Configuration& at, double* out) const {
    Eigen::Map<Vec3>{out} -= motion(at.time).velocity.v;
  }
  void stiffness(const Configuration& at, const double* lambda, std::span<StiffnessBlocks> bodies) const {
    for (int i = 0; i < 3; ++i)
      row(i).stiffness(at.poses[body_a], at.poses[body_b], lambda + i, bodies[body_a], bodies[body_b]);
  }
  std::string row_name(int i) const { return std::string("translation driven along A's ") + axis_name(i); }
};

struct DrivenOrientation {
  static constexpr bool kWide = true;
  static constexpr int kRows = 3;
  static constexpr bool kAngular = true;
  int body_a, body_b;
  PoseMotion motion;

  static Orientation part(const PosePoint& target) { return {target.pose.q, Quat::Identity()}; }
  void residual(const Configuration& at, double* phi) const {
    part(motion(at.time)).residual(at.poses[body_a], at.poses[body_b], phi);
  }
  void jacobian(const Configuration& at, detail::SideBlocks J) const {
    part(motion(at.time))
        .jacobian(at.poses[body_a], at.poses[body_b], JacobianBlock<3>(J[0]), JacobianBlock<3>(J[1]));
  }
  /// The target frame F turns with ω_F = ω_A + R_WA ω*: the bias is that of an orientation row against a body
  /// that turns so, less E R_FW (R_WA ω̇* + ω_A × R_WA ω*), the acceleration of F that A does not have.
  void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const {
    const PosePoint target = motion(at.time);
    const Pose &A = at.poses[body_a], &B = at.poses[body_b];
    const Vec3 w = A.q * target.velocity.w, w_A = twists[body_a].w;
    part(target).bias(A, B, {w_A + w, Vec3::Zero()}, twists[body_b], gamma);
    Eigen::Map<Vec3>{gamma} -= rate_matrix(at, target) * (A.q * target.acceleration.w + w_A.cross(w));
  }
  void add_rate(const Configuration& at, double* out) const {
    const PosePoint target = motion(at.time);
    Eigen::Map<Vec3>{out} -= rate_matrix(at, target) * (at.poses[body_a].q * target.velocity.w);
  }
  void stiffness(const Configuration&, const double*, std::span<StiffnessBlocks>) const {}
  std::string row_name(int i) const { return std::string("rotation driven about target ") + axis_name(i); }

 private:
  /// E R_FW with φ̇ = E R_FW (ω_B − ω_F).
  Mat3 rate_matrix(const Configuration& at, const PosePoint& target) const {
    std::array<double, 36> values;
    part(target).jacobian(at.poses[body_a], at.poses[body_b], JacobianBlock<3>(values.data()),
                          JacobianBlock<3>(values.data() + 18));
    return JacobianBlock<3>(values.data() + 18).leftCols<3>();
  }
};

}  // namespace taut::row_parts
