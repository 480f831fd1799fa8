#pragma once

#include <compare>

namespace taut {

/// Index of a material that has a name in its World; −1: none.
struct MaterialId {
  int index = -1;  ///< −1: none
  friend auto operator<=>(MaterialId, MaterialId) = default;
};

/// What a surface is made of.  Each shape has one; a pair of shapes gets combined(a, b) unless the World
/// holds one for these shapes, or for their materials by name.
struct Material {
  double restitution = 0;         ///< Newton's e ∈ [0, 1]: normal speed after over before an impact
  double static_friction = 0.5;   ///< Coulomb's μ while sticking, ≥ dynamic_friction
  double dynamic_friction = 0.5;  ///< Coulomb's μ while sliding
  double rolling_friction = 0;  ///< length δ of the rolling resistance [m]: torque ≤ δ λ_n across the normal
  double spinning_friction =
      0;                  ///< length of the drilling friction [m]: torque ≤ it times λ_n about the normal
  double compliance = 0;  ///< [m/N] along the normal, and across it while friction holds; 0: rigid
  /// c [m·s] of rolling resistance proportional to the rate: torque −c λ_n ω_t [N·m] on B across the normal,
  /// with ω_t [rad/s] of B against A; added to that of `rolling_friction`.
  double rolling_friction_linear = 0;
  /// c [m·s] of drilling friction proportional to the rate: torque −c λ_n ω_n [N·m] on B about the normal,
  /// with ω_n [rad/s] of B against A; added to that of `spinning_friction`.
  double spinning_friction_linear = 0;

  friend bool operator==(const Material&, const Material&) = default;
};

/// @throws std::invalid_argument unless 0 ≤ restitution ≤ 1, the others are finite and ≥ 0, and static
/// friction is not below dynamic friction.
void check_material(const Material& material);

/// The contact between two materials: the lower restitution; the geometric mean of the Coulomb coefficients,
/// so that ice on rubber is slippery and equals keep their value; the larger of each number of rolling and of
/// spinning (a hard ball rolls badly on a soft carpet); the sum of the compliances (two springs in series).
Material combined(const Material& a, const Material& b);

}  // namespace taut
