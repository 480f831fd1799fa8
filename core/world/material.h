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

  friend bool operator==(const Material&, const Material&) = default;
};

/// @throws std::invalid_argument unless 0 ≤ restitution ≤ 1, the others are finite and ≥ 0, and static
/// friction is not below dynamic friction.
void check_material(const Material& material);

/// The contact between two materials: the lower restitution; the geometric mean of the Coulomb coefficients,
/// so that ice on rubber is slippery and equals keep their value; the larger rolling and spinning length (a
/// hard ball rolls badly on a soft carpet); the sum of the compliances (two springs in series).
Material combined(const Material& a, const Material& b);

}  // namespace taut
