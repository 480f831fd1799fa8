#include "scenes/export/coil.h"

#include <cmath>
#include <numbers>

namespace taut {
namespace {

constexpr double kWire = 0.16;  // radius of the wire, part of the radius of the coil
constexpr double kEnds = 0.1;   // length of each straight end, part of the whole

/// The middle of the wire: out of the axis and back to it within the first and the last half turn.
Vec3 helix_point(double part, int turns) {
  const double angle = 2 * std::numbers::pi * turns * part;
  const double radius = std::min({1.0, 2 * turns * part, 2 * turns * (1 - part)});
  return {radius * std::cos(angle), radius * std::sin(angle), (1 - 2 * kEnds) * (part - 0.5)};
}

}  // namespace

DrawingMesh coil_mesh(int turns, int corners_per_turn, int corners_of_wire) {
  // Made with r = kCoilSlimness and L = 1, where the wire is round, and widened at the end.
  const auto slim = [](const Vec3& p) { return Vec3(kCoilSlimness * p.x(), kCoilSlimness * p.y(), p.z()); };
  std::vector<Vec3> line{{0, 0, -0.5}};
  const int steps = turns * corners_per_turn;
  for (int i = 0; i <= steps; ++i) line.push_back(slim(helix_point(static_cast<double>(i) / steps, turns)));
  line.emplace_back(0, 0, 0.5);

  DrawingMesh mesh;
  const int rings = static_cast<int>(line.size()), n = corners_of_wire;
  Vec3 side = Vec3::UnitX();
  for (int k = 0; k < rings; ++k) {
    const Vec3 along = (line[std::min(k + 1, rings - 1)] - line[std::max(k - 1, 0)]).normalized();
    side = (side - side.dot(along) * along).normalized();  // turns no more about the line than it must
    const Vec3 up = along.cross(side);
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      const Vec3 normal = std::cos(angle) * side + std::sin(angle) * up;
      const Vec3 p = line[k] + kWire * kCoilSlimness * normal;
      mesh.vertices.emplace_back(p.x() / kCoilSlimness, p.y() / kCoilSlimness, p.z());
      // Of a surface that is widened in x and y, the normal is narrowed there.
      mesh.normals.push_back(slim(normal).normalized());
      if (k == 0) continue;
      const int a = (k - 1) * n + i, b = (k - 1) * n + (i + 1) % n, c = a + n, d = b + n;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

}  // namespace taut
