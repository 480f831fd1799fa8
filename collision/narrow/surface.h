#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/world/shape.h"

namespace taut::detail {

/// What a triangle's edge i → i+1 has behind it.  Only a boundary or convex edge can be touched; a flat or
/// concave one never shows its own normal.
enum class EdgeKind : char { kBoundary, kFlat, kConcave, kConvex };

struct Bvh;  // FCL's tree of boxes

/// Triangles with their neighbours, from a mesh or a height field.
class Surface {
 public:
  /// @pre checked by check_shape().
  explicit Surface(const TriangleMesh& mesh);
  explicit Surface(const HeightField& field);
  ~Surface();
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;

  /// Triangles whose boxes meet the box [low, high] of the surface's frame, in ascending order.
  void overlapping(const Vec3& low, const Vec3& high, std::vector<int>& out) const;

  /// The triangle of a height field that the point is below; −1: it is above or beside the field, or this is
  /// a mesh.
  int triangle_above(const Vec3& point) const;

  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
  std::vector<Vec3> normals;
  std::vector<std::array<int, 3>> neighbours;  ///< across edge i → i+1; −1: none, or not exactly one
  std::vector<std::array<EdgeKind, 3>> edges;
  bool solid_below = false;  ///< a height field has no back side
  Vec3 low, high;            ///< box around everything

 private:
  void connect();
  std::unique_ptr<Bvh> bvh_;  // meshes
  int nx_ = 0, ny_ = 0;       // height fields
  double dx_ = 0, dy_ = 0;
};

}  // namespace taut::detail
