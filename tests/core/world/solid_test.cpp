#include "core/world/solid.h"

#include <numbers>

#include "core/math/convex_hull.h"
#include "tests/core/expect_invalid.h"
#include "tests/core/random_state.h"

namespace taut::solid_test {
namespace {

using testing::expect_invalid;
using testing::Random;

ConvexHull box_points(const Vec3& size, const Pose& X) {
  ConvexHull hull;
  for (int k = 0; k < 8; ++k)
    hull.points.push_back(
        X.point(0.5 * size.cwiseProduct(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1))));
  return hull;
}

/// The faces of a hull as triangles.
TriangleMesh mesh_of(const Polyhedron& hull) {
  TriangleMesh mesh{hull.vertices, {}};
  for (const auto& face : hull.faces)
    for (std::size_t i = 2; i < face.size(); ++i) mesh.triangles.push_back({face[0], face[i - 1], face[i]});
  return mesh;
}

TEST(ConvexHull, OfABoxHasSixQuadranglesInAnyPose) {
  Random random(41);
  for (int trial = 0; trial < 100; ++trial) {
    ConvexHull shape = box_points(Vec3(1, 2, 3), random.pose());
    // Points inside, on faces and twice the same change nothing.
    const auto corners = shape.points;
    for (int i = 0; i < 30; ++i) {
      const Vec3 &a = corners[i % 8], &b = corners[(i * 5 + 3) % 8];
      shape.points.push_back(a + random.uniform(0, 1) * (b - a));
    }
    const Polyhedron hull = convex_hull(shape.points);
    EXPECT_EQ(hull.vertices.size(), 8u);
    ASSERT_EQ(hull.faces.size(), 6u);
    for (const auto& face : hull.faces) EXPECT_EQ(face.size(), 4u);
  }
}

TEST(ConvexHull, HoldsAllPointsIsClosedAndConvex) {
  Random random(42);
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<Vec3> points;
    const int count = 4 + trial * 5;
    for (int i = 0; i < count; ++i) {
      Vec3 p = trial % 3 == 0 ? random.unit() : random.vector();
      if (trial % 3 == 2) p = (4 * p).array().round() / 4;  // many coplanar and repeated points
      points.push_back(p);
    }
    Polyhedron hull;
    try {
      hull = convex_hull(points);
    } catch (const std::invalid_argument&) {
      EXPECT_LT(count, 10);
      continue;
    }
    // Points within 1e-10 of the extent count as on a face.
    for (std::size_t f = 0; f < hull.faces.size(); ++f)
      for (const Vec3& p : points) EXPECT_LT(hull.normals[f].dot(p) - hull.offsets[f], 1e-8);
    // Euler: V − E + F = 2, each edge once in each direction.
    std::size_t edges = 0;
    for (const auto& face : hull.faces) edges += face.size();
    EXPECT_EQ(edges % 2, 0u);
    EXPECT_EQ(hull.vertices.size() + hull.faces.size(), edges / 2 + 2) << trial;
    EXPECT_NO_THROW(solid_properties(mesh_of(hull)));
  }
}

TEST(ConvexHull, ThousandPointsOnASphere) {
  Random random(43);
  std::vector<Vec3> points;
  for (int i = 0; i < 1000; ++i) points.push_back(random.unit());
  const Polyhedron hull = convex_hull(points);
  EXPECT_EQ(hull.vertices.size(), 1000u);
  EXPECT_EQ(hull.faces.size(), 1996u);
}

TEST(Solid, PrimitivesAgreeWithMassProperties) {
  const SolidProperties cone = solid_properties(Cone{0.4, 1.2});
  EXPECT_NEAR(cone.volume, cone_volume(0.4, 1.2), 1e-16);
  EXPECT_EQ(cone.inertia, MassProperties::cone(0.4, 1.2, Density{1}).inertia_B());
  EXPECT_NEAR(solid_properties(Ellipsoid{Vec3(1, 2, 3)}).volume, 8 * std::numbers::pi, 1e-14);
  EXPECT_EQ(solid_properties(Capsule{0.4, 1.2}).inertia,
            MassProperties::capsule(0.4, 1.2, Density{1}).inertia_B());
}

TEST(Solid, HullAndMeshOfABoxAreTheBoxInAnyPose) {
  Random random(44);
  const Vec3 size(0.7, 1.1, 1.9);
  const Mat3 inertia = MassProperties::box(size, Density{1}).inertia_B();
  for (int trial = 0; trial < 50; ++trial) {
    const Pose X = random.pose();
    const Mat3 R = X.q.toRotationMatrix();
    const ConvexHull shape = box_points(size, X);
    for (const Shape& s : {Shape(shape), Shape(mesh_of(convex_hull(shape.points)))}) {
      const SolidProperties solid = solid_properties(s);
      EXPECT_NEAR(solid.volume, size.prod(), 1e-14);
      EXPECT_LT((solid.centre - X.p).norm(), 1e-14);
      EXPECT_LT((solid.inertia - R * inertia * R.transpose()).norm(), 1e-13);
    }
  }
}

TEST(Solid, TetrahedronAndMeshWithAHole) {
  // Corners 0, x, y, z: V = 1/6, centre ¼, ∫x² = 1/60, ∫xy = 1/120.
  const ConvexHull corner{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}};
  const SolidProperties solid = solid_properties(corner);
  EXPECT_NEAR(solid.volume, 1.0 / 6, 1e-16);
  EXPECT_LT((solid.centre - Vec3::Constant(0.25)).norm(), 1e-15);
  const double diagonal = 2.0 / 60 - 2.0 / 6 / 16, product = -(1.0 / 120 - 1.0 / 6 / 16);
  Mat3 expected = Mat3::Constant(product);
  expected.diagonal().setConstant(diagonal);
  EXPECT_LT((solid.inertia - expected).norm(), 1e-16);

  TriangleMesh open = mesh_of(convex_hull(corner.points));
  TriangleMesh turned = open, half_turned = open;
  open.triangles.pop_back();
  expect_invalid([&] { solid_properties(open); }, {"not closed", "between vertices"});
  for (auto& t : turned.triangles) std::swap(t[0], t[1]);
  expect_invalid([&] { solid_properties(turned); }, {"inside out", "-0.16"});
  std::swap(half_turned.triangles[0][0], half_turned.triangles[0][1]);
  expect_invalid([&] { solid_properties(half_turned); }, {"not closed"});
  expect_invalid([] { solid_properties(HalfSpace{}); }, {"half-space", "no volume"});
  expect_invalid(
      [] {
        solid_properties(HeightField{2, 2, 1, 1, {0, 0, 0, 0}});
      },
      {"height field", "no volume"});
  expect_invalid([] { solid_properties(Sphere{-1}); }, {"sphere radius"});
}

TEST(Solid, ACompoundOfEightBoxesIsOneBox) {
  Random random(45);
  const Vec3 size(0.4, 0.6, 0.8);
  const Pose X = random.pose();
  std::vector<PlacedShape> parts;
  for (int k = 0; k < 8; ++k) {
    const Vec3 at = 0.25 * size.cwiseProduct(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
    parts.push_back({Box{size / 2}, {X.q, X.point(at)}, 500});
  }
  const Solid solid = solid_of(parts);
  EXPECT_NEAR(solid.mass.mass(), 500 * size.prod(), 1e-12);
  EXPECT_LT((solid.centre - X.p).norm(), 1e-14);
  const Mat3 R = X.q.toRotationMatrix();
  EXPECT_LT((solid.mass.inertia_B() - R * MassProperties::box(size, Density{500}).inertia_B() * R.transpose())
                .norm(),
            1e-12);
  // The parts are given back with the centre of mass as the origin.
  Vec3 sum = Vec3::Zero();
  for (const PlacedShape& part : solid.parts) sum += part.pose.p;
  EXPECT_LT(sum.norm(), 1e-13);
  EXPECT_EQ(solid.parts[3].pose.p, parts[3].pose.p - solid.centre);
  parts[2].density = 0;
  expect_invalid([&] { solid_of(parts); }, {"density", "0"});
  expect_invalid([] { solid_of({}); }, {"solid", "at least one part"});
}

}  // namespace
}  // namespace taut::solid_test
