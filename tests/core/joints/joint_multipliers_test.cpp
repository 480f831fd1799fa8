#include "core/joints/joints.h"
#include "tests/core/constraints/row_checker.h"

namespace taut::joint_multipliers_test {
namespace {

using testing::kA;
using testing::kB;
using testing::pair_of_bodies;
using testing::RowChecker;

// The sign and the frame of λ, as the headers state them.  Bodies apart by (2, 0, 0), B at the origin's
// right.

struct Poses {
  Pose A{exp_so3(Vec3(0.3, -0.2, 0.5)), Vec3(0, 0, 0)};
  Pose B{exp_so3(Vec3(-0.4, 0.1, 0.2)), Vec3(2, 0, 0)};
  World world = pair_of_bodies(A, B);
  Vec3 p{1, 0.5, 0.25};  // the joint

  template <typename AnyJoint>
  std::vector<Wrench> wrenches(const AnyJoint& joint, const std::vector<double>& lambda) const {
    return RowChecker(joint).wrenches(A, B, lambda);
  }
};

void expect_wrench(const Wrench& wrench, const Vec3& torque, const Vec3& force) {
  EXPECT_LT((wrench.torque - torque).norm(), 1e-14);
  EXPECT_LT((wrench.force - force).norm(), 1e-14);
}

TEST(JointMultipliers, OfABallAreTheForceOnB) {
  const Poses s;
  const Vec3 f(1, 2, 3);
  const auto on = s.wrenches(Ball::at(s.world, kA, kB, s.p), {1, 2, 3});
  expect_wrench(on[2], (s.p - s.B.p).cross(f), f);
  expect_wrench(on[1], -(s.p - s.A.p).cross(f), -f);
}

TEST(JointMultipliers, OfAHingeAreAForceAndATorqueAcrossTheAxis) {
  const Poses s;
  const Vec3 axis = Vec3(1, 1, 1).normalized();
  const auto joint = Hinge::at(s.world, kA, kB, s.p, axis);
  for (const auto& lambda : {std::vector<double>{0, 0, 0, 1, 0}, std::vector<double>{0, 0, 0, 0, 1}}) {
    const auto on = s.wrenches(joint, lambda);
    EXPECT_NEAR(on[2].torque.norm(), 1, 1e-14);
    EXPECT_NEAR(on[2].torque.dot(axis), 0, 1e-14);
    expect_wrench(on[1], -on[2].torque, Vec3::Zero());
  }
}

TEST(JointMultipliers, OfASliderAreForcesAcrossTheAxisAndATorqueInTheFrameOfA) {
  const Poses s;
  const Vec3 axis = Vec3(1, 1, 1).normalized();
  const auto joint = Slider::at(s.world, kA, kB, s.p, axis);
  const auto push = s.wrenches(joint, {1, 0, 0, 0, 0});
  EXPECT_NEAR(push[2].force.norm(), 1, 1e-14);
  EXPECT_NEAR(push[2].force.dot(axis), 0, 1e-14);
  expect_wrench(push[2], (s.p - s.B.p).cross(push[2].force), push[2].force);
  // q_AF = q_AB: where the joint is closed, F has the orientation of B.
  expect_wrench(s.wrenches(joint, {0, 0, 1, 2, 3})[2], s.B.q * Vec3(1, 2, 3), Vec3::Zero());
}

TEST(JointMultipliers, OfAUniversalAreAForceAndATorqueAboutBCrossA) {
  const Poses s;
  const Vec3 a = Vec3(1, 1, 1).normalized(), b = Vec3(1, -1, 0).normalized();
  const auto on = s.wrenches(Universal::at(s.world, kA, kB, s.p, a, b), {0, 0, 0, 2});
  expect_wrench(on[2], 2 * b.cross(a), Vec3::Zero());
}

TEST(JointMultipliers, OfAFixedAreAForceAndATorqueInTheFrameOfA) {
  const Poses s;
  const Vec3 f(1, 2, 3), t(4, 5, 6);
  const auto on = s.wrenches(Fixed::at(s.world, kA, kB, s.p), {1, 2, 3, 4, 5, 6});
  expect_wrench(on[2], (s.p - s.B.p).cross(f) + s.B.q * t, f);
}

TEST(JointMultipliers, OfADistanceArePositiveInCompression) {
  const Poses s;
  const Vec3 q = s.p + Vec3(0, 0, 2);
  const auto on = s.wrenches(Distance::between(s.world, kA, kB, s.p, q), {3});
  expect_wrench(on[2], (q - s.B.p).cross(Vec3(0, 0, 3)), Vec3(0, 0, 3));
  expect_wrench(on[1], -(s.p - s.A.p).cross(Vec3(0, 0, 3)), Vec3(0, 0, -3));
}

TEST(JointMultipliers, ReactionsAreReportedAboutTheAnchorOnB) {
  const Poses s;
  const Vec3 axis = Vec3::UnitZ(), other = Vec3::UnitX();
  const auto expect_anchor = [&](const Joint& joint, const Vec3& p_W) {
    EXPECT_LT((s.B.point(joint.reaction_point_B()) - p_W).norm(), 1e-14) << joint.type();
  };
  expect_anchor(Ball::at(s.world, kA, kB, s.p), s.p);
  expect_anchor(Hinge::at(s.world, kA, kB, s.p, axis), s.p);
  expect_anchor(Slider::at(s.world, kA, kB, s.p, axis), s.p);
  expect_anchor(Universal::at(s.world, kA, kB, s.p, axis, other), s.p);
  expect_anchor(Fixed::at(s.world, kA, kB, s.p), s.p);
  expect_anchor(Distance::between(s.world, kA, kB, Vec3(0, 0, 3), s.p), s.p);
}

}  // namespace
}  // namespace taut::joint_multipliers_test
