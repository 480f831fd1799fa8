#include "collision/narrow/manifold.h"

#include "tests/collision/narrow/pair_of_shapes.h"

namespace taut::manifold_test {
namespace {

using testing::convex_shapes;
using testing::expect_sound;
using testing::odd_hull;
using testing::Random;
using testing::ShapePair;

/// Contact points on A as seen in world axes, relative to A.
std::vector<Vec3> places(const ShapePair& pair, const std::vector<Contact>& contacts) {
  std::vector<Vec3> result;
  for (const Contact& c : contacts) result.push_back(pair.world.pose(pair.A).q * c.p_AP);
  return result;
}

/// True if the ball's centre, projected along z, lies in the convex hull of the places: the body cannot tip
/// over.
bool supports(const std::vector<Vec3>& points, const Vec3& centre) {
  for (int k = 0; k < 64; ++k) {
    const double angle = 2 * 3.14159265358979 * k / 64;
    const Vec3 d(std::cos(angle), std::sin(angle), 0);
    double reach = -1e300;
    for (const Vec3& p : points) reach = std::max(reach, d.dot(p - centre));
    if (reach < 0) return false;
  }
  return true;
}

ConvexHull cube_hull(double half) {
  ConvexHull hull;
  for (int k = 0; k < 8; ++k)
    hull.points.push_back(half * Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
  return hull;
}

TriangleMesh cube_mesh(double half) {
  TriangleMesh mesh;
  mesh.vertices = cube_hull(half).points;
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// What lies on a table, with the height of its centre of mass above the table and the number of points.
struct Resting {
  const char* name;
  Shape shape;
  Quat q;
  double height;
  int least, most;
};

std::vector<Resting> resting() {
  const Quat lying(Eigen::AngleAxisd(3.14159265358979323846 / 2, Vec3::UnitY()));
  const Quat upright = Quat::Identity();
  return {{"box", Box{Vec3(0.5, 0.7, 0.4)}, upright, 0.2, 4, 4},
          {"hull", cube_hull(0.3), upright, 0.3, 4, 4},
          {"standing cylinder", Cylinder{0.25, 0.5}, upright, 0.25, 8, 8},
          {"lying cylinder", Cylinder{0.25, 0.5}, lying, 0.25, 2, 2},
          {"lying capsule", Capsule{0.15, 0.6}, lying, 0.15, 2, 2},
          {"standing cone", Cone{0.3, 0.8}, upright, 0.2, 8, 8},
          {"ball", Sphere{0.3}, upright, 0.3, 1, 1},
          {"ellipsoid", Ellipsoid{Vec3(0.4, 0.3, 0.2)}, upright, 0.2, 1, 1}};
}

/// Tables whose top is the plane z = 0 of their frame.
struct Table {
  Shape shape;
  Pose X;
};
std::vector<Table> tables() {
  HeightField field{9, 9, 0.5, 0.5, std::vector<double>(81, 0.0)};
  TriangleMesh square;
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) square.vertices.emplace_back(i - 2, j - 2, 0);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const int at = i + 5 * j;
      square.triangles.push_back({at, at + 1, at + 6});
      square.triangles.push_back({at, at + 6, at + 5});
    }
  return {{HalfSpace{}, {}},
          {Box{Vec3(4, 4, 1)}, {Quat::Identity(), Vec3(0, 0, -0.5)}},
          {cube_hull(2), {Quat::Identity(), Vec3(0, 0, -2)}},
          {cube_mesh(2), {Quat::Identity(), Vec3(0, 0, -2)}},
          {square, {}},
          {field, {}},
          {Cylinder{2, 1}, {Quat::Identity(), Vec3(0, 0, -0.5)}}};
}

TEST(Manifold, WhatLiesOnATableHasThePointsItStandsOn) {
  Random random(11);
  for (const Resting& r : resting())
    for (const Table& table : tables())
      for (int trial = 0; trial < 20; ++trial) {
        const double gap = trial % 2 ? -1e-4 : 1e-3;
        const Quat turn = exp_so3(random.uniform(-3, 3) * Vec3::UnitZ());
        const Vec3 at(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), r.height + gap);
        const ShapePair pair(r.shape, {turn * r.q, at}, table.shape, table.X);
        const auto contacts = pair.contacts(0.005);
        const std::string what = std::string(r.name) + " on " + shape_name(table.shape);
        expect_sound(pair.world, contacts);
        EXPECT_GE(static_cast<int>(contacts.size()), r.least) << what;
        EXPECT_LE(static_cast<int>(contacts.size()), r.most) << what;
        if (r.least >= 3) {
          EXPECT_TRUE(supports(places(pair, contacts), Vec3::Zero())) << what;
        }
        for (const Contact& c : contacts) {
          EXPECT_NEAR(c.gap, gap, 1e-12) << what;
          EXPECT_LT((c.normal + Vec3::UnitZ()).norm(), 1e-9) << what;
        }
      }
}

TEST(Manifold, AlignedBoxesOfOneSizeHaveFourPoints) {
  const Box box{Vec3(1, 1, 1)};
  for (double noise : {0.0, 1e-12, -1e-9, 1e-8}) {
    const ShapePair pair(box, {exp_so3(noise * Vec3::UnitZ()), Vec3(noise, 0, 0)}, box,
                         {Quat::Identity(), Vec3(0, noise, 0.9999)});
    EXPECT_EQ(pair.contacts().size(), 4u) << noise;
  }
}

TEST(Manifold, TurnedBoxesHaveTheEightPointsOfTheirOctagon) {
  const Box box{Vec3(1, 1, 1)};
  const ShapePair pair(box, {}, box, {exp_so3(0.25 * 3.14159265358979 * Vec3::UnitZ()), Vec3(0, 0, 1)});
  EXPECT_EQ(pair.contacts().size(), 8u);
}

TEST(Manifold, TouchingExactlyIsNoSpecialCase) {
  for (const Resting& r : resting())
    for (const Table& table : tables()) {
      const ShapePair pair(r.shape, {r.q, Vec3(0.1, 0.2, r.height)}, table.shape, table.X);
      const auto contacts = pair.contacts();
      const std::string what = std::string(r.name) + " on " + shape_name(table.shape);
      EXPECT_GE(static_cast<int>(contacts.size()), r.least) << what;
      for (const Contact& c : contacts) {
        EXPECT_NEAR(c.gap, 0, 1e-14) << what;
        EXPECT_LT((c.normal + Vec3::UnitZ()).norm(), 1e-9) << what;
      }
    }
}

TEST(Manifold, RestingContactsFollowSmallMotionsContinuously) {
  // Under a motion of 1e-9 m and rad no gap may change by more than a few of it, and every feature stays: no
  // point jumps.
  Random random(12);
  for (const Resting& r : resting())
    for (const Table& table : tables()) {
      const std::string what = std::string(r.name) + " on " + shape_name(table.shape);
      const Vec3 at(0.11, 0.23, r.height - 1e-5);
      ShapePair pair(r.shape, {exp_so3(0.4 * Vec3::UnitZ()) * r.q, at}, table.shape, table.X);
      ContactFinder finder({.threads = 1});
      auto last = finder.find(pair.world);
      double gap_change = 0, jump = 0;
      for (int step = 0; step < 200; ++step) {
        const Pose X = pair.world.pose(pair.A);
        pair.world.set_pose(pair.A, testing::moved(X, random.vector(1e-9), random.vector(1e-9)));
        const auto now = finder.find(pair.world);
        ASSERT_EQ(now.size(), last.size()) << what;
        for (std::size_t i = 0; i < now.size(); ++i) {
          ASSERT_EQ(now[i].feature, last[i].feature) << what;
          gap_change = std::max(gap_change, std::abs(now[i].gap - last[i].gap));
          jump = std::max(jump, (now[i].p_AP - last[i].p_AP).norm());
        }
        last = now;
      }
      EXPECT_LT(gap_change, 1e-8) << what;
      // Smooth bodies roll: radius·1e-9, up to 1e-7 for the distance of GJK on a mesh's edge.
      EXPECT_LT(jump, 1e-7) << what;
    }
}

TEST(Manifold, TheLeastGapIsContinuousWhileABodyTipsOver) {
  // From lying flat to standing on an edge and over it, on a box: the least gap changes by no more than reach
  // × angle.
  for (const Resting& r : resting()) {
    double last = 0;
    for (int k = 0; k <= 4000; ++k) {
      const double angle = 1.5 * k / 4000;
      const Quat q = exp_so3(angle * Vec3(0.6, 0.8, 0)) * r.q;
      const ShapePair pair(r.shape, {q, Vec3(0.1, 0.1, r.height)}, Box{Vec3(9, 9, 5)},
                           {Quat::Identity(), Vec3(0, 0, -2.5)});
      const auto contacts = pair.contacts(0.05);
      if (contacts.empty()) break;  // it has lifted off
      const double least = testing::least_gap(contacts);
      if (k > 0) {
        EXPECT_LT(std::abs(least - last), 1.5 / 4000 * 0.6) << r.name << " " << angle;
      }
      last = least;
    }
  }
}

TEST(Manifold, EndsOnACapDoNotTurnWithTheTilt) {
  // A long body across a cap, beside its middle, that lies on the chord of the circle.  What tilts the cap by
  // 3e-6 rad, as compliant bodies do, turns its deepest place all around, but no contact.
  const double r = 0.15, beside = 0.1, chord = std::sqrt(r * r - beside * beside);
  const Quat lying(Eigen::AngleAxisd(3.14159265358979323846 / 2, Vec3::UnitY()));
  for (const Shape& across : {Shape{Cylinder{0.1, 1}}, Shape{Capsule{0.1, 1}}})
    for (const Shape& standing : {Shape{Cylinder{r, 0.3}}, Shape{Cone{r, 0.3}}}) {
      const bool cone = std::holds_alternative<Cone>(standing);
      const double top = cone ? 0.25 * 0.3 : 0.15;
      const Quat up = cone ? Quat(0, 1, 0, 0) : Quat(1, 0, 0, 0);  // the base of a cone is below
      for (int k = 0; k < 64; ++k) {
        const double angle = 2 * 3.14159265358979 * k / 64;
        const Quat tilt = exp_so3(3e-6 * Vec3(std::cos(angle), std::sin(angle), 0));
        const ShapePair pair(standing, {tilt * up, Vec3::Zero()}, across,
                             {lying, Vec3(0, beside, top + 0.1 - 1e-6)});
        const auto contacts = pair.contacts(1e-3);
        ASSERT_GE(contacts.size(), 2U);
        const auto at = places(pair, contacts);
        for (double x : {-chord, chord})
          EXPECT_TRUE(std::any_of(at.begin(), at.end(),
                                  [&](const Vec3& p) { return (p - Vec3(x, beside, top)).norm() < 1e-5; }))
              << shape_name(standing) << " " << shape_name(across) << " " << k;
      }
    }
}

TEST(Manifold, BothCutsOfALineByACapAreOfTheSameEdge) {
  // Each by its own end of the line, whichever of both bodies has it: a warm start takes neither for the
  // other.
  const Quat lying(Eigen::AngleAxisd(3.14159265358979323846 / 2, Vec3::UnitY()));
  const Pose over{lying, Vec3(0, 0.1, 0.25 - 1e-6)};
  const Shape cap = Cylinder{0.15, 0.3}, line = Capsule{0.1, 1};
  for (const bool line_is_A : {false, true}) {
    const ShapePair pair = line_is_A ? ShapePair(line, over, cap, {}) : ShapePair(cap, {}, line, over);
    const auto contacts = pair.contacts(1e-3);
    ASSERT_EQ(contacts.size(), 2U);
    const std::uint64_t first = contacts[0].feature, second = contacts[1].feature;
    EXPECT_EQ(detail::meeting_of(first), detail::Meeting::kEdges);
    const auto of_line = line_is_A ? detail::side_A : detail::side_B;
    const auto of_cap = line_is_A ? detail::side_B : detail::side_A;
    EXPECT_EQ(of_line(first), of_line(second)) << line_is_A;
    EXPECT_NE(of_cap(first), of_cap(second)) << line_is_A;
  }
}

TEST(Manifold, NearlyAlignedLinesAreDeepestWhereTheyCross) {
  // The deepest point lies between the ends, on both bodies, and not at one end or the other as round-off
  // says.
  Random random(23);
  const double half = 0.15, depth = 5e-6;
  for (const Shape& shape : {Shape{Cylinder{0.15, 2 * half}}, Shape{Capsule{0.15, 2 * half}}})
    for (double turn : {1e-4, 1e-3, 5e-3, 0.018, 0.05, 0.15})
      for (int i = 0; i < 20; ++i) {
        const double z = random.uniform(-0.1, 0.1);  // of B's middle, where it crosses A's line
        const Quat q = exp_so3(turn * Vec3::UnitX()) * exp_so3(i * Vec3::UnitZ());
        const ShapePair pair(shape, {}, shape, {q, Vec3(0.3 - depth, 0, z)});
        const auto contacts = pair.contacts(1e-3);
        const auto deepest = std::min_element(contacts.begin(), contacts.end(),
                                              [](const auto& x, const auto& y) { return x.gap < y.gap; });
        ASSERT_NE(deepest, contacts.end());
        EXPECT_NEAR(deepest->gap, -depth, 1e-9) << turn;
        for (const Contact& c : contacts) {
          EXPECT_LE(std::abs(c.p_AP.z()), half + 1e-9) << turn;
          EXPECT_LE(std::abs(c.p_BQ.z()), half + 1e-9) << turn;
        }
        // Where the ends are less deep than that by 1e-7 m, it is the crossing.
        if (turn > 2e-3) {
          EXPECT_NEAR(deepest->p_AP.z(), z, 1e-6) << turn;
        }
      }
}

TEST(Manifold, NoDirectionNearbySeparatesMore) {
  // Round bodies side by side, turned by little or nothing and moved along each other, so that their lines
  // cross on them, beyond an end, or nowhere.
  Random random(19);
  const Shape shapes[] = {Cylinder{0.15, 0.3}, Cylinder{0.1, 0.5}, Cone{0.2, 0.5}};
  for (int i = 0; i < 1200; ++i) {
    const Shape &a = shapes[i % 3], &b = shapes[i / 3 % 2];
    const double turn = i % 7 == 0 ? 0 : std::pow(10, random.uniform(-6, -0.5));
    const double distance = (i % 3 == 2 ? 0.1 : i % 3 == 1 ? 0.1 : 0.15) + (i / 3 % 2 == 1 ? 0.1 : 0.15);
    const Pose X_A{random.rotation(), Vec3::Zero()};
    const double aside = i % 2 == 0 ? 0 : std::pow(10, random.uniform(-6, -2));
    const double along = random.uniform(-0.3, 0.3), deep = std::pow(10, random.uniform(-7, -3));
    const Vec3 off(std::sqrt(distance * distance - aside * aside) - deep, aside, along);
    const Quat q = exp_so3(turn * Vec3(1, random.uniform(-1e-3, 1e-3), 0)) * exp_so3(i * Vec3::UnitZ());
    const ShapePair pair(a, X_A, b, {X_A.q * q, X_A.q * off});
    const auto contacts = pair.contacts(1e-3);
    if (contacts.empty()) continue;
    const Pose &A = pair.world.pose(pair.A), &B = pair.world.pose(pair.B);
    const auto s = [&](const Vec3& n) {
      return n.dot(B.p + B.q * testing::support_point(b, B.q.conjugate() * -n) - A.p -
                   A.q * testing::support_point(a, A.q.conjugate() * n));
    };
    const Vec3 n = contacts[0].normal;
    const double gap = testing::least_gap(contacts);
    if (gap < 0) {
      EXPECT_NEAR(gap, s(n), 1e-12) << i;
    }
    Vec3 u, v;
    complete_frame(n, u, v);
    for (double angle : {1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2})
      for (int k = 0; k < 32; ++k) {
        const double phi = 2 * 3.14159265358979 * k / 32;
        ASSERT_LE(s((n + angle * (std::cos(phi) * u + std::sin(phi) * v)).normalized()), s(n) + 1e-11)
            << i << " turned by " << turn << ", " << angle << " in direction " << k;
      }
  }
}

TEST(Manifold, NoTwoPointsAreAtOnePlace) {
  // Long bodies on each other, turned by up to 0.3 rad and moved along each other: a point that were there
  // twice would be a spring of twice the stiffness, now and then.
  Random random(14);
  const Quat lying = exp_so3(0.5 * 3.14159265358979323846 * Vec3::UnitY());
  const Shape shapes[] = {Capsule{0.1, 0.6}, Cylinder{0.1, 0.6}, Box{Vec3(0.2, 0.2, 0.6)}};
  int points = 0;
  for (const Shape& a : shapes)
    for (const Shape& b : shapes)
      for (int trial = 0; trial < 2000; ++trial) {
        const Quat turned = exp_so3(random.uniform(-0.3, 0.3) * Vec3::UnitZ() + random.vector(1e-3));
        const Vec3 at(random.uniform(-0.7, 0.7), random.uniform(-0.05, 0.05), random.uniform(0.19, 0.2));
        const ShapePair pair(a, {lying, Vec3::Zero()}, b, {turned * lying, at});
        const auto contacts = pair.contacts();
        points += static_cast<int>(contacts.size());
        for (std::size_t i = 0; i < contacts.size(); ++i)
          for (std::size_t k = 0; k < i; ++k)
            ASSERT_GT((contacts[i].p_AP - contacts[k].p_AP).norm(), 1e-6)
                << shape_name(a) << " " << shape_name(b) << " " << trial;
      }
  EXPECT_GT(points, 20000);
}

TEST(Manifold, ReducedManifoldsKeepTheDeepestAndTheSpread) {
  // A hull with a face of forty corners on a half-space.
  ConvexHull drum;
  for (int k = 0; k < 40; ++k) {
    const double angle = 2 * 3.14159265358979 * k / 40;
    drum.points.emplace_back(std::cos(angle), std::sin(angle), 0.2);
    drum.points.emplace_back(std::cos(angle), std::sin(angle), -0.2);
  }
  for (int most : {4, 8, 16}) {
    const Quat tilted = exp_so3(Vec3(1e-3, 5e-4, 0));
    ShapePair pair(drum, {tilted, Vec3(0, 0, 0.2)}, HalfSpace{}, {});
    ContactFinder finder({.margin = 0.01, .threads = 1, .max_points = most});
    const auto contacts = finder.find(pair.world);
    EXPECT_EQ(static_cast<int>(contacts.size()), most);
    double lowest = 1;
    for (const Vec3& p : drum.points) lowest = std::min(lowest, (tilted * p).z() + 0.2);
    EXPECT_NEAR(testing::least_gap(contacts), lowest, 1e-14);
    EXPECT_TRUE(supports(places(pair, contacts), Vec3::Zero()));
  }
}

TEST(Manifold, DoesNotDependOnWhereThePairIsNorOnItsOrder) {
  Random random(13);
  const auto shapes = convex_shapes();
  int checked = 0;
  for (const Shape& a : shapes)
    for (const Shape& b : shapes)
      for (int trial = 0; trial < 60; ++trial) {
        const Pose X_A = random.pose();
        const Pose X_B{random.rotation(), X_A.p + 0.55 * random.unit()};
        const ShapePair pair(a, X_A, b, X_B), swapped(b, X_B, a, X_A);
        const Quat R = random.rotation();
        const Vec3 t = random.vector(3);
        const ShapePair moved(a, testing::transformed(R, t, X_A), b, testing::transformed(R, t, X_B));
        const auto own = pair.contacts(), other = swapped.contacts(), there = moved.contacts();
        ASSERT_EQ(own.empty(), other.empty());
        ASSERT_EQ(own.empty(), there.empty());
        if (own.empty()) continue;
        // A deep overlap of round bodies has several local minima, and the order may choose: shallow ones
        // only.
        const double depth = testing::least_gap(own);
        if (depth < -0.05) continue;
        ++checked;
        EXPECT_NEAR(testing::least_gap(there), depth, 1e-10) << shape_name(a) << " " << shape_name(b);
        EXPECT_NEAR(testing::least_gap(other), depth, 1e-10) << shape_name(a) << " " << shape_name(b);
        const auto deepest = [](const std::vector<Contact>& c) {
          return *std::min_element(c.begin(), c.end(), [](auto& x, auto& y) { return x.gap < y.gap; });
        };
        EXPECT_LT((deepest(there).normal - R * deepest(own).normal).norm(), 2e-5)
            << shape_name(a) << " " << shape_name(b) << " " << depth;
        EXPECT_LT((deepest(other).normal + deepest(own).normal).norm(), 2e-5)
            << shape_name(a) << " " << shape_name(b) << " " << depth;
        EXPECT_EQ(there.size(), own.size()) << shape_name(a) << " " << shape_name(b);
      }
  EXPECT_GT(checked, 500);
}

}  // namespace
}  // namespace taut::manifold_test
