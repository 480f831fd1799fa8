#include "scenes/export/shape_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math/convex_hull.h"

namespace taut {
namespace {

constexpr double kPi = std::numbers::pi;

/// A point of a profile that turns about z, with its normal; equal points with two normals make an edge.
struct ProfilePoint {
  double r, z, normal_r, normal_z;
};

/// Surface of revolution of a profile from bottom to top.
DrawingMesh revolve(const std::vector<ProfilePoint>& profile, int segments) {
  DrawingMesh mesh;
  for (const ProfilePoint& point : profile)
    for (int i = 0; i <= segments; ++i) {
      const double angle = 2 * kPi * (i % segments) / segments, c = std::cos(angle), s = std::sin(angle);
      mesh.vertices.emplace_back(point.r * c, point.r * s, point.z);
      mesh.normals.emplace_back(point.normal_r * c, point.normal_r * s, point.normal_z);
    }
  for (std::size_t k = 0; k + 1 < profile.size(); ++k) {
    const ProfilePoint &low = profile[k], &high = profile[k + 1];
    if (low.r == high.r && low.z == high.z) continue;
    for (int i = 0; i < segments; ++i) {
      const int a = static_cast<int>(k) * (segments + 1) + i, b = a + 1, c = a + segments + 1, d = c + 1;
      if (low.r > 0) mesh.triangles.push_back({a, b, d});
      if (high.r > 0) mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

/// Quarter circles of a sphere, or of the caps of a capsule whose centres are at ±half.
std::vector<ProfilePoint> round_profile(double radius, double half, int segments) {
  std::vector<ProfilePoint> profile;
  const int quarter = std::max(2, segments / 4);
  const auto add = [&](int i, double centre) {
    const double angle = kPi / 2 * i / quarter;
    const double c = std::abs(i) == quarter ? 0 : std::cos(angle), s = std::sin(angle);
    profile.push_back({radius * c, centre + radius * s, c, s});
  };
  for (int i = -quarter; i <= 0; ++i) add(i, -half);
  for (int i = half > 0 ? 0 : 1; i <= quarter; ++i) add(i, half);
  return profile;
}

/// Triangles with corners of their own, so that edges stay sharp.
void add_flat(DrawingMesh& mesh, const std::vector<Vec3>& corners) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  const int first = static_cast<int>(mesh.vertices.size());
  for (const Vec3& corner : corners) {
    mesh.vertices.push_back(corner);
    mesh.normals.push_back(normal);
  }
  for (int i = 2; i < static_cast<int>(corners.size()); ++i)
    mesh.triangles.push_back({first, first + i - 1, first + i});
}

struct Mesher {
  int segments;
  double extent;

  DrawingMesh operator()(const Sphere& s) const {
    return revolve(round_profile(s.radius, 0, segments), segments);
  }
  DrawingMesh operator()(const Capsule& s) const {
    return revolve(round_profile(s.radius, s.length / 2, segments), segments);
  }
  DrawingMesh operator()(const Ellipsoid& s) const {
    DrawingMesh mesh = (*this)(Sphere{1});
    for (Vec3& v : mesh.vertices) v = v.cwiseProduct(s.radii);
    for (Vec3& n : mesh.normals) n = n.cwiseQuotient(s.radii).normalized();
    return mesh;
  }
  DrawingMesh operator()(const Cylinder& s) const {
    const double r = s.radius, h = s.length / 2;
    return revolve({{0, -h, 0, -1}, {r, -h, 0, -1}, {r, -h, 1, 0}, {r, h, 1, 0}, {r, h, 0, 1}, {0, h, 0, 1}},
                   segments);
  }
  DrawingMesh operator()(const Cone& s) const {
    const double r = s.radius, slope = std::hypot(r, s.height), nr = s.height / slope, nz = r / slope;
    const double base = -s.height / 4, apex = 3 * s.height / 4;
    return revolve({{0, base, 0, -1}, {r, base, 0, -1}, {r, base, nr, nz}, {0, apex, nr, nz}}, segments);
  }
  DrawingMesh operator()(const Box& s) const {
    DrawingMesh mesh;
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0}) {
        const Vec3 n = sign * Vec3::Unit(axis), u = Vec3::Unit((axis + 1) % 3), v = n.cross(u);
        std::vector<Vec3> corners{n - u - v, n + u - v, n + u + v, n - u + v};
        for (Vec3& corner : corners) corner = corner.cwiseProduct(s.size / 2);
        add_flat(mesh, corners);
      }
    return mesh;
  }
  DrawingMesh operator()(const ConvexHull& s) const {
    DrawingMesh mesh;
    const Polyhedron hull = convex_hull(s.points);
    for (const std::vector<int>& face : hull.faces) {
      std::vector<Vec3> corners;
      for (int corner : face) corners.push_back(hull.vertices[corner]);
      add_flat(mesh, corners);
    }
    return mesh;
  }
  DrawingMesh operator()(const TriangleMesh& s) const {
    DrawingMesh mesh;
    for (const auto& [a, b, c] : s.triangles) add_flat(mesh, {s.vertices[a], s.vertices[b], s.vertices[c]});
    return mesh;
  }
  DrawingMesh operator()(const HalfSpace&) const {
    const double e = extent / 2;
    DrawingMesh mesh;
    add_flat(mesh, {{-e, -e, 0}, {e, -e, 0}, {e, e, 0}, {-e, e, 0}});
    return mesh;
  }
  DrawingMesh operator()(const HeightField& s) const {
    const auto point = [&](int i, int j) {
      return Vec3((i - (s.nx - 1) / 2.0) * s.dx, (j - (s.ny - 1) / 2.0) * s.dy, s.heights[i + s.nx * j]);
    };
    DrawingMesh mesh;
    for (int j = 0; j + 1 < s.ny; ++j)
      for (int i = 0; i + 1 < s.nx; ++i) {
        add_flat(mesh, {point(i, j), point(i + 1, j), point(i + 1, j + 1)});
        add_flat(mesh, {point(i, j), point(i + 1, j + 1), point(i, j + 1)});
      }
    return mesh;
  }
};

}  // namespace

DrawingMesh drawing_mesh(const Shape& shape, int segments, double extent) {
  return std::visit(Mesher{segments, extent}, shape);
}

}  // namespace taut
