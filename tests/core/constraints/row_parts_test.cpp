#include <numbers>

#include "core/constraints/parallel_part.h"
#include "tests/core/constraints/row_checker.h"

namespace taut::row_parts_test {
namespace {

using namespace row_parts;
using testing::check_rows;
using testing::kA;
using testing::kB;
using testing::moved;
using testing::Random;
using testing::RowChecker;
using testing::SinglePart;
using testing::transformed;

constexpr int kTrials = 50;

/// The part as a joint between bodies A and B.
template <typename Part>
SinglePart<Part> joint(const Part& part) {
  return {kA, kB, part};
}

TEST(RowParts, PointIsConsistent) {
  Random random(1);
  for (int i = 0; i < kTrials; ++i) {
    const Pose A = random.pose(), B = random.pose();
    const Vec3 p_W = random.vector(2);
    check_rows(joint(Point{random.vector(), random.vector()}), A, B, random, {.third_law = false});
    check_rows(joint(Point{A.local(p_W), B.local(p_W)}), A, B, random);
  }
}

/// An open point gives B the force λ at Q and A the force −λ at P: together the couple φ × λ.
TEST(RowParts, PointLeavesTheCoupleOfItsGap) {
  Random random(9);
  const Pose A = random.pose(), B = random.pose();
  const RowChecker rows(joint(Point{random.vector(), random.vector()}));
  const Vec3 f(1, 2, 3), phi = rows.residual(A, B);
  const std::vector<Wrench> on = rows.wrenches(A, B, {1, 2, 3});
  const Vec3 moment = on[1].torque + A.p.cross(on[1].force) + on[2].torque + B.p.cross(on[2].force);
  EXPECT_LT((moment - phi.cross(f)).norm(), 1e-14 * 10);  // roundings of terms of order ten
}

TEST(RowParts, PointInPlaneIsConsistent) {
  Random random(2);
  for (int i = 0; i < kTrials; ++i) {
    const Pose A = random.pose(), B = random.pose();
    check_rows(joint(PointInPlane{random.vector(), random.unit(), random.vector()}), A, B, random);
  }
}

TEST(RowParts, PerpendicularIsConsistent) {
  Random random(3);
  for (int i = 0; i < kTrials; ++i) {
    const Pose A = random.pose(), B = random.pose();
    check_rows(joint(Perpendicular{random.unit(), random.unit()}), A, B, random);
  }
}

/// Directions within a right angle and beyond.
TEST(RowParts, ParallelIsConsistent) {
  Random random(31);
  for (int i = 0; i < kTrials; ++i) {
    const Pose A = random.pose(), B = random.pose();
    Vec3 u, v;
    complete_frame(random.unit(), u, v);
    check_rows(joint(Parallel{u, v, random.unit()}), A, B, random);
  }
}

/// The length of φ grows from 0 to π with the angle, but for a jump from 1 to π/2 at a right angle:
/// directions that point opposite ways are not parallel.
TEST(RowParts, ParallelIsOpenByHalfATurnWhereDirectionsAreOpposite) {
  constexpr double kPi = std::numbers::pi;
  const Pose A;
  for (const double angle : {0.0, 1e-3, 1.0, 1.6, 2.0, 3.0, kPi - 1e-5, kPi - 1e-7, kPi}) {
    Pose B;
    B.q = Quat(Eigen::AngleAxisd(angle, Vec3(0.6, 0.8, 0)));
    double phi[2];
    Parallel{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}.residual(A, B, phi);
    EXPECT_NEAR(std::hypot(phi[0], phi[1]), angle < kPi / 2 ? std::sin(angle) : angle, 2e-7) << angle;
  }
}

TEST(RowParts, DistanceIsConsistent) {
  Random random(4);
  for (int i = 0; i < kTrials; ++i) {
    const Pose A = random.pose();
    Pose B = random.pose();
    B.p += Vec3(5, 0, 0);  // derivatives grow like powers of 1/|d|; keep the points apart
    check_rows(joint(row_parts::Distance{random.vector(), random.vector(), random.uniform(0.5, 3)}), A, B,
               random);
  }
}

TEST(RowParts, StretchIsConsistentAndCountsEndsThatPassedAsNegative) {
  Random random(9);
  for (int i = 0; i < kTrials; ++i) {
    const Pose A = random.pose();
    Pose B = random.pose();
    B.p += Vec3(5, 0, 0);
    check_rows(joint(Stretch{random.vector(), random.vector()}), A, B, random);
  }
  const RowChecker rows(joint(Stretch{Vec3::Zero(), Vec3::Zero()}));
  const std::vector<Pose> before{{}, {}, {Quat::Identity(), Vec3(0.2, 0.1, 0)}},
      after{{}, {}, {Quat::Identity(), Vec3(-0.4, 0.3, 0)}};
  double length = 0;
  rows.rows().residual({after, 0, {}, before}, {&length, 1});
  EXPECT_DOUBLE_EQ(length, -0.5);
  rows.rows().residual({after, 0, {}, after}, {&length, 1});
  EXPECT_DOUBLE_EQ(length, 0.5);
}

/// Residual, Jacobian and bias hold at all angles short of the half turn, where the hemisphere changes.
TEST(RowParts, OrientationIsConsistentAtLargeAngles) {
  Random random(5);
  for (int i = 0; i < kTrials; ++i) {
    const Pose A = random.pose();
    const Quat q_AF = random.rotation(), q_BG = random.rotation();
    const double angle = random.uniform(0, 3.1);
    const Quat q_FG = exp_so3(angle * random.unit());
    const Pose B{(A.q * q_AF * q_FG * q_BG.conjugate()).normalized(), random.vector()};
    const auto orientation = joint(Orientation{q_AF, q_BG});
    check_rows(orientation, A, B, random, {.stiffness = false});
    // φ = 2 sin(angle / 2) along the axis.
    EXPECT_NEAR(RowChecker(orientation).residual(A, B).norm(), 2 * std::sin(angle / 2), 1e-14);
  }
}

TEST(RowParts, OrientationHasNoSymmetricStiffnessWhenClosed) {
  Random random(6);
  for (int i = 0; i < kTrials; ++i) {
    const Pose A = random.pose();
    const Quat q_AF = random.rotation(), q_BG = random.rotation();
    const Pose B{(A.q * q_AF * q_BG.conjugate()).normalized(), random.vector()};
    check_rows(joint(Orientation{q_AF, q_BG}), A, B, random);
  }
}

/// Parts that are measured in axes of the bodies do not see a rigid motion of both at all.
TEST(RowParts, BodyFrameResidualsDoNotChangeUnderRigidMotion) {
  Random random(7);
  for (int i = 0; i < kTrials; ++i) {
    const Pose A = random.pose(), B = random.pose();
    const Quat R = random.rotation();
    const Vec3 t = random.vector();
    const auto expect_unchanged = [&](const auto& part) {
      const RowChecker rows(joint(part));
      const Eigen::VectorXd moved_phi = rows.residual(transformed(R, t, A), transformed(R, t, B));
      EXPECT_LT((moved_phi - rows.residual(A, B)).norm(), testing::kRoundOffTolerance);
    };
    expect_unchanged(PointInPlane{random.vector(), random.unit(), random.vector()});
    expect_unchanged(Perpendicular{random.unit(), random.unit()});
    expect_unchanged(Parallel{Vec3::UnitX(), Vec3::UnitY(), random.unit()});
    expect_unchanged(Orientation{random.rotation(), random.rotation()});
    expect_unchanged(row_parts::Distance{random.vector(), random.vector(), 1});
    // The point's residual is a world vector and turns along.
    const RowChecker point(joint(Point{random.vector(), random.vector()}));
    EXPECT_LT((point.residual(transformed(R, t, A), transformed(R, t, B)) -
               R.toRotationMatrix() * point.residual(A, B))
                  .norm(),
              testing::kRoundOffTolerance);
  }
}

/// Where the points of a distance coincide there is no direction; nothing may become infinite or NaN.
TEST(RowParts, DistanceStaysFiniteAtZero) {
  const RowChecker rows(joint(row_parts::Distance{Vec3(1, 0, 0), Vec3(-1, 0, 0), 0.5}));
  const Pose A{}, B{Quat::Identity(), Vec3(2, 0, 0)};
  const Twist V_A{}, V_B{Vec3(0, 0, 1), Vec3(1, 2, 3)};
  EXPECT_EQ(rows.residual(A, B)[0], -0.5);
  EXPECT_TRUE(rows.jacobian(A, B).allFinite());
  EXPECT_EQ(rows.jacobian(A, B).rightCols<3>().norm(), 1);  // a unit force on B
  EXPECT_TRUE(rows.bias(A, B, V_A, V_B).allFinite());
  for (const StiffnessBlocks& K : rows.stiffness(A, B, {1e10})) {
    EXPECT_TRUE(K.rotation.allFinite());
    EXPECT_TRUE(K.translation.allFinite());
  }
}

TEST(RowParts, RowsHaveNames) {
  const RowChecker point(joint(Point{Vec3::Zero(), Vec3::Zero()}));
  EXPECT_EQ(point.rows().row_name(0), "translation along world x");
  EXPECT_EQ(point.rows().row_name(2), "translation along world z");
  const RowChecker orientation(joint(Orientation{Quat::Identity(), Quat::Identity()}));
  EXPECT_EQ(orientation.rows().row_name(1), "rotation about joint y");
  EXPECT_EQ(RowChecker(joint(row_parts::Distance{Vec3::Zero(), Vec3::Zero(), 1})).rows().row_name(0),
            "distance");
}

/// A point with one mistake of the author's choice.
struct BrokenPoint : Point {
  enum class Mistake { kJacobianSign, kBias, kStiffness, kThirdLaw, kFrame } mistake;
  BrokenPoint(const Vec3& p, const Vec3& q, Mistake m) : Point{p, q}, mistake(m) {}

  void residual(const Pose& A, const Pose& B, double* phi) const {
    Point::residual(A, B, phi);
    if (mistake == Mistake::kFrame) phi[0] += 0.1 * A.p.x();
  }
  void jacobian(const Pose& A, const Pose& B, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const {
    Point::jacobian(A, B, J_A, J_B);
    if (mistake == Mistake::kJacobianSign) J_B.leftCols<3>() *= -1;
    if (mistake == Mistake::kThirdLaw) J_A.setZero();
  }
  void bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
    Point::bias(A, B, V_A, V_B, gamma);
    if (mistake == Mistake::kBias) gamma[1] *= 1.001;
  }
  void stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                 StiffnessBlocks& K_B) const {
    Point::stiffness(A, B, lambda, K_A, K_B);
    if (mistake == Mistake::kStiffness) K_A.rotation *= -1;
  }
};

/// The checker itself: each kind of mistake is seen by the check that is there for it.
TEST(RowChecker, SeesMistakes) {
  using enum BrokenPoint::Mistake;
  Random random(8);
  const Pose A = random.pose(), B = random.pose();
  const Twist V_A = random.twist(), V_B = random.twist();
  const Vec3 p = random.vector(), q = random.vector();
  const std::vector<double> lambda{0.3, -0.5, 0.7};
  const auto broken = [&](BrokenPoint::Mistake m) { return RowChecker(joint(BrokenPoint(p, q, m))); };
  constexpr double kClear = 1e-5;  // three orders above the tolerance that correct rows keep
  EXPECT_GT(broken(kJacobianSign).jacobian_error(A, B), kClear);
  EXPECT_GT(broken(kBias).bias_error(A, B, V_A, V_B), kClear);
  EXPECT_GT(broken(kStiffness).stiffness_error(A, B, lambda), kClear);
  EXPECT_GT(broken(kThirdLaw).third_law_error(A, B, lambda), kClear);
  EXPECT_GT(broken(kFrame).invariance_error(A, B, random.rotation(), random.vector()), kClear);
}

}  // namespace
}  // namespace taut::row_parts_test
