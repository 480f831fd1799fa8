#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "solvers/system/mass_matrix.h"

namespace taut {

/// Bound on the fastest frequency [rad/s] of M q̈ = −K q, with K the blocks of geometric stiffness of the
/// joint loads: the largest ω with ω² = |M⁻¹K| over the bodies.  For ball joints K is block diagonal and the
/// bound rigorous; a row of rods of mass m and length L under tension H gives ω² = 12 H / (m L).
/// `roots` are those of M⁻¹ = A Aᵀ.        (solvers/integrators, "Tension")
inline double fastest_transverse_frequency(std::span<const InverseMassRoot> roots,
                                           std::span<const StiffnessBlocks> stiffness) {
  // The maximum row sum of |Aᵀ K A| bounds its spectral radius, and is exact where the load is along a
  // principal axis.
  const auto row_sum = [](const Mat3& K) {
    const double xy = std::abs(K(0, 1)), xz = std::abs(K(0, 2)), yz = std::abs(K(1, 2));
    return std::max({std::abs(K(0, 0)) + xy + xz, xy + std::abs(K(1, 1)) + yz, xz + yz + std::abs(K(2, 2))});
  };
  double largest = 0;  // ω²
  for (std::size_t b = 0; b < roots.size(); ++b) {
    const Mat3& A = roots[b].rotation;
    const double t = roots[b].translation;
    const Mat3 KA = stiffness[b].rotation.lazyProduct(A);
    largest = std::max(
        {largest, row_sum(A.transpose().lazyProduct(KA)), t * t * row_sum(stiffness[b].translation)});
  }
  return std::sqrt(largest);
}

}  // namespace taut
