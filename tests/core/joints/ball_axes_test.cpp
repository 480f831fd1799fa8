#include <numbers>

#include "core/constraints/ball_parts.h"
#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "tests/core/constraints/row_checker.h"
#include "tests/core/expect_invalid.h"

/// Swing, twist and turns of ball joints, and the swing of a universal joint.
namespace taut::ball_axes_test {
namespace {

using testing::expect_invalid;
using testing::kA;
using testing::kB;
using testing::moved;
using testing::pair_of_bodies;
using testing::Random;

/// Values of order one from a few dozen roundings.
constexpr double kRoundOff = 1e-13;

TEST(BallParts, AreConsistentAtRandomPoses) {
  Random random(211);
  for (int i = 0; i < 40; ++i) {
    const Pose A = random.pose();
    Pose B = random.pose();
    // Away from a swing of 0 or π, where the derivatives grow like 1/sin³.
    const row_parts::Swing swing{random.unit(), random.unit()};
    while (swing.directions(A, B).sine < 0.3) B = random.pose();
    testing::check_rows(testing::SinglePart(kA, kB, swing), A, B, random);
    const row_parts::TwistAngle twist{random.rotation(), random.rotation()};
    while (twist.directions(A, B).D < 0.3) B = random.pose();
    testing::check_rows(testing::SinglePart(kA, kB, twist), A, B, random);
  }
}

/// Away from π, at 0 and on both sides of where series take over.
TEST(BallParts, SwingComponentsAreConsistentAtAnySwing) {
  Random random(214);
  for (double bend : {0.0, 1e-9, 1e-4, 0.0199, 0.0201, 0.3, 1.2, 2.4})
    for (int i = 0; i < 10; ++i) {
      const Pose A = random.pose();
      const Vec3 a = random.unit(), x = across(random.unit(), a), j = across(random.unit(), a);
      Pose B = random.pose();
      // b is a, bent about a direction across it.
      const Vec3 b_W = A.q * (exp_so3(bend * j) * a);
      const row_parts::SwingComponent part{a, B.q.conjugate() * b_W, x};
      double s, theta;
      part.residual(A, B, &s);
      row_parts::Swing{part.a_A, part.b_B, {}}.residual(A, B, &theta);
      EXPECT_NEAR(s, bend * j.dot(x), 1e-14 + kRoundOff * bend);
      EXPECT_NEAR(theta, bend, kRoundOff);
      testing::check_rows(testing::SinglePart(kA, kB, part), A, B, random);
    }
}

/// The rates of three turns are ω_B − ω_A in axes of A, what they add up over a motion is its rotation
/// vector, and their bias is the rate of change of their rates.
TEST(BallParts, TurnsFollowTheMotion) {
  Random random(212);
  for (int i = 0; i < 20; ++i) {
    const Pose A = random.pose(), B = random.pose();
    const Twist V_A = random.twist(), V_B = random.twist();
    const row_parts::Turn turn{random.unit()};
    const double h = testing::kDifferenceStep;
    const auto at = [&](const Pose& X, const Twist& V, double t) { return moved(X, t * V.w, t * V.v); };
    const auto rate = [&](double t) {
      double of_a[6], of_b[6];
      JacobianBlock<1> J_A(of_a), J_B(of_b);
      turn.jacobian(at(A, V_A, t), at(B, V_B, t), J_A, J_B);
      EXPECT_EQ((J_A + J_B).norm(), 0);  // third law
      return J_A.head<3>().dot(V_A.w) + J_B.head<3>().dot(V_B.w);
    };
    EXPECT_NEAR(rate(0), turn.a_A.dot(A.q.conjugate() * (V_B.w - V_A.w)), kRoundOff);
    const double forward = turn.increment(A, B, at(A, V_A, h), at(B, V_B, h)),
                 backward = turn.increment(A, B, at(A, V_A, -h), at(B, V_B, -h));
    EXPECT_NEAR(rate(0), (forward - backward) / (2 * h), testing::kDifferenceTolerance);
    double bias;
    turn.bias(A, B, V_A, V_B, &bias);
    EXPECT_NEAR(bias, (rate(h) - rate(-h)) / (2 * h), testing::kDifferenceTolerance);
  }
}

TEST(BallAxes, AreTheSwingAndTheTwistSinceTheJointWasMade) {
  Random random(213);
  for (int i = 0; i < 20; ++i) {
    const Pose A = random.pose(), B = random.pose();
    World world = pair_of_bodies(A, B);
    const Vec3 p = random.vector(), axis = random.unit();
    const JointId joint = world.add("ball", Ball::at(world, kA, kB, p).with_axes(world, axis));
    const AxisId swing = world.axis(joint, "swing"), twist = world.axis(joint, "twist");
    EXPECT_NEAR(world.axis_value(swing), 0, 1e-7);  // round-off of a cosine near 1
    EXPECT_NEAR(world.axis_value(twist), 0, kRoundOff);
    Vec3 across, unused;
    complete_frame(axis, across, unused);
    const double bend = random.uniform(0.1, 3), turned = random.uniform(-3, 3);
    const Quat R = exp_so3(bend * across) * exp_so3(turned * axis);  // first the twist, then the swing
    world.set_pose(kB, {(R * B.q).normalized(), p + R * (B.p - p)});
    EXPECT_NEAR(world.axis_value(swing), bend, kRoundOff);
    EXPECT_NEAR(world.axis_value(twist), turned, kRoundOff);
  }
}

TEST(BallAxes, AccumulateTurnsFromPoseToPose) {
  World world = pair_of_bodies();
  const JointId joint =
      world.add("ball", Ball::at(world, kA, kB, Vec3::Zero()).with_axes(world, Vec3::UnitZ()));
  const AxisId turn = world.axis(joint, "turn_z");
  world.set_friction(turn, AxisFriction{1, 1, 0});
  const Rows rows(world);
  State state = world.state();
  for (int i = 0; i < 100; ++i) {  // ten turns
    const std::vector<Pose> before = state.poses;
    state.poses[2].q = (exp_so3(Vec3(0, 0, 0.2 * std::numbers::pi)) * state.poses[2].q).normalized();
    rows.update_axes({state.poses, 0, state.axes, before}, state.axes);
  }
  EXPECT_NEAR(state.axes[world.axis_index(turn)], 20 * std::numbers::pi, 1e-11);  // a hundred roundings of 60
}

TEST(BallAxes, RefuseWhatNeedsAPosition) {
  World world = pair_of_bodies();
  const JointId joint =
      world.add("hip", Ball::at(world, kA, kB, Vec3::Zero()).with_axes(world, Vec3::UnitZ()));
  const AxisId turn = world.axis(joint, "turn_x");
  expect_invalid([&] { world.set_limits(turn, AxisLimits{-1, 1}); }, {"limits of hip turn_x", "position"});
  expect_invalid([&] { world.set_spring(turn, AxisSpring{1}); }, {"spring of hip turn_x", "position"});
  expect_invalid(
      [&] {
        world.set_motor(turn, AxisMotor{AxisMotor::Mode::kPosition, 1});
      },
      {"position motor of hip turn_x", "position"});
  world.set_motor(turn, AxisMotor{.target = 1});
  expect_invalid([&] { (void)Ball::at(world, kA, kB, Vec3::Zero()).with_axes(world, Vec3(1, 1, 0)); },
                 {"ball axis", "length 1"});
}

/// The swing as a vector: along the arms alone it is the angle about them, and its length is the swing.
TEST(SwingComponents, AreTheSwingAsAVector) {
  World world = pair_of_bodies();
  const JointId cross =
      world.add("cross", Universal::at(world, kA, kB, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()));
  const JointId ball =
      world.add("ball", Ball::at(world, kA, kB, Vec3::Zero()).with_axes(world, Vec3::UnitZ()));
  const auto value = [&](JointId joint, const char* axis) {
    return world.axis_value(world.axis(joint, axis));
  };
  // Frames as the world's at the start: x and y of the swing are those of the world.
  const JointId framed = world.add(
      "framed", Ball(kA, kB, Vec3::Zero(), Vec3::Zero()).with_axes(Quat::Identity(), Quat::Identity()));
  for (const auto& [first, second] : {std::pair{0.4, 0.0}, {0.0, -0.9}, {0.4, -0.7}}) {
    world.set_pose(kB, {exp_so3(first * Vec3::UnitX()) * exp_so3(second * Vec3::UnitY()), Vec3::Zero()});
    for (const JointId joint : {cross, ball}) {
      const bool universal = joint == cross;
      EXPECT_NEAR(std::hypot(value(joint, universal ? "swing_1" : "swing_x"),
                             value(joint, universal ? "swing_2" : "swing_y")),
                  value(joint, "swing"), kRoundOff);
    }
    if (first != 0 && second != 0) continue;
    EXPECT_NEAR(value(cross, "swing_1"), first, kRoundOff);
    EXPECT_NEAR(value(cross, "swing_2"), second, kRoundOff);
    EXPECT_NEAR(value(framed, "swing_x"), first, kRoundOff);
    EXPECT_NEAR(value(framed, "swing_y"), second, kRoundOff);
  }
}

TEST(SwingComponents, AreFiniteWhereTheJointIsFolded) {
  World world = pair_of_bodies({}, {Quat(0, 1, 0, 0), Vec3::Zero()});
  const row_parts::SwingComponent part{Vec3::UnitZ(), Vec3::UnitZ(), Vec3::UnitX()};
  double s, gamma, of_a[6], of_b[6];
  JacobianBlock<1> J_A(of_a), J_B(of_b);
  const Pose &A = world.pose(kA), &B = world.pose(kB);
  part.residual(A, B, &s);
  part.jacobian(A, B, J_A, J_B);
  part.bias(A, B, {Vec3(1, 2, 3), Vec3::Zero()}, {Vec3(3, 1, 2), Vec3::Zero()}, &gamma);
  EXPECT_TRUE(std::isfinite(s) && J_A.allFinite() && J_B.allFinite() && std::isfinite(gamma));
}

TEST(UniversalSwing, IsTheBendOfTheShaft) {
  World world = pair_of_bodies();
  const JointId joint =
      world.add("cross", Universal::at(world, kA, kB, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()));
  const double first = 0.4, second = -0.7;
  world.set_pose(kB, {exp_so3(first * Vec3::UnitX()) * exp_so3(second * Vec3::UnitY()), Vec3::Zero()});
  EXPECT_NEAR(world.axis_value(world.axis(joint, "swing")), std::acos(std::cos(first) * std::cos(second)),
              kRoundOff);
}

}  // namespace
}  // namespace taut::ball_axes_test
