#include "core/axes/axis.h"

#include <numbers>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "tests/core/constraints/row_checker.h"

namespace taut::axis_test {
namespace {

using testing::kA;
using testing::kB;
using testing::moved;
using testing::pair_of_bodies;
using testing::Random;

constexpr double kPi = std::numbers::pi;

/// Values of order ten from a few dozen roundings.
constexpr double kRoundOff = 1e-13;

// The coordinates.

TEST(AxisParts, AreConsistentAtRandomPoses) {
  Random random(101);
  for (int i = 0; i < 40; ++i) {
    const Pose A = random.pose(), B = random.pose();
    const Vec3 a = random.unit();
    Vec3 u, v;
    complete_frame(a, u, v);
    // Away from where the projection of e vanishes: the derivatives grow like 1/|p|³ there.
    row_parts::Angle angle{a, u, random.unit()};
    while (angle.directions(A, B).D < 0.3) angle.e_B = random.unit();
    testing::check_rows(testing::SinglePart(kA, kB, angle), A, B, random);
    const row_parts::Displacement displacement{{random.vector(), a, random.vector()}};
    testing::check_rows(testing::SinglePart(kA, kB, displacement), A, B, random);
  }
}

TEST(AxisParts, AngleIsUnwrappedNextToAReference) {
  EXPECT_NEAR(unwrapped(0.5, 40, 2 * kPi), 0.5 + 12 * kPi, kRoundOff);
  EXPECT_NEAR(unwrapped(-3, 3.2, 2 * kPi), -3 + 2 * kPi, kRoundOff);
  EXPECT_EQ(unwrapped(1, 1.5, 2 * kPi), 1);
}

/// Two bodies in random poses with one joint of type `Made` and limits on all its axes.
struct Jointed {
  Random random;
  World world;
  JointId joint;

  template <typename Make>
  Jointed(unsigned seed, Make make) : random(seed), world() {
    const Pose A = random.pose(), B = random.pose();
    world = pair_of_bodies(A, B);
    joint = world.add_joint("joint", make(world, random));
    for (int k = 0; k < world.axis_count(joint); ++k) world.set_limits({joint, k}, AxisLimits{-1, 1});
  }
  void turn_b(const Vec3& rotation, const Vec3& p_W) {
    const Pose& B = world.pose(kB);
    const Quat R = exp_so3(rotation);
    world.set_pose(kB, {(R * B.q).normalized(), p_W + R * (B.p - p_W)});
  }
};

TEST(Axes, OfAHingeIsTheAngleSinceItWasMade) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Vec3 p, axis;
    Jointed s(seed, [&](const World& world, Random& random) {
      p = random.vector(), axis = random.unit();
      return std::make_shared<Hinge>(Hinge::at(world, kA, kB, p, axis));
    });
    const AxisId angle = s.world.axis(s.joint, "angle");
    EXPECT_NEAR(s.world.axis_value(angle), 0, 1e-15 * 10);
    const double turn = s.random.uniform(-3, 3);
    s.turn_b(turn * axis, p);
    EXPECT_NEAR(s.world.axis_value(angle), turn, kRoundOff);
    s.world.set_twist(kA, {Vec3(1, 2, 3), Vec3::Zero()});
    s.world.set_twist(kB, {Vec3(1, 2, 3) - 2.5 * axis, Vec3::Zero()});
    EXPECT_NEAR(s.world.axis_rate(angle), -2.5, kRoundOff);
  }
}

TEST(Axes, OfAHingeGivenByAxesStartsWhereItsReferencesAgree) {
  World world = pair_of_bodies();
  const Vec3 z = Vec3::UnitZ(), x = Vec3::UnitX(), y = Vec3::UnitY(), o = Vec3::Zero();
  const JointId plain = world.add("plain", Hinge(kA, kB, o, z, o, z));
  const JointId quarter = world.add("quarter", Hinge(kA, kB, o, z, x, o, z, y));
  EXPECT_EQ(world.axis_value(world.axis(plain, "angle")), 0);  // equal axes, equal orientations
  EXPECT_NEAR(world.axis_value(world.axis(quarter, "angle")), kPi / 2, kRoundOff);
}

TEST(Axes, OfASliderIsTheDisplacement) {
  Vec3 axis;
  Jointed s(3, [&](const World& world, Random& random) {
    axis = random.unit();
    return std::make_shared<Slider>(Slider::at(world, kA, kB, random.vector(), axis));
  });
  const AxisId along = s.world.axis(s.joint, "displacement");
  EXPECT_NEAR(s.world.axis_value(along), 0, kRoundOff);
  s.world.set_pose(kB, {s.world.pose(kB).q, s.world.pose(kB).p - 1.75 * axis});
  EXPECT_NEAR(s.world.axis_value(along), -1.75, kRoundOff);
}

TEST(Axes, OfAUniversalAreTheTurnsAboutItsArms) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Vec3 p, a, b, unused;
    Jointed s(seed, [&](const World& world, Random& random) {
      p = random.vector(), a = random.unit();
      complete_frame(a, b, unused);
      return std::make_shared<Universal>(Universal::at(world, kA, kB, p, a, b));
    });
    const double first = s.random.uniform(-3, 3), second = s.random.uniform(-3, 3);
    s.turn_b(second * b, p);
    s.turn_b(first * a, p);
    EXPECT_NEAR(s.world.axis_value(s.world.axis(s.joint, "angle_1")), first, kRoundOff);
    EXPECT_NEAR(s.world.axis_value(s.world.axis(s.joint, "angle_2")), second, kRoundOff);
    const Vec3 arm_b = exp_so3(first * a) * b;
    s.world.set_twist(kB, {0.5 * a - 0.25 * arm_b, Vec3::Zero()});
    EXPECT_NEAR(s.world.axis_rate(s.world.axis(s.joint, "angle_1")), 0.5, kRoundOff);
    EXPECT_NEAR(s.world.axis_rate(s.world.axis(s.joint, "angle_2")), -0.25, kRoundOff);
  }
}

TEST(Axes, CountTurnsAndRestoreThem) {
  Vec3 p, axis;
  Jointed s(7, [&](const World& world, Random& random) {
    p = random.vector(), axis = random.unit();
    return std::make_shared<Hinge>(Hinge::at(world, kA, kB, p, axis));
  });
  const AxisId angle = s.world.axis(s.joint, "angle");
  const Rows rows(s.world);
  double total = 0;
  for (double step : {0.7, -1.3}) {  // up to nearly seven turns, then down through zero to minus six
    for (int i = 0; i < 60; ++i) {
      s.turn_b(step * axis, p);
      total += step;
      State state = s.world.state();
      rows.update_axes(state, state.axes);
      s.world.set_state(state);
      // 120 roundings of rotations and angles up to 40.
      ASSERT_NEAR(s.world.axis_value(angle), total, 1e-11);
    }
    if (step > 0) {
      EXPECT_GT(total, 6 * 2 * kPi);
    }
  }
  EXPECT_LT(total, -5 * 2 * kPi);
  // A state brings its turns back bit for bit.
  const State kept = s.world.state();
  s.world.set_axis_turns(angle, 100);
  EXPECT_NEAR(s.world.axis_value(angle), total + 22 * 2 * kPi, 1e-11);
  s.world.set_state(kept);
  EXPECT_EQ(s.world.state().axes, kept.axes);
  EXPECT_EQ(s.world.axis_value(angle), kept.axes[s.world.axis_index(angle)]);
}

// Their rows.

TEST(AxisRows, StandBehindTheEqualityRowsOfTheirJoint) {
  World world = pair_of_bodies();
  const JointId hinge = world.add("hinge", Hinge::at(world, kGround, kA, Vec3(1, 0, 0), Vec3::UnitZ()));
  const JointId universal =
      world.add("universal", Universal::at(world, kA, kB, Vec3(0, 1, 0), Vec3::UnitX(), Vec3::UnitY()));
  EXPECT_EQ(Rows(world).row_count(), 9);
  EXPECT_TRUE(Rows(world).axis_rows().empty());
  world.set_friction(world.axis(hinge, "angle"), AxisFriction{1, 1, 0});
  world.set_motor(world.axis(universal, "angle_2"), AxisMotor{});

  const Rows rows(world);
  ASSERT_EQ(rows.row_count(), 11);
  EXPECT_EQ(rows.joints()[0].row_count, 6);
  EXPECT_EQ(rows.joints()[0].equality_count, 5);
  EXPECT_EQ(rows.joints()[1].first_row, 6);
  EXPECT_EQ(rows.joints()[1].equality_count, 4);
  ASSERT_EQ(rows.axis_rows().size(), 2u);
  EXPECT_EQ(rows.axis_rows()[0].row, 5);
  EXPECT_EQ(*rows.axis_rows()[0].axis(), (AxisId{hinge, 0}));
  EXPECT_EQ(rows.axis_rows()[1].row, 10);
  EXPECT_EQ(*rows.axis_rows()[1].axis(), (AxisId{universal, 1}));
  for (int r = 0; r < rows.row_count(); ++r) EXPECT_EQ(rows.is_equality(r), r != 5 && r != 10);
  EXPECT_EQ(rows.joint_of(10), universal);
  EXPECT_TRUE(rows.row(10).angular);
  const Rows without(world, Rows::AxisRows::kLeftOut);
  EXPECT_EQ(without.row_count(), 9);
  EXPECT_TRUE(without.axis_rows().empty());
}

/// Residual, Jacobian and bias of all rows against the World's axis values and their differences in time.
TEST(AxisRows, FollowTheMotionOfTheirAxes) {
  Random random(111);
  for (int trial = 0; trial < 20; ++trial) {
    const Pose A = random.pose(), B = random.pose();
    World world = pair_of_bodies(A, B);
    const Vec3 p = random.vector(), a = random.unit();
    Vec3 b, unused;
    complete_frame(a, b, unused);
    world.add("u", Universal::at(world, kA, kB, p, a, b));
    world.add("s", Slider::at(world, kA, kB, p, a));
    for (AxisId id : {AxisId{{0}, 0}, AxisId{{0}, 1}, AxisId{{1}, 0}}) world.set_limits(id, AxisLimits{});
    world.set_axis_turns({{0}, 0}, 20);
    const Rows rows(world);
    const Twist V_A = random.twist(), V_B = random.twist();
    world.set_twist(kA, V_A);
    world.set_twist(kB, V_B);
    const double h = testing::kDifferenceStep;
    const auto at = [&](double t) {
      State state = world.state();
      state.poses = {{}, moved(A, t * V_A.w, t * V_A.v), moved(B, t * V_B.w, t * V_B.v)};
      return state;
    };
    const auto residual = [&](double t) {
      Eigen::VectorXd phi(rows.row_count());
      rows.residual(at(t), {phi.data(), phi.data() + phi.size()});
      return phi;
    };
    const auto rate = [&](double t) {
      const State state = at(t);
      std::vector<double> J(rows.jacobian_size());
      Eigen::VectorXd out(rows.row_count());
      rows.jacobian(state, J);
      rows.apply(J, state.twists, {out.data(), out.data() + out.size()});
      return out;
    };
    Eigen::VectorXd bias(rows.row_count());
    rows.bias(world.state(), world.state().twists, {bias.data(), bias.data() + bias.size()});
    // Angles near 20 cost the first difference two digits: 20 u / h = 7e-10.
    EXPECT_LT((rate(0) - (residual(h) - residual(-h)) / (2 * h)).cwiseAbs().maxCoeff(), 2e-8);
    EXPECT_LT((bias - (rate(h) - rate(-h)) / (2 * h)).cwiseAbs().maxCoeff(), 2e-8);
    for (const Rows::AxisRow& r : rows.axis_rows()) {
      EXPECT_EQ(residual(0)[r.row], world.axis_value(*r.axis()));
      EXPECT_NEAR(rate(0)[r.row], world.axis_rate(*r.axis()), kRoundOff);
    }
    EXPECT_NEAR(world.axis_value({{0}, 0}), 6 * kPi, kRoundOff);  // 20 is next to three turns
  }
}

TEST(AxisRows, PushBTowardsLargerValues) {
  World world = pair_of_bodies({}, {Quat::Identity(), Vec3(2, 0, 0)});
  const JointId hinge = world.add("hinge", Hinge::at(world, kA, kB, Vec3(1, 0, 0), Vec3::UnitZ()));
  const JointId slider = world.add("slider", Slider::at(world, kA, kB, Vec3(1, 0, 0), Vec3::UnitY()));
  world.set_limits({hinge, 0}, AxisLimits{});
  world.set_limits({slider, 0}, AxisLimits{});
  const Rows rows(world);
  std::vector<double> J(rows.jacobian_size()), lambda(rows.row_count(), 0.0);
  rows.jacobian(world.state(), J);
  std::vector<Wrench> on(3);
  lambda[rows.axis_rows()[0].row] = 3;
  rows.apply_transpose(J, lambda, on);
  EXPECT_LT((on[2].torque - Vec3(0, 0, 3)).norm() + on[2].force.norm(), kRoundOff);
  EXPECT_LT((on[1].torque + Vec3(0, 0, 3)).norm() + on[1].force.norm(), kRoundOff);
  lambda.assign(lambda.size(), 0.0);
  lambda[rows.axis_rows()[1].row] = 3;
  rows.apply_transpose(J, lambda, on);
  EXPECT_LT((on[2].force - Vec3(0, 3, 0)).norm(), kRoundOff);
  EXPECT_LT((on[1].force + Vec3(0, 3, 0)).norm(), kRoundOff);
}

TEST(Axis, ThatStartsBeyondALimitIsReported) {
  World world = pair_of_bodies();
  const AxisId angle{world.add("elbow", Hinge::at(world, kA, kB, Vec3(1, 0, 0), Vec3::UnitZ())), 0};
  world.set_limits(angle, AxisLimits{.lower = 0, .upper = 5e-7});  // it is at one of them
  EXPECT_TRUE(world.validate().empty());
  world.set_limits(angle, AxisLimits{.lower = 0.25, .upper = 1});
  ASSERT_EQ(world.validate().size(), 1u);
  EXPECT_EQ(world.validate()[0].subject, "hinge elbow");
  EXPECT_EQ(world.validate()[0].message, "axis angle starts at 0, below its lower limit 0.25");
  EXPECT_TRUE(world.validate(0.3).empty());
  world.set_axis_turns(angle, 6);
  ASSERT_EQ(world.validate().size(), 1u);
  EXPECT_EQ(world.validate()[0].message, "axis angle starts at 6.28319, above its upper limit 1");
  world.set_limits(angle, AxisLimits{.lower = 0.25, .upper = 1, .compliance = 1e-3});
  EXPECT_TRUE(world.validate().empty());  // a spring may be stretched
  world.set_limits(angle, AxisLimits{.upper = 1});
  world.detach(angle.joint);
  EXPECT_TRUE(world.validate().empty());
}

TEST(AxisRows, DoNotCountAsGaps) {
  World world = pair_of_bodies();
  const JointId hinge = world.add("hinge", Hinge::at(world, kA, kB, Vec3(1, 0, 0), Vec3::UnitZ()));
  world.set_limits({hinge, 0}, AxisLimits{});
  world.set_axis_turns({hinge, 0}, 31);
  EXPECT_TRUE(world.validate().empty());
  const Rows rows(world);
  std::vector<double> phi(rows.row_count());
  rows.residual(world.state(), phi);
  EXPECT_NEAR(phi[5], 10 * kPi, kRoundOff);
  EXPECT_LT(max_gap(rows, phi).radians, 1e-15);
}

}  // namespace
}  // namespace taut::axis_test
