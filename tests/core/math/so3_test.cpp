#include "core/math/so3.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/core/random_state.h"

namespace taut::so3_test {
namespace {

using testing::Random;

constexpr double kPi = std::numbers::pi;

TEST(So3, ExponentialIsTheRotationAboutTheAxis) {
  Random random(61);
  for (double angle : {0.0, 1e-12, 0.99e-8, 1.01e-8, 1e-4, 1.0, 3.0, 6.0}) {
    const Vec3 axis = random.unit();
    const Quat q = exp_so3(angle * axis);
    const Mat3 expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    EXPECT_LT((q.toRotationMatrix() - expected).norm(), 1e-14) << angle;  // some roundings
    EXPECT_NEAR(q.norm(), 1, 1e-15) << angle;
  }
}

TEST(So3, LogarithmInvertsTheExponential) {
  Random random(62);
  for (double angle : {0.0, 1e-12, 0.99e-8, 1.01e-8, 1e-4, 1.0, 3.0, kPi - 1e-9}) {
    const Vec3 theta = angle * random.unit();
    const Quat q = exp_so3(theta);
    EXPECT_LT((log_so3(q) - theta).norm(), 1e-15 + 1e-15 * 10 * angle) << angle;
    EXPECT_EQ(log_so3(Quat(-q.w(), -q.x(), -q.y(), -q.z())), log_so3(q));
  }
  // Beyond half a turn the shorter way is found.
  EXPECT_LT((log_so3(exp_so3(Vec3(0, 0, 1.5 * kPi))) - Vec3(0, 0, -0.5 * kPi)).norm(), 1e-14);
}

TEST(So3, SkewIsTheCrossProduct) {
  Random random(63);
  const Vec3 a = random.vector(), b = random.vector();
  EXPECT_EQ(Vec3(skew(a) * b), a.cross(b));
}

TEST(So3, FramesAreRightHandedAndOrthonormal) {
  Random random(64);
  for (int i = 0; i < 50; ++i) {
    Mat3 frame;
    Vec3 x, y;
    const Vec3 z = i < 3 ? Vec3(Vec3::Unit(i)) : random.unit();
    complete_frame(z, x, y);
    frame << x, y, z;
    EXPECT_LT((frame.transpose() * frame - Mat3::Identity()).norm(), 1e-15 * 4);
    EXPECT_GT(frame.determinant(), 0);
  }
}

/// Also where the directions are all but opposite.
TEST(So3, TheRotationBetweenTwoDirectionsIsTheLeastOne) {
  Random random(63);
  for (double angle : {0.0, 1e-9, 0.3, 2.0, 2.6, 2.7, kPi - 1e-3, kPi - 1e-6, kPi - 1e-9, kPi - 1e-15, kPi}) {
    const Vec3 from = random.unit();
    Vec3 across, other;
    complete_frame(from, across, other);
    const Vec3 to = std::cos(angle) * from + std::sin(angle) * across;
    const Quat q = rotation_between(3 * from, 0.2 * to);
    EXPECT_NEAR(q.norm(), 1, 1e-13) << angle;  // 1e-16 / 0.001
    EXPECT_LT((q * from - to).norm(), 2e-13) << angle;
    EXPECT_NEAR(log_so3(q).norm(), angle, 1e-13) << angle;
  }
  for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
    const Quat q = rotation_between(axis, -axis);
    EXPECT_LT((q * axis + axis).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace taut::so3_test
