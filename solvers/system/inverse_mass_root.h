#pragma once

#include "core/math/so3.h"
#include "core/state/state.h"

namespace taut {

/// A square root of M⁻¹ of a body: M⁻¹ = A Aᵀ with A = diag(rotation, translation 1₃); zero for fixed ones.
struct InverseMassRoot {
  Mat3 rotation = Mat3::Zero();  ///< A of the rotation, A Aᵀ = I_W⁻¹
  double translation = 0;        ///< 1 / √m

  bool moves() const { return translation > 0; }  ///< not fixed
  /// V = M⁻¹ p.  The root is not multiplied out: of a thin rod, round-off then is a rotation about its axis
  /// only, which moves no point on it, be it held by a joint or a stiff damper.
  Twist twist(const Wrench& p) const {
    return {rotation * Vec3(rotation.transpose() * p.torque), translation * translation * p.force};
  }
};

/// A root of what takes the place of M⁻¹ where that has two full blocks.
struct FullMassRoot {
  Mat3 rotation = Mat3::Zero(), translation = Mat3::Zero();  ///< one block each
};

}  // namespace taut
