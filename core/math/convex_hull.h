#pragma once

#include <span>
#include <vector>

#include "core/math/so3.h"

namespace taut {

/// A convex polyhedron.  Faces are convex polygons, counter-clockwise seen from outside, coplanar triangles
/// merged; vertices are those of the input that are corners, in input order.
struct Polyhedron {
  std::vector<Vec3> vertices;
  std::vector<std::vector<int>> faces;
  std::vector<Vec3> normals;    ///< outward, unit, one per face
  std::vector<double> offsets;  ///< n·x ≤ offset inside
};

/// Convex hull of points [m] by quickhull [Barber1996].  Points nearer than
/// 1e-10·extent to a face count as on it.  O(n log n) as a rule, O(n²) at worst.
/// @throws std::invalid_argument for fewer than four points, a point that is not finite, or points that lie
/// in one plane to 1e-8 of their extent: "hull without volume".
Polyhedron convex_hull(std::span<const Vec3> points);

}  // namespace taut
