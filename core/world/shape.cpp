#include "core/world/shape.h"

#include <string>

#include "core/base/check.h"
#include "core/math/convex_hull.h"
#include "core/state/reach.h"

namespace taut {
namespace {

void require_all_positive(const char* name, const Vec3& sizes) {
  if (!sizes.allFinite() || sizes.minCoeff() <= 0) fail_with(name, "must be finite and positive", sizes);
  require_within_reach(name, sizes);
  if (sizes.minCoeff() < kSmallest) fail_with(name, "must not be below 1e-30", sizes);
}

void check(const Sphere& s) { require_size("sphere radius", s.radius); }
void check(const Box& s) { require_all_positive("box size", s.size); }
void check(const Ellipsoid& s) { require_all_positive("ellipsoid radii", s.radii); }
void check(const HalfSpace&) {}
void check(const ConvexHull& s) {
  for (std::size_t i = 0; i < s.points.size(); ++i)
    require_within_reach("convex hull point " + std::to_string(i), s.points[i]);
  convex_hull(s.points);
}
void check(const Capsule& s) {
  require_size("capsule radius", s.radius);
  require_not_negative("capsule length", s.length);
  if (s.length > 0) require_size("capsule length", s.length);
}
void check(const Cylinder& s) {
  require_size("cylinder radius", s.radius);
  require_size("cylinder length", s.length);
}
void check(const Cone& s) {
  require_size("cone radius", s.radius);
  require_size("cone height", s.height);
}

void check(const TriangleMesh& s) {
  if (s.triangles.empty()) fail("triangle mesh", "has no triangles", 0);
  for (std::size_t i = 0; i < s.vertices.size(); ++i)
    if (!within(s.vertices[i]))
      require_within_reach("triangle mesh vertex " + std::to_string(i), s.vertices[i]);
  const int count = static_cast<int>(s.vertices.size());
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const auto& [a, b, c] = s.triangles[t];
    for (int corner : {a, b, c})
      if (corner < 0 || corner >= count)
        fail("triangle mesh, triangle " + std::to_string(t), "no such vertex", corner);
    // Below 1e-12 of the square of its longest edge a triangle is a line to round-off.
    const Vec3 ab = s.vertices[b] - s.vertices[a], ac = s.vertices[c] - s.vertices[a];
    const double area = 0.5 * ab.cross(ac).norm();
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    if (!(area > 1e-12 * longest)) fail("triangle mesh, triangle " + std::to_string(t), "has no area", area);
  }
}

void check(const HeightField& s) {
  if (s.nx < 2) fail("height field nx", "needs at least two heights", s.nx);
  if (s.ny < 2) fail("height field ny", "needs at least two heights", s.ny);
  require_size("height field dx", s.dx);
  require_size("height field dy", s.dy);
  if (s.heights.size() != static_cast<std::size_t>(s.nx) * static_cast<std::size_t>(s.ny))
    fail("height field", "must have nx·ny heights", s.heights.size());
  for (std::size_t i = 0; i < s.heights.size(); ++i)
    if (!(std::abs(s.heights[i]) <= kFarthest)) {
      const std::string name = "height field height " + std::to_string(i);
      require_finite(name, s.heights[i]);
      fail(name, "must not be beyond 1e30", s.heights[i]);
    }
}

}  // namespace

const char* shape_name(const Shape& shape) {
  static constexpr const char* kNames[] = {"sphere",     "box",         "capsule",     "cylinder",
                                           "ellipsoid",  "cone",        "convex_hull", "triangle_mesh",
                                           "half_space", "height_field"};
  return kNames[shape.index()];
}

void check_shape(const Shape& shape) {
  std::visit([](const auto& s) { check(s); }, shape);
}

}  // namespace taut
