#pragma once

#include <span>
#include <vector>

#include "core/world/rigid_body.h"
#include "core/world/shape.h"

namespace taut {

/// Volume integrals of a uniform solid of density 1, in the frame of its shape.
struct SolidProperties {
  double volume = 0;            ///< ∫ dV [m³]
  Vec3 centre = Vec3::Zero();   ///< ∫ x dV / volume [m]
  Mat3 inertia = Mat3::Zero();  ///< ∫ (|x|² 1 − x xᵀ) dV about the centre [m⁵]
};

/// Closed forms for the primitives; hull and closed mesh by the divergence theorem: sums over the tetrahedra
/// from a point inside to each triangle, exact for polyhedra (core/world, Eq. 5).
/// @throws std::invalid_argument for what check_shape() refuses, a half-space or height field (no volume),
/// and a mesh that is open (an edge without exactly one neighbour of the same sense, named) or inside out.
SolidProperties solid_properties(const Shape& shape);

/// Mass properties of one or several shapes on one body.
struct Solid {
  MassProperties mass{1.0, Vec3(1, 1, 1)};  ///< about the centre, in the axes of the frame given
  Vec3 centre = Vec3::Zero();               ///< centre of mass in that frame [m]
  /// The parts with poses from the centre of mass, as World::add_shape() wants them.
  std::vector<PlacedShape> parts;
};

/// Sum of the parts; where they overlap, the overlap counts twice.
/// @throws std::invalid_argument for no part, what solid_properties() refuses, or a density that is not
/// positive.
Solid solid_of(std::span<const PlacedShape> parts);

}  // namespace taut
