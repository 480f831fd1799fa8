// The penetration of a report against distances of the shapes that know nothing of contacts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "core/joints/joints.h"
#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/chain_on_floor.h"

namespace taut::penetration_test {
namespace {

/// Largest p·n over the points p of a shape, in its own frame.
double extent(const Shape& shape, const Vec3& n) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return s->radius;
  if (const auto* s = std::get_if<Box>(&shape)) return 0.5 * s->size.dot(n.cwiseAbs());
  if (const auto* s = std::get_if<Capsule>(&shape)) return s->radius + 0.5 * s->length * std::abs(n.z());
  const auto& s = std::get<Cylinder>(shape);
  return s.radius * n.head<2>().norm() + 0.5 * s.length * std::abs(n.z());
}

struct Placed {
  const Shape& shape;
  Pose pose;
  double extent_along(const Vec3& n) const { return pose.p.dot(n) + extent(shape, pose.q.conjugate() * n); }
};

/// How far B is beyond A along n: two convex bodies are apart by the largest of all n, or in each other by
/// it.
double apart_along(const Placed& A, const Placed& B, const Vec3& n) {
  return -B.extent_along(-n) - A.extent_along(n);
}

using Direction = std::pair<double, Vec3>;  // and how far the two are apart along it

Direction try_along(const Placed& A, const Placed& B, const Vec3& n) { return {apart_along(A, B, n), n}; }

/// The best of the directions across an axis: there the function has a ridge, if the axis is that of an edge.
Direction best_across(const Placed& A, const Placed& B, const Vec3& axis) {
  Vec3 u, v;
  complete_frame(axis, u, v);
  const auto at = [&](double angle) { return try_along(A, B, std::cos(angle) * u + std::sin(angle) * v); };
  constexpr int kAngles = 120;
  double angle = 0, step = 2 * std::numbers::pi / kAngles;
  Direction best = at(angle);
  for (int k = 1; k < kAngles; ++k)
    if (const Direction there = at(k * step); there.first > best.first) best = there, angle = k * step;
  for (; step > 1e-9; step /= 2)
    for (const double other : {angle - step, angle + step})
      if (const Direction there = at(other); there.first > best.first) best = there, angle = other;
  return best;
}

/// Nearer and nearer directions about one.
double climb(const Placed& A, const Placed& B, Direction from) {
  for (double size = 0.1; size > 1e-9; size /= 2)
    for (bool better = true; better;) {
      better = false;
      Vec3 u, v;
      complete_frame(from.second, u, v);
      for (int k = 0; k < 8; ++k) {
        const double angle = k * std::numbers::pi / 4;
        const Direction there =
            try_along(A, B, (from.second + size * (std::cos(angle) * u + std::sin(angle) * v)).normalized());
        if (there.first > from.first) from = there, better = true;
      }
    }
  return from.first;
}

/// Of two convex bodies: the largest of all directions, or a positive one.  Faces, edges, axes and those that
/// cross have kinks there, and are tried by themselves.
double signed_distance(const Placed& A, const Placed& B) {
  if (std::holds_alternative<HalfSpace>(A.shape)) {
    const Vec3 up = A.pose.q * Vec3::UnitZ();
    return -B.extent_along(-up) - A.pose.p.dot(up);
  }
  std::vector<Direction> tried;
  constexpr int kDirections = 400;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * i + 1.0) / kDirections, r = std::sqrt(1 - z * z);
    tried.push_back(try_along(A, B, Vec3(r * std::cos(golden * i), r * std::sin(golden * i), z)));
  }
  for (int i = 0; i < 3; ++i) {
    for (const Placed* one : {&A, &B}) {
      const Vec3 axis = one->pose.q * Vec3::Unit(i);
      tried.push_back(best_across(A, B, axis));
      for (const double sign : {1.0, -1.0}) tried.push_back(try_along(A, B, sign * axis));
    }
    for (int k = 0; k < 3; ++k)
      for (const double sign : {1.0, -1.0}) {
        const Vec3 across = sign * (A.pose.q * Vec3::Unit(i)).cross(B.pose.q * Vec3::Unit(k));
        if (across.norm() > 1e-6) tried.push_back(try_along(A, B, across.normalized()));
      }
  }
  std::sort(tried.begin(), tried.end(),
            [](const Direction& a, const Direction& b) { return a.first > b.first; });
  double best = tried.front().first;
  if (best > 0) return best;  // they are apart; by how much does not matter here
  for (std::size_t start = 0; start < 2; ++start) best = std::max(best, climb(A, B, tried[start]));
  return best;
}

double bounding_radius(const Shape& shape) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return s->radius;
  if (const auto* s = std::get_if<Box>(&shape)) return 0.5 * s->size.norm();
  if (const auto* s = std::get_if<Capsule>(&shape)) return s->radius + 0.5 * s->length;
  const auto& s = std::get<Cylinder>(shape);
  return std::hypot(s.radius, 0.5 * s.length);
}

/// Deepest penetration of all pairs that may touch, ≥ 0.
double deepest(const World& world) {
  double depth = 0;
  const auto placed = [&](int s) {
    const ShapeRecord& record = world.shape({s});
    const Pose& body = world.pose(record.body);
    return Placed{*record.shape, {body.q * record.pose.q, body.point(record.pose.p)}};
  };
  for (int a = 0; a < world.shape_count(); ++a)
    for (int b = 0; b < world.shape_count(); ++b) {
      const Placed A = placed(a), B = placed(b);
      const bool ground = std::holds_alternative<HalfSpace>(A.shape);
      if (!(a < b || ground) || std::holds_alternative<HalfSpace>(B.shape)) continue;
      if (!world.may_collide(ShapeId{a}, ShapeId{b})) continue;
      if (!ground && (A.pose.p - B.pose.p).norm() > bounding_radius(A.shape) + bounding_radius(B.shape))
        continue;
      if (ground || !(apart_along(A, B, (B.pose.p - A.pose.p).normalized()) > 0))  // else that is proof
        depth = std::max(depth, -signed_distance(A, B));
    }
  return depth;
}

TEST(Penetration, TheDistancesAreRight) {
  const Shape box = Box{Vec3(2, 2, 2)}, ball = Sphere{0.5}, capsule = Capsule{0.5, 2},
              cylinder = Cylinder{1, 2};
  const auto at = [](const Shape& shape, const Vec3& p, const Quat& q = Quat::Identity()) {
    return Placed{shape, {q, p}};
  };
  const double root = std::sqrt(0.5);
  const Quat lying(root, root, 0, 0),
      on_edge(std::cos(std::numbers::pi / 8), std::sin(std::numbers::pi / 8), 0, 0);
  EXPECT_GT(signed_distance(at(box, {0, 0, 0}), at(ball, {2, 2, 1})), 0);
  EXPECT_NEAR(signed_distance(at(box, {0, 0, 0}), at(ball, {1.3, 1.3, 0.4})), std::sqrt(0.18) - 0.5, 1e-9);
  EXPECT_NEAR(signed_distance(at(box, {0, 0, 0}), at(ball, {0.2, 1.4, 0})), -0.1, 1e-9);
  EXPECT_NEAR(signed_distance(at(box, {0, 0, 0}), at(box, {0, 0, 2.2}, on_edge)), 1.2 - std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(signed_distance(at(capsule, {0, 0, 0}), at(capsule, {0.9, 0, 0}, lying)), -0.1, 1e-9);
  EXPECT_NEAR(signed_distance(at(capsule, {0, 0, 0}), at(capsule, {0, 0, 2.75})), -0.25, 1e-9);
  EXPECT_NEAR(signed_distance(at(cylinder, {0, 0, 0}), at(cylinder, {0.5, 0, 1.8}, lying)), -0.2, 1e-9);
  EXPECT_NEAR(signed_distance(at(cylinder, {0, 0, 0}), at(ball, {1.3, 0, 1.4})), 0, 1e-9);
}

/// The reported penetration of every step, against that of the shapes where they are at its end.
void expect_true(World& world, const Settings& settings, double dt, int steps) {
  constexpr double kSearch = 1e-9;  // of signed_distance(), and of how contacts find their points
  Simulator simulator(world, settings);
  double largest = 0;
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulator.step(dt);
    ASSERT_TRUE(report.ok()) << report.message;
    const double depth = deepest(world);
    EXPECT_NEAR(report.penetration, depth, kSearch) << "step " << i;
    largest = std::max(largest, depth);
  }
  EXPECT_GT(largest, 10 * kSearch);  // there is something to report
}

/// Ten capsules on ball joints fall on a floor and lie down in a line, their axes in one plane.
TEST(Penetration, OfAChainOnAFloorIsThatOfItsCapsules) {
  World world = testing::chain_on_floor(10, 0.4);
  expect_true(world, {}, 0.002, 2000);
}

TEST(Penetration, OfAPileIsThatOfItsBodies) {
  Scene scene = build_scene("pile", {{"n", 12}});
  expect_true(scene.world, scene.settings, 1.0 / 240, 300);
}

}  // namespace
}  // namespace taut::penetration_test
