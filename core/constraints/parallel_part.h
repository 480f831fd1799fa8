#pragma once

#include <string>

#include "core/constraints/row_parts.h"

namespace taut {
namespace row_parts {

/// Direction b of B points the way of a = u × v of A.                           (core/constraints, Eq. 7)
///   φ = (u·b, v·b) [rad, sines], and beyond a right angle the rotation vector that takes a to b,
///   (θ/sin θ) (a × b)·(v, −u)
/// so that axes which point opposite ways are open by π, and not closed.  λ [N·m] are torques on B about
/// b × u and b × v.
struct Parallel {
  static constexpr int kRows = 2;
  static constexpr bool kAngular = true;
  Vec3 u_A, v_A, b_B;  ///< unit vectors, body axes; u ⟂ v

  Parallel carried(const Pose& X_CA, const Pose& X_CB) const;
  void residual(const Pose& A, const Pose& B, double* phi) const;
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<2> J_A, JacobianBlock<2> J_B) const;
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const;
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const;
  std::string row_name(int i) const;
};

}  // namespace row_parts

}  // namespace taut
