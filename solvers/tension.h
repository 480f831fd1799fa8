#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "solvers/mass_matrix.h"

namespace taut {

/// Bound on the fastest frequency [rad/s] of M q̈ = −K q, with K the blocks of geometric stiffness of the
/// joint loads: the largest ω with ω² = |M⁻¹K| over the bodies.  For ball joints K is block diagonal and the
/// bound rigorous; a row of rods of mass m and length L under tension H gives ω² = 12 H / (m L).
/// (solvers/README, "Tension")
inline double fastest_transverse_frequency(const MassMatrix& mass, std::span<const Pose> poses,
                                           std::span<const StiffnessBlocks> stiffness) {
  double largest = 0;  // ω²
  for (int b = 0; b < mass.size(); ++b) {
    const MassMatrix::Body& body = mass[b];
    if (body.fixed) continue;
    const Mat3 R = mass.principal_axes(b, poses[b]);
    const Vec3 root = body.inverse_moments.cwiseSqrt();
    const Mat3 turn = root.asDiagonal() * (R.transpose() * stiffness[b].rotation * R) * root.asDiagonal();
    // The maximum row sum bounds the spectral radius, and is exact where the load is along a principal axis.
    largest = std::max({largest, turn.cwiseAbs().rowwise().sum().maxCoeff(),
                        body.inverse_mass * stiffness[b].translation.cwiseAbs().rowwise().sum().maxCoeff()});
  }
  return std::sqrt(largest);
}

}  // namespace taut
