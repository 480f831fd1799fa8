#include "core/world/solid.h"
#include "tests/collision/narrow/pair_of_shapes.h"

namespace taut::surface_test {
namespace {

using testing::convex_shapes;
using testing::expect_sound;
using testing::Random;
using testing::support_point;

/// A wavy ground of n × n squares as a mesh (two triangles each, diagonals as those of a height field).
HeightField wavy_field(int n, double width, double height) {
  HeightField field{n + 1, n + 1, width / n, width / n, {}};
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) field.heights.push_back(height * std::sin(0.9 * i) * std::cos(0.7 * j));
  return field;
}
TriangleMesh as_mesh(const HeightField& f) {
  TriangleMesh mesh;
  for (int j = 0; j < f.ny; ++j)
    for (int i = 0; i < f.nx; ++i)
      mesh.vertices.emplace_back((i - 0.5 * (f.nx - 1)) * f.dx, (j - 0.5 * (f.ny - 1)) * f.dy,
                                 f.heights[static_cast<std::size_t>(i + f.nx * j)]);
  for (int j = 0; j + 1 < f.ny; ++j)
    for (int i = 0; i + 1 < f.nx; ++i) {
      const int at = i + f.nx * j;
      mesh.triangles.push_back({at, at + 1, at + f.nx + 1});
      mesh.triangles.push_back({at, at + f.nx + 1, at + f.nx});
    }
  return mesh;
}

/// One body with one shape over a fixed ground.
struct OnGround {
  World world;
  BodyId body;
  ContactFinder finder;
  OnGround(const Shape& shape, const Shape& ground, double margin = 0.01)
      : finder({.margin = margin, .threads = 1}) {
    body = world.add_body({});
    world.add_shape(body, shape);
    world.add_shape(kGround, ground);
  }
  std::vector<Contact> at(const Quat& q, const Vec3& p) {
    world.set_pose(body, {q, p});
    return finder.find(world);
  }
};

TEST(Surface, SlidingOverAFlatMeshMeetsNoInnerEdge) {
  // Every contact has the normal of the plane, wherever the shape is with respect to the triangles.
  Random random(31);
  const HeightField flat = wavy_field(20, 4, 0);
  for (const Shape& ground : {Shape(flat), Shape(as_mesh(flat))})
    for (const Shape& shape : convex_shapes()) {
      OnGround scene(shape, ground);
      for (int trial = 0; trial < 200; ++trial) {
        const Quat q = random.rotation();
        const double gap = random.uniform(-0.03, 0.009);
        const Vec3 low = q * support_point(shape, -(q.conjugate() * Vec3::UnitZ()));
        const Vec3 p(random.uniform(-1, 1), random.uniform(-1, 1), gap - low.z());
        const auto contacts = scene.at(q, p);
        ASSERT_FALSE(contacts.empty()) << shape_name(shape);
        expect_sound(scene.world, contacts);
        EXPECT_NEAR(testing::least_gap(contacts), gap, 1e-12) << shape_name(shape);
        for (const Contact& c : contacts)
          EXPECT_LT((c.normal + Vec3::UnitZ()).norm(), 1e-9)
              << shape_name(shape) << " on " << shape_name(ground);
      }
    }
}

TEST(Surface, BallOnAWavyGroundHasTheDistanceToTheNearestTriangle) {
  // Oracle: the least distance of the centre to all triangles, by the closest point of [Ericson2005,
  // section 5.1.5], above the ground.
  const auto closest = [](const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) -> Vec3 {
    const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
                 d6 = ac.dot(cp);
    if (d1 <= 0 && d2 <= 0) return a;
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
    return a + vb / (va + vb + vc) * ab + vc / (va + vb + vc) * ac;
  };
  Random random(32);
  const HeightField field = wavy_field(12, 6, 0.25);
  const TriangleMesh mesh = as_mesh(field);
  for (const Shape& ground : {Shape(field), Shape(mesh)}) {
    OnGround scene(Sphere{0.2}, ground, 0.05);
    int hits = 0;
    for (int trial = 0; trial < 2000; ++trial) {
      const Vec3 p(random.uniform(-2.5, 2.5), random.uniform(-2.5, 2.5), random.uniform(-0.1, 0.6));
      double nearest = 1e300;
      bool above = false;
      for (const auto& t : mesh.triangles) {
        const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        const Vec3 q = closest(p, a, b, c);
        if ((q - p).norm() < nearest) nearest = (q - p).norm(), above = (b - a).cross(c - a).dot(p - q) > 0;
      }
      if (!above || nearest < 0.02) continue;  // the centre itself below ground: another rule
      const auto contacts = scene.at(random.rotation(), p);
      const double gap = nearest - 0.2;
      if (std::abs(gap - 0.05) < 1e-9) continue;
      if (gap > 0.05) {
        EXPECT_TRUE(contacts.empty());
        continue;
      }
      ++hits;
      ASSERT_FALSE(contacts.empty()) << p.transpose();
      expect_sound(scene.world, contacts);
      EXPECT_NEAR(testing::least_gap(contacts), gap, 1e-11) << p.transpose();
    }
    EXPECT_GT(hits, 400);
  }
}

TEST(Surface, OnAConvexMeshAsOnItsHull) {
  // A cube as a mesh and as a box: the same least gap and normal, at faces, edges and corners.
  TriangleMesh cube;
  for (int k = 0; k < 8; ++k) cube.vertices.emplace_back(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
  cube.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  EXPECT_NEAR(solid_properties(cube).volume, 8, 1e-14);
  Random random(33);
  for (const Shape& shape : convex_shapes()) {
    OnGround on_mesh(shape, cube), on_box(shape, Box{Vec3(2, 2, 2)});
    int hits = 0;
    for (int trial = 0; trial < 600; ++trial) {
      const Quat q = random.rotation();
      const Vec3 n = random.unit();
      const double gap = random.uniform(1e-5, 0.009);
      const Vec3 corner(n.x() > 0 ? 1 : -1, n.y() > 0 ? 1 : -1, n.z() > 0 ? 1 : -1);
      // Any point of the surface that n is normal to: faces and edges if some components are zero.
      const Vec3 normal = trial % 3 == 0   ? Vec3(0, 0, corner.z())
                          : trial % 3 == 1 ? Vec3(0, n.y(), n.z()).normalized()
                                           : n;
      Vec3 at = corner;
      if (trial % 3 < 2) at.x() = random.uniform(-0.9, 0.9);
      if (trial % 3 < 1) at.y() = random.uniform(-0.9, 0.9);
      const Vec3 p = at + gap * normal - q * support_point(shape, -(q.conjugate() * normal));
      const auto mesh = on_mesh.at(q, p), box = on_box.at(q, p);
      ASSERT_FALSE(mesh.empty()) << shape_name(shape) << " " << trial % 3;
      expect_sound(on_mesh.world, mesh);
      EXPECT_NEAR(testing::least_gap(mesh), gap, 1e-10) << shape_name(shape) << " " << trial % 3;
      EXPECT_NEAR(testing::least_gap(box), gap, 1e-10) << shape_name(shape);
      for (const Contact& c : mesh) {
        if (c.gap < gap + 1e-9) {
          EXPECT_LT((c.normal + normal).norm(), 1e-6) << shape_name(shape) << " " << trial % 3;
        }
      }
      ++hits;
    }
    EXPECT_EQ(hits, 600);
  }
}

/// A small mesh on a body and a large box: those of its faces that look past the box do not meet it, however
/// far the box reaches behind them.  Oracle: the hull of the same corners, as deep as a mesh may be.
TEST(Surface, ASmallMeshIsNoDeeperInALargeBoxThanItsHull) {
  const TriangleMesh mesh{{{0, 0, 0.1}, {0.1, 0, -0.05}, {-0.05, 0.08, -0.05}, {-0.05, -0.08, -0.05}},
                          {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
  const Shape hull = ConvexHull{mesh.vertices}, box = Box{Vec3(2, 3, 0.4)};
  Random random(34);
  OnGround as_mesh(mesh, box), as_hull(hull, box);
  for (int trial = 0; trial < 3000; ++trial) {
    const Quat q = random.rotation();
    const double gap = random.uniform(-0.01, 0.009);
    const Vec3 low = q * support_point(hull, -(q.conjugate() * Vec3::UnitZ()));
    const double x = random.uniform(-0.5, 0.5), y = random.uniform(-0.5, 0.5);  // in this order
    const Vec3 p(x, y, 0.2 + gap - low.z());
    const auto contacts = as_mesh.at(q, p);
    ASSERT_FALSE(contacts.empty()) << trial;
    expect_sound(as_mesh.world, contacts);
    EXPECT_NEAR(testing::least_gap(as_hull.at(q, p)), gap, 1e-12);
    EXPECT_NEAR(testing::least_gap(contacts), gap, 1e-12) << trial;
  }
}

TEST(Surface, AHeightFieldIsSolidBelow) {
  OnGround scene(Box{Vec3(0.2, 0.2, 0.2)}, wavy_field(10, 4, 0));
  for (double depth : {0.05, 0.15, 0.5, 2.0}) {
    const auto contacts = scene.at(Quat::Identity(), Vec3(0.13, 0.07, -depth));
    ASSERT_GE(contacts.size(), 4u) << depth;
    EXPECT_NEAR(testing::least_gap(contacts), -depth - 0.1, 1e-12);
    expect_sound(scene.world, contacts);
    for (const Contact& c : contacts) {
      EXPECT_LT((c.normal + Vec3::UnitZ()).norm(), 1e-12);
    }
  }
  // Beside the field there is nothing.
  EXPECT_TRUE(scene.at(Quat::Identity(), Vec3(5, 0, 0)).empty());
}

TEST(Surface, AMeshFallsOnAHalfSpace) {
  TriangleMesh wedge{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)},
                     {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  OnGround scene(wedge, HalfSpace{});
  const auto contacts = scene.at(Quat::Identity(), Vec3(5, 5, -0.001));
  ASSERT_EQ(contacts.size(), 3u);
  expect_sound(scene.world, contacts);
  for (const Contact& c : contacts) EXPECT_NEAR(c.gap, -0.001, 1e-15);
}

}  // namespace
}  // namespace taut::surface_test
