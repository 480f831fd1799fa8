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

}  // namespace
}  // namespace taut::so3_test
