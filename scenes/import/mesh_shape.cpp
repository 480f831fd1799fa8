#include "scenes/import/mesh_shape.h"

#include <cmath>

#include "collision/mesh/mesh_file.h"
#include "core/base/check.h"

namespace taut::model {

std::filesystem::path find_asset(const char* what, const std::filesystem::path& folder,
                                 std::string_view name) {
  const auto none = [what, name] { fail(what, "there is no such file", std::string(name.substr(0, 200))); };
  std::error_code error;
  for (std::string_view scheme : {"package://", "model://"}) {
    if (!name.starts_with(scheme)) continue;
    const std::string_view rest = name.substr(scheme.size());
    std::filesystem::path above = std::filesystem::absolute(folder, error);
    for (int i = 0; i < 100; ++i, above = above.parent_path())
      if (std::filesystem::is_regular_file(above / rest, error)) return above / rest;
    none();
  }
  if (name.starts_with("file://")) name.remove_prefix(7);
  const std::filesystem::path path = folder / name;
  if (!std::filesystem::is_regular_file(path, error)) none();
  return path;
}

TriangleMesh scaled_mesh(const std::filesystem::path& folder, std::string_view name, const Vec3& scale) {
  TriangleMesh mesh = read_mesh(find_asset("mesh", folder, name).string());
  for (Vec3& point : mesh.vertices) point = point.cwiseProduct(scale);
  if (scale.prod() < 0)
    for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  return mesh;
}

ConvexHull mesh_hull(const std::filesystem::path& folder, std::string_view name, const Vec3& scale) {
  ConvexHull hull{scaled_mesh(folder, name, scale).vertices};
  check_shape(hull);
  return hull;
}

namespace {

/// The corners of a triangle from an apex, and the volume of the tetrahedron.
struct Tetrahedron {
  Vec3 a, b, c;
  double volume;
};
Tetrahedron tetrahedron(const TriangleMesh& mesh, const std::array<int, 3>& triangle, const Vec3& apex,
                        MeshVolume kind) {
  const Vec3 a = mesh.vertices[triangle[0]] - apex, b = mesh.vertices[triangle[1]] - apex,
             c = mesh.vertices[triangle[2]] - apex;
  const double volume = a.dot(b.cross(c)) / 6;
  return {a, b, c, kind == MeshVolume::kLegacy ? std::abs(volume) : volume};
}

/// The mean of the surface.
Vec3 surface_centre(const TriangleMesh& mesh) {
  double area = 0;
  Vec3 centre = Vec3::Zero();
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
    const double part = (b - a).cross(c - a).norm() / 2;
    area += part;
    centre += part * (a + b + c) / 3;
  }
  return area > 0 ? Vec3(centre / area) : Vec3(Vec3::Zero());
}

}  // namespace

/// Twice the same sum: the centre from an apex on the mean of the surface, the rest from the centre.
LinkInertia mesh_inertia(const TriangleMesh& mesh, MeshVolume kind) {
  LinkInertia result;
  const Vec3 apex = surface_centre(mesh);
  double volume = 0;
  Vec3 moment = Vec3::Zero();
  for (const auto& triangle : mesh.triangles) {
    const Tetrahedron t = tetrahedron(mesh, triangle, apex, kind);
    volume += t.volume;
    moment += t.volume * (t.a + t.b + t.c) / 4;
  }
  if (!(volume > 0)) fail("mesh", "its volume must be positive", volume);
  result.centre = apex + moment / volume;
  Mat3 second = Mat3::Zero();  // ∫ x xᵀ dV about the centre
  for (const auto& triangle : mesh.triangles) {
    const Tetrahedron t = tetrahedron(mesh, triangle, result.centre, kind);
    const Vec3 sum = t.a + t.b + t.c;
    result.mass += t.volume;
    second += t.volume / 20 *
              (t.a * t.a.transpose() + t.b * t.b.transpose() + t.c * t.c.transpose() + sum * sum.transpose());
  }
  result.inertia = second.trace() * Mat3::Identity() - second;
  return result;
}

}  // namespace taut::model
