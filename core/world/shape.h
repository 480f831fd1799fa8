#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "core/state/relocation.h"
#include "core/state/state.h"
#include "core/world/material.h"

namespace taut {

// Shapes are plain data in their own frame S; lengths [m].  The axis of revolution is z.  The origin of a
// solid of revolution, box or ellipsoid is its centre of mass, as in MassProperties.

struct Sphere {       ///< A ball.
  double radius = 0;  ///< greater than 0
};
struct Box {                 ///< A cuboid with edges along the axes of S.
  Vec3 size = Vec3::Zero();  ///< full edge lengths
};
/// A cylinder of this length with a half-sphere at each end; length 0 is a sphere.
struct Capsule {
  double radius = 0, length = 0;  ///< of the caps, or between their centres
};
struct Cylinder {                 ///< A cylinder between z = ±½ length.
  double radius = 0, length = 0;  ///< of the base, or between both bases
};
struct Ellipsoid {            ///< An ellipsoid with its principal axes along the axes of S.
  Vec3 radii = Vec3::Zero();  ///< along x, y and z
};
/// Apex at z = ¾ height, base at z = −¼ height.
struct Cone {
  double radius = 0, height = 0;  ///< of the base, or from it to the apex
};
/// The smallest convex body around the points; points inside it are ignored.
struct ConvexHull {
  std::vector<Vec3> points;  ///< four or more, not in one plane
};
/// Corners of each triangle counter-clockwise seen from outside.  A mesh need not be closed; only its outside
/// is solid to the touch, and only a closed one has a mass.
struct TriangleMesh {
  std::vector<Vec3> vertices;                 ///< corners of the triangles
  std::vector<std::array<int, 3>> triangles;  ///< three indices of vertices each
};
/// All points with z ≤ 0: the ground, with the outward normal +z.
struct HalfSpace {};
/// Ground whose height is z = heights[i + nx j] at x = (i − (nx − 1)/2) dx, y = (j − (ny − 1)/2) dy, linear
/// on two triangles per cell with the diagonal from (i, j) to (i+1, j+1), and solid below.
struct HeightField {
  int nx = 0, ny = 0;           ///< number of heights along the axis, 2 or more
  double dx = 0, dy = 0;        ///< their distance along the axis
  std::vector<double> heights;  ///< nx × ny, x fastest
};
/// Any shape.
using Shape = std::variant<Sphere, Box, Capsule, Cylinder, Ellipsoid, Cone, ConvexHull, TriangleMesh,
                           HalfSpace, HeightField>;

/// "sphere", "box", "capsule", "cylinder", "ellipsoid", "cone", "convex_hull", "triangle_mesh" and so on.
const char* shape_name(const Shape& shape);

/// @throws std::invalid_argument naming the size that is not finite and positive (only the length of a
/// capsule may be zero), a vertex that is not finite, a hull without volume, a mesh without triangles, with a
/// corner that does not exist or with a triangle without area, a height field with fewer than 2×2 heights or
/// with a wrong number of them.
void check_shape(const Shape& shape);

/// One part of a body: a shape at a pose X_BS in the body frame.
struct PlacedShape {
  Shape shape;            ///< in its own frame S
  Pose pose{};            ///< X_BS
  double density = 1000;  ///< [kg/m³], read by solid_of() only
};

/// Who may touch whom: a pair is considered if each one's groups share a bit with the other's mask.
struct CollisionFilter {
  std::uint32_t groups = 1;         ///< what the shape is
  std::uint32_t mask = 0xffffffff;  ///< what it may touch
};

/// A shape as the World holds it; immutable but for its material.
struct ShapeRecord {
  BodyId body;                         ///< that it moves with
  std::shared_ptr<const Shape> shape;  ///< in its own frame S
  Pose pose;                           ///< X_BS
  Material material;                   ///< of its surface
  CollisionFilter filter;              ///< whom it may touch
  MaterialId named;                    ///< what `material` is, if it has a name
  BodyId owner{};  ///< the body that says whom it may touch: `body`, unless that carries it (merged_world.h)
};

}  // namespace taut
