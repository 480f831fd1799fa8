#include "tests/collision/narrow/pair_of_shapes.h"

namespace taut::closed_forms_test {
namespace {

using testing::convex_shapes;
using testing::expect_sound;
using testing::least_gap;
using testing::Random;
using testing::ShapePair;
using testing::support_point;

/// B is put where its support point along −n is `gap` beyond that of A along n.  If gap > 0 the line between
/// the two points is the shortest one between the bodies, whatever they are.
Pose opposite(const Shape& a, const Pose& X_A, const Shape& b, const Quat& q_B, const Vec3& n, double gap) {
  const Vec3 P = X_A.point(support_point(a, X_A.q.conjugate() * n));
  return {q_B, P + gap * n - q_B * support_point(b, -(q_B.conjugate() * n))};
}

TEST(ClosedForms, DistanceOfEveryPairOfConvexShapesInAnyPose) {
  Random random(1);
  const auto shapes = convex_shapes();
  for (const Shape& a : shapes)
    for (const Shape& b : shapes)
      for (int trial = 0; trial < 200; ++trial) {
        const Pose X_A = random.pose();
        const Vec3 n = random.unit();
        const double gap = std::pow(10, random.uniform(-5, -2));
        const Pose X_B = opposite(a, X_A, b, random.rotation(), n, gap);
        const ShapePair pair(a, X_A, b, X_B);
        const auto contacts = pair.contacts(0.02);
        ASSERT_FALSE(contacts.empty()) << shape_name(a) << " " << shape_name(b);
        expect_sound(pair.world, contacts);
        // Exact but for round-off, which the direction magnifies by size/gap, to 1e-10 at the worst.
        EXPECT_NEAR(least_gap(contacts), gap, 2e-12) << shape_name(a) << " " << shape_name(b);
        const auto nearest = std::min_element(contacts.begin(), contacts.end(),
                                              [](auto& x, auto& y) { return x.gap < y.gap; });
        EXPECT_LT((nearest->normal - n).norm(), 1e-8) << shape_name(a) << " " << shape_name(b) << " " << gap;
        const Vec3 P = pair.world.pose(pair.A).point(nearest->p_AP);
        EXPECT_LT((P - X_A.point(support_point(a, X_A.q.conjugate() * n))).norm(), 1e-7)
            << shape_name(a) << " " << shape_name(b) << " " << gap;
      }
}

TEST(ClosedForms, OverlapOfSmoothBodiesInAnyPose) {
  // Where both surfaces are smooth and the overlap is shallow, the same construction with gap < 0 is the
  // least overlap.
  Random random(2);
  const std::vector<Shape> smooth{Sphere{0.3}, Ellipsoid{Vec3(0.2, 0.35, 0.5)},
                                  Ellipsoid{Vec3(0.4, 0.3, 0.3)}, Capsule{0.2, 0.3}};
  for (const Shape& a : smooth)
    for (const Shape& b : smooth)
      for (int trial = 0; trial < 200; ++trial) {
        const Pose X_A = random.pose();
        const Vec3 n = random.unit();
        const double gap = -std::pow(10, random.uniform(-6, -2));
        const ShapePair pair(a, X_A, b, opposite(a, X_A, b, random.rotation(), n, gap));
        const auto contacts = pair.contacts();
        ASSERT_FALSE(contacts.empty());
        expect_sound(pair.world, contacts);
        EXPECT_NEAR(least_gap(contacts), gap, 1e-13) << shape_name(a) << " " << shape_name(b);
        EXPECT_LT((contacts[0].normal - n).norm(), 1e-9)
            << shape_name(a) << " " << shape_name(b) << " " << gap;
      }
}

TEST(ClosedForms, FacesThatOverlap) {
  // The deepest point of B lies under a face of A, far from its edges: the normal is that of the face.
  Random random(3);
  const Box block{Vec3(4, 4, 2)};
  for (const Shape& b : convex_shapes())
    for (int trial = 0; trial < 300; ++trial) {
      const Pose X_A = random.pose();
      const Vec3 n = X_A.q * Vec3::UnitZ();
      const double gap = -std::pow(10, random.uniform(-9, -1.5));
      const Quat q_B = random.rotation();
      const Vec3 P = X_A.point(Vec3(random.uniform(-1, 1), random.uniform(-1, 1), 1));
      const Pose X_B{q_B, P + gap * n - q_B * support_point(b, -(q_B.conjugate() * n))};
      const ShapePair pair(block, X_A, b, X_B);
      const auto contacts = pair.contacts();
      ASSERT_FALSE(contacts.empty());
      expect_sound(pair.world, contacts);
      EXPECT_NEAR(least_gap(contacts), gap, 1e-13) << shape_name(b);
      EXPECT_LT((contacts[0].normal - n).norm(), 1e-12) << shape_name(b);
    }
}

TEST(ClosedForms, EverythingOnAHalfSpace) {
  Random random(4);
  for (const Shape& a : convex_shapes())
    for (int trial = 0; trial < 300; ++trial) {
      const Pose ground = random.pose();
      const Vec3 up = ground.q * Vec3::UnitZ();
      const Quat q = random.rotation();
      const double gap = random.uniform(-0.02, 0.009);
      const Vec3 Q = ground.point(Vec3(random.uniform(-5, 5), random.uniform(-5, 5), 0));
      const Pose X{q, Q + gap * up - q * support_point(a, -(q.conjugate() * up))};
      const ShapePair pair(a, X, HalfSpace{}, ground);
      const auto contacts = pair.contacts(0.01);
      ASSERT_FALSE(contacts.empty()) << shape_name(a);
      expect_sound(pair.world, contacts);
      EXPECT_NEAR(least_gap(contacts), gap, 1e-14 * 10);
      for (const Contact& c : contacts) {
        EXPECT_LT((c.normal + up).norm(), 1e-14);
        EXPECT_LE(c.gap, 0.01);
        EXPECT_NEAR(up.dot(pair.world.pose(c.B).point(c.p_BQ) - ground.p), 0, 1e-14 * 20);
      }
    }
}

TEST(ClosedForms, SphereInsideABoxIsPushedOutThroughTheNearestFace) {
  Random random(5);
  const Vec3 half(0.5, 0.7, 0.4);
  for (int trial = 0; trial < 500; ++trial) {
    const Pose X_A = random.pose();
    const Vec3 c = half.cwiseProduct(random.vector());
    const Vec3 depth = half - c.cwiseAbs();
    Eigen::Index axis;
    const double least = depth.minCoeff(&axis);
    const ShapePair pair(Box{2 * half}, X_A, Sphere{0.1}, Pose{random.rotation(), X_A.point(c)});
    const auto contacts = pair.contacts();
    ASSERT_EQ(contacts.size(), 1u);
    expect_sound(pair.world, contacts);
    EXPECT_NEAR(contacts[0].gap, -least - 0.1, 1e-14);
    EXPECT_LT((contacts[0].normal - X_A.q * (Vec3::Unit(axis) * (c[axis] < 0 ? -1 : 1))).norm(), 1e-12);
  }
}

TEST(ClosedForms, BoxesThatOverlapAgreeWithAllFifteenAxes) {
  // The exact depth is the least over 3 + 3 + 9 directions (separating axes [Gottschalk1996]).
  Random random(6);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 a = Vec3(0.3, 0.5, 0.7) + random.vector(0.2), b = Vec3(0.4, 0.2, 0.6) + random.vector(0.1);
    const Pose X_A = random.pose(), X_B{random.rotation(), X_A.p + random.vector(0.5)};
    const Mat3 R_A = X_A.q.toRotationMatrix(), R_B = X_B.q.toRotationMatrix();
    double best = -1e300;
    const auto try_axis = [&](const Vec3& direction) {
      if (direction.norm() < 1e-6) return;
      const Vec3 n = direction.normalized();
      const double reach =
          ((R_A.transpose() * n).cwiseAbs().dot(a) + (R_B.transpose() * n).cwiseAbs().dot(b)) / 2;
      best = std::max(best, std::abs(n.dot(X_B.p - X_A.p)) - reach);
    };
    for (int i = 0; i < 3; ++i) {
      try_axis(R_A.col(i)), try_axis(R_B.col(i));
      for (int j = 0; j < 3; ++j) try_axis(R_A.col(i).cross(R_B.col(j)));
    }
    const ShapePair pair(Box{a}, X_A, Box{b}, X_B);
    const auto contacts = pair.contacts(0.001);
    if (best > 0.001) {
      EXPECT_TRUE(contacts.empty());
    } else if (best < 0) {
      ASSERT_FALSE(contacts.empty());
      expect_sound(pair.world, contacts);
      EXPECT_NEAR(least_gap(contacts), best, 1e-13);
    }
  }
}

TEST(ClosedForms, CapsulesBesideEachOther) {
  // Axes parallel at a distance 0.5 − 0.001, overlapping along 0.4 m: two points, one at each end.
  const Capsule capsule{0.25, 1};
  const Pose X_A{Quat::Identity(), Vec3::Zero()}, X_B{Quat::Identity(), Vec3(0.499, 0, 0.6)};
  const ShapePair pair(capsule, X_A, capsule, X_B);
  const auto contacts = pair.contacts();
  ASSERT_EQ(contacts.size(), 2u);
  double low = 1, high = 0;
  for (const Contact& c : contacts) {
    EXPECT_NEAR(c.gap, -0.001, 1e-15);
    EXPECT_LT((c.normal - Vec3::UnitX()).norm(), 1e-14);
    low = std::min(low, c.p_AP.z()), high = std::max(high, c.p_AP.z());
  }
  EXPECT_NEAR(low, 0.1, 1e-14);
  EXPECT_NEAR(high, 0.5, 1e-14);
}

TEST(ClosedForms, CapsulesThatCross) {
  Random random(7);
  for (int trial = 0; trial < 300; ++trial) {
    const Pose X_A = random.pose();
    const Vec3 axis = X_A.q * Vec3::UnitZ();
    const Vec3 n = axis.cross(random.unit()).normalized();
    const Quat q_B = exp_so3(random.uniform(0.3, 2.8) * n) * X_A.q;
    const double gap = random.uniform(-0.05, 0.009);
    const Vec3 at = X_A.p + random.uniform(-0.4, 0.4) * axis;
    const Pose X_B{q_B, at + (0.3 + gap) * n + random.uniform(-0.4, 0.4) * (q_B * Vec3::UnitZ())};
    const ShapePair pair(Capsule{0.2, 1}, X_A, Capsule{0.1, 1}, X_B);
    const auto contacts = pair.contacts(0.01);
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_NEAR(contacts[0].gap, gap, 1e-14);
    EXPECT_LT((contacts[0].normal - n).norm(), 1e-12);
    EXPECT_LT((pair.world.pose(pair.A).point(contacts[0].p_AP) - at - 0.2 * n).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace taut::closed_forms_test
