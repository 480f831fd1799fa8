#pragma once

#include <array>
#include <vector>

#include "core/world/shape.h"

namespace taut {

/// Triangles that look like a shape, counter-clockwise seen from outside.
struct DrawingMesh {
  std::vector<Vec3> vertices;
  std::vector<Vec3> normals;  ///< outward, unit, one per vertex
  std::vector<std::array<int, 3>> triangles;
};

/// The surface of a shape.  Round shapes get `segments` corners around and half as many from pole to pole;
/// all their vertices lie on the surface.  A half-space is a square of edge length `extent` [m] around its
/// origin.
/// @pre segments ≥ 4 and even
DrawingMesh drawing_mesh(const Shape& shape, int segments = 16, double extent = 20);

}  // namespace taut
