#include "core/world/solid.h"

#include <map>
#include <string>

#include "core/base/check.h"
#include "core/math/convex_hull.h"

namespace taut {
namespace {

/// ∫ x xᵀ dV → ∫ (|x|² 1 − x xᵀ) dV.
Mat3 inertia_of_moments(const Mat3& second) { return second.trace() * Mat3::Identity() - second; }

/// Sum of signed tetrahedra (origin, a, b, c): V = det/6, ∫x = V (a+b+c)/4,
/// ∫x xᵀ = V/20 (a aᵀ + b bᵀ + c cᵀ + (a+b+c)(a+b+c)ᵀ).                                (core/world, Eq. 5)
class TetrahedraSum {
 public:
  explicit TetrahedraSum(const Vec3& origin) : origin_(origin) {}
  void add(Vec3 a, Vec3 b, Vec3 c) {
    a -= origin_, b -= origin_, c -= origin_;
    const double V = a.dot(b.cross(c)) / 6;
    const Vec3 sum = a + b + c;
    volume_ += V;
    first_ += V / 4 * sum;
    second_ += V / 20 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  SolidProperties result() const {
    const Vec3 centre = first_ / volume_;
    const Mat3 central = second_ - volume_ * centre * centre.transpose();
    return {volume_, origin_ + centre, inertia_of_moments(central)};
  }
  double volume() const { return volume_; }

 private:
  Vec3 origin_;
  double volume_ = 0;
  Vec3 first_ = Vec3::Zero();
  Mat3 second_ = Mat3::Zero();
};

SolidProperties from_mass(const MassProperties& unit_density) {
  return {unit_density.mass(), Vec3::Zero(), unit_density.inertia_B()};
}

constexpr Density kOne{1};
SolidProperties properties(const Sphere& s) { return from_mass(MassProperties::sphere(s.radius, kOne)); }
SolidProperties properties(const Box& s) { return from_mass(MassProperties::box(s.size, kOne)); }
SolidProperties properties(const Ellipsoid& s) { return from_mass(MassProperties::ellipsoid(s.radii, kOne)); }
SolidProperties properties(const Cone& s) {
  return from_mass(MassProperties::cone(s.radius, s.height, kOne));
}
SolidProperties properties(const Capsule& s) {
  return from_mass(MassProperties::capsule(s.radius, s.length, kOne));
}
SolidProperties properties(const Cylinder& s) {
  return from_mass(MassProperties::cylinder(s.radius, s.length, kOne));
}

SolidProperties properties(const ConvexHull& s) {
  const Polyhedron hull = convex_hull(s.points);
  TetrahedraSum sum(hull.vertices[0]);
  for (const auto& face : hull.faces)
    for (std::size_t i = 2; i < face.size(); ++i)
      sum.add(hull.vertices[face[0]], hull.vertices[face[i - 1]], hull.vertices[face[i]]);
  return sum.result();
}

/// Each edge must be walked once in each direction.
void require_closed(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> walked;
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) ++walked[{t[i], t[(i + 1) % 3]}];
  for (const auto& [edge, count] : walked) {
    const auto back = walked.find({edge.second, edge.first});
    if (count == 1 && back != walked.end() && back->second == 1) continue;
    fail("mass of triangle mesh", "the mesh is not closed at the edge between vertices",
         std::to_string(edge.first) + " and " + std::to_string(edge.second));
  }
}

SolidProperties properties(const TriangleMesh& s) {
  require_closed(s);
  TetrahedraSum sum(s.vertices[s.triangles[0][0]]);
  for (const auto& [a, b, c] : s.triangles) sum.add(s.vertices[a], s.vertices[b], s.vertices[c]);
  if (!(sum.volume() > 0)) fail("mass of triangle mesh", "the mesh is inside out; volume [m³]", sum.volume());
  return sum.result();
}

SolidProperties properties(const HalfSpace&) { fail("mass of half-space", "has no volume", "half_space"); }
SolidProperties properties(const HeightField&) {
  fail("mass of height field", "has no volume", "height_field");
}

}  // namespace

SolidProperties solid_properties(const Shape& shape) {
  check_shape(shape);
  return std::visit([](const auto& s) { return properties(s); }, shape);
}

Solid solid_of(std::span<const PlacedShape> parts) {
  if (parts.empty()) fail("solid", "needs at least one part", parts.size());
  double mass = 0;
  Vec3 first = Vec3::Zero();
  std::vector<SolidProperties> solids;
  for (const PlacedShape& part : parts) {
    require_positive("density", part.density);
    require_all_finite("position of a part", part.pose.p);
    require_unit("orientation of a part", part.pose.q.coeffs());
    solids.push_back(solid_properties(part.shape));
    mass += part.density * solids.back().volume;
    first += part.density * solids.back().volume * part.pose.point(solids.back().centre);
  }
  Solid result;
  result.centre = first / mass;
  Mat3 inertia = Mat3::Zero();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Mat3 R = parts[i].pose.q.toRotationMatrix();
    const Vec3 d = parts[i].pose.point(solids[i].centre) - result.centre;
    const Mat3 shifted =
        R * solids[i].inertia * R.transpose() + solids[i].volume * inertia_of_moments(d * d.transpose());
    inertia += parts[i].density * shifted;
  }
  result.mass = MassProperties(mass, inertia);
  result.parts.assign(parts.begin(), parts.end());
  for (PlacedShape& part : result.parts) part.pose.p -= result.centre;
  return result;
}

}  // namespace taut
