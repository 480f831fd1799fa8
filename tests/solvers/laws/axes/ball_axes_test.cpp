#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"

/// Cones, twist limits and friction of ball joints, and friction that grows with the load.
namespace taut::ball_axes_test {
namespace {

constexpr double kG = 9.81;

void run(Simulator& simulator, double dt, int steps) {
  for (int i = 0; i < steps; ++i) {
    const StepReport& r = simulator.step(dt);
    ASSERT_TRUE(r.exact()) << "step " << i << ": " << r.message;
    ASSERT_LE(r.complementarity_residual, 1e-9);
    ASSERT_LE(std::max(r.gap.metres, r.gap.radians), 1e-9);
    ASSERT_NEAR(r.ledger.start + r.ledger.total(), r.energy(), 1e-11 * (1 + std::abs(r.energy()))) << i;
  }
}

/// A rod of 1 m and 2 kg along x, held at the origin by a ball joint whose axis is x, or by a universal one.
struct Arm {
  World world;
  BodyId rod;
  JointId joint;
  double inertia_x, inertia_y;
  explicit Arm(bool universal = false) {
    const MassProperties m = MassProperties::box(Vec3(1, 0.1, 0.1), 2);
    rod = world.add_body({.mass = m, .pose = {.p = Vec3(0.5, 0, 0)}});
    const Vec3 p = Vec3::Zero(), x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
    joint = universal ? world.add("shoulder", Universal::at(world, kGround, rod, p, y, z))
                      : world.add("shoulder", Ball::at(world, kGround, rod, p).with_axes(world, x));
    inertia_x = m.inertia_B()(0, 0);
    inertia_y = m.inertia_B()(1, 1) + 2 * 0.25;
  }
  AxisId axis(const char* name) const { return world.axis(joint, name); }
};

TEST(BallCone, HoldsTheArmAtItsAngle) {
  Arm arm;
  arm.world.set_limits(arm.axis("swing"), AxisLimits{.upper = 0.5});
  arm.world.set_friction(arm.axis("turn_z"), AxisFriction{.viscous = 0.3});
  Simulator simulator(arm.world);
  for (int i = 0; i < 400; ++i) {
    run(simulator, 5e-3, 1);
    ASSERT_LE(arm.world.axis_value(arm.axis("swing")), 0.5 + 1e-9) << i;
  }
  EXPECT_NEAR(arm.world.axis_value(arm.axis("swing")), 0.5, 1e-9);
  EXPECT_NEAR(simulator.axis_report(arm.axis("swing")).force.limit, -2 * kG * 0.5 * std::cos(0.5), 1e-6);
}

/// Along the cone the arm is a spherical pendulum that never leaves it: energy and vertical spin are kept.
TEST(BallCone, LetsTheArmCircleAlongIt) {
  World world;
  const MassProperties m = MassProperties::sphere(0.05, 1);
  const double angle = 0.6;
  const Vec3 p(std::sin(angle), 0, std::cos(angle));  // above the joint: it leans on the cone
  const BodyId ball = world.add_body({.mass = m, .pose = {.p = p}});
  const Quat q_BG = exp_so3(Vec3(0, angle, 0));  // z of G from the joint to the ball
  const JointId joint =
      world.add("", Ball::at(world, kGround, ball, Vec3::Zero()).with_axes(Quat::Identity(), q_BG));
  world.set_limits(world.axis(joint, "swing"), AxisLimits{.upper = angle});
  const double rate = 2;  // about the vertical
  world.set_twist(ball, {Vec3(0, 0, rate), Vec3(0, 0, rate).cross(p)});
  Simulator simulator(world);
  const double energy = simulator.step(1e-3).energy();
  run(simulator, 1e-3, 999);
  EXPECT_NEAR(simulator.report().energy(), energy, 1e-8);
  EXPECT_NEAR(world.axis_value(world.axis(joint, "swing")), angle, 1e-9);
  const Vec3 there = world.pose(ball).p;
  EXPECT_NEAR(std::remainder(std::atan2(there.y(), there.x()) - rate, 2 * std::numbers::pi), 0, 1e-5);
}

TEST(BallTwist, StopsAtItsLimitAfterMoreThanATurn) {
  Arm arm;
  arm.world.set_gravity(Vec3::Zero());
  arm.world.set_limits(arm.axis("twist"), AxisLimits{.upper = 8});
  arm.world.set_twist(arm.rod, {Vec3(10, 0, 0), Vec3::Zero()});
  Simulator simulator(arm.world);
  run(simulator, 5e-3, 250);
  EXPECT_NEAR(arm.world.axis_value(arm.axis("twist")), 8, 1e-9);
  EXPECT_LE(arm.world.twist(arm.rod).w.norm(), 1e-9);
}

/// At a swing of π the twist has no value; a motor that turns it there asks for what no torque does.
TEST(BallTwist, ThatLosesItsMeaningIsNamed) {
  Arm arm;
  arm.world.set_gravity(Vec3::Zero());
  const Quat q = exp_so3(Vec3(0, 3, 0));
  arm.world.set_pose(arm.rod, {q, q * Vec3(0.5, 0, 0)});
  const Vec3 w(0, 2, 0.2);
  arm.world.set_twist(arm.rod, {w, w.cross(q * Vec3(0.5, 0, 0))});
  arm.world.set_motor(arm.axis("twist"), AxisMotor{.target = 1});
  Simulator simulator(arm.world);
  for (int i = 0; i < 100 && simulator.report().exact(); ++i) (void)simulator.step(2e-3);
  EXPECT_EQ(simulator.report().status, Status::kNotConverged);
  EXPECT_NE(simulator.report().message.find("ball shoulder twist is next to"), std::string::npos)
      << simulator.report().message;
  EXPECT_GT(arm.world.axis_value(arm.axis("swing")), 3.1);
}

TEST(BallFriction, HoldsTheArmWithoutCreepBelowItsBound) {
  Arm arm;
  const double moment = 2 * kG * 0.5;
  for (const char* name : {"turn_x", "turn_y", "turn_z"})
    arm.world.set_friction(arm.axis(name), AxisFriction{1.01 * moment, 0.5 * moment, 0});
  Simulator simulator(arm.world);
  run(simulator, 1e-2, 1000);
  EXPECT_LE((arm.world.pose(arm.rod).p - Vec3(0.5, 0, 0)).norm(), 1e-9);
  double square = 0;
  for (const char* name : {"turn_x", "turn_y", "turn_z"})
    square += std::pow(simulator.axis_report(arm.axis(name)).force.friction, 2);
  EXPECT_NEAR(std::sqrt(square), moment, 1e-7);
}

class SwingFriction : public ::testing::TestWithParam<bool> {
 protected:
  static bool universal() { return GetParam(); }
};

/// At a swing of 0 that axis has no direction; a torque about any is held, and slips with what is left of it.
TEST_P(SwingFriction, OfAStraightSwingActsAboutAnyDirection) {
  const double moment = 2 * kG * 0.5, dynamic = 0.5 * moment;
  for (int k = 0; k < 8; ++k) {
    const double angle = 0.1 + k * std::numbers::pi / 4;
    const Vec3 down(0, std::cos(angle), std::sin(angle));
    for (const double limit : {1.01 * moment, 0.99 * moment}) {
      Arm arm(universal());
      arm.world.set_gravity(kG * down);
      arm.world.set_friction(arm.axis("swing"), AxisFriction{limit, dynamic, 0});
      Simulator simulator(arm.world);
      run(simulator, 1e-3, 50);
      const double swing = 0.5 * (moment - dynamic) / arm.inertia_y * 0.05 * 0.05;
      const Vec3 moved = arm.world.pose(arm.rod).p - Vec3(0.5, 0, 0);
      if (limit > moment) {
        run(simulator, 1e-2, 500);
        EXPECT_LE((arm.world.pose(arm.rod).p - Vec3(0.5, 0, 0)).norm(), 1e-9) << k;
      } else {
        EXPECT_NEAR(arm.world.axis_value(arm.axis("swing")), swing, 1e-2 * swing) << k;
        EXPECT_GT(moved.dot(down), 0.9999 * moved.norm()) << k;
      }
    }
  }
}

/// As above, where the inertia about one direction is a third of that about the other: what slips is against
/// its friction.
TEST_P(SwingFriction, OfAStraightSwingIsOpposedToItsRate) {
  World world;
  const BodyId body = world.add_body({.mass = MassProperties(1, Vec3(0.3, 0.9, 0.7))});
  const Vec3 p = Vec3::Zero();
  const JointId joint =
      universal() ? world.add("", Universal::at(world, kGround, body, p, Vec3::UnitX(), Vec3::UnitY()))
                  : world.add("", Ball::at(world, kGround, body, p).with_axes(world, Vec3::UnitZ()));
  world.set_friction(world.axis(joint, "swing"), AxisFriction{0.3, 0.3, 0});
  world.set_gravity(Vec3::Zero());
  const Vec3 rate(0.4, 0.3, 0);
  world.set_twist(body, {rate, Vec3::Zero()});
  Simulator simulator(world);
  run(simulator, 1e-4, 1);
  const Vec3 change = (world.twist(body).w - rate) / 1e-4;
  EXPECT_NEAR(change.x(), -0.3 * 0.8 / 0.3, 1e-3);
  EXPECT_NEAR(change.y(), -0.3 * 0.6 / 0.9, 1e-3);
}

/// Joints of two free bodies, straight at first, some of them with a motor on a turn across the swing.
TEST_P(SwingFriction, OfRandomJointsLetsThemMove) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(random); };
    const auto within = [&](double a) { return Vec3(uniform(-a, a), uniform(-a, a), uniform(-a, a)); };
    World world;
    BodyId body[2];
    for (int i = 0; i < 2; ++i) {
      const Vec3 size = Vec3(0.25, 0.25, 0.25) + within(0.15);
      body[i] = world.add_body({.mass = MassProperties::box(size, uniform(1, 5)),
                                .pose = {.p = Vec3(0, 0, -0.4 * i) + within(0.2)}});
      world.set_twist(body[i], {within(0.3), within(0.1)});
    }
    const Quat q = Quat(Eigen::Vector4d(within(1).homogeneous())).normalized();
    const Vec3 p = within(0.1), x = q * Vec3::UnitX(), y = q * Vec3::UnitY();
    const JointId joint = universal()
                              ? world.add("", Universal::at(world, body[0], body[1], p, x, y))
                              : world.add("", Ball::at(world, body[0], body[1], p).with_axes(world, x));
    const double friction = uniform(0.5, 20);
    world.set_friction(world.axis(joint, "swing"), AxisFriction{friction * uniform(1, 1.5), friction});
    if (seed % 3 == 0)
      world.set_motor(world.axis(joint, universal() ? "angle_1" : "turn_x"),
                      AxisMotor{.target = uniform(-3, 3), .max_force = uniform(1, 30)});
    Simulator simulator(world);
    run(simulator, 2e-3, 150);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SwingFriction, ::testing::Bool(),
                         [](const auto& universal) { return universal.param ? "universal" : "ball"; });

TEST(BallFriction, HoldsAStraightSwingWhileAMotorTwists) {
  for (const double force : {20.0, 2000.0}) {
    Arm arm;
    arm.world.set_gravity(Vec3::Zero());
    arm.world.set_friction(arm.axis("swing"), AxisFriction{12, 4, 0});
    arm.world.set_motor(arm.axis("twist"),
                        AxisMotor{.mode = AxisMotor::Mode::kPosition, .target = -1, .max_force = force});
    Simulator simulator(arm.world);
    run(simulator, 5e-3, 100);
    EXPECT_NEAR(arm.world.axis_value(arm.axis("twist")), -1, 1e-8);
    EXPECT_LE((arm.world.pose(arm.rod).p - Vec3(0.5, 0, 0)).norm(), 1e-9);
  }
}

TEST(BallFriction, SlowsASpinByItsTorqueAndStopsIt) {
  Arm arm;
  arm.world.set_gravity(Vec3::Zero());
  const double torque = 0.01;
  arm.world.set_friction(arm.axis("turn_z"), AxisFriction{torque, torque, 0});  // z of its frame is x
  arm.world.set_twist(arm.rod, {Vec3(5, 0, 0), Vec3::Zero()});
  Simulator simulator(arm.world);
  run(simulator, 1e-3, 1000);
  EXPECT_NEAR(arm.world.twist(arm.rod).w.x(), 5 - torque / arm.inertia_x * 1.0, 1e-9);
  run(simulator, 1e-3, 1000);
  EXPECT_LE(arm.world.twist(arm.rod).w.norm(), 1e-9);
}

TEST(BallMotor, TurnsAtAGivenVelocityAboutAnAxisOfA) {
  Arm arm;
  arm.world.set_gravity(Vec3::Zero());
  for (const char* name : {"turn_x", "turn_y"})
    arm.world.set_motor(arm.axis(name), AxisMotor{.target = name[5] == 'x' ? 1.5 : 0});
  Simulator simulator(arm.world);
  run(simulator, 1e-3, 1000);
  // x of the joint's frame is fixed in the ground: a rotation of 1.5 rad about it.
  Vec3 x, y;
  complete_frame(Vec3::UnitX(), x, y);
  EXPECT_LE((arm.world.twist(arm.rod).w - 1.5 * x).norm(), 1e-8);
  EXPECT_LE((arm.world.pose(arm.rod).p - exp_so3(1.5 * x) * Vec3(0.5, 0, 0)).norm(), 1e-4);
}

/// A block on a slope holds or slides by the angle of friction.
TEST(LoadFriction, OfASliderIsCoulombsLaw) {
  for (double slope : {0.28, 0.32}) {
    World world;
    const BodyId block = world.add_body({.mass = MassProperties::box(Vec3(0.1, 0.1, 0.1), 2)});
    const JointId slide = world.add(
        "", Slider::at(world, kGround, block, Vec3::Zero(), Vec3(std::cos(slope), 0, -std::sin(slope))));
    const AxisId axis = world.axis(slide, "displacement");
    const double mu = 0.3;
    world.set_friction(axis, AxisFriction{.per_load = mu});
    Simulator simulator(world);
    run(simulator, 1e-2, 100);
    const double a = std::max(0.0, kG * (std::sin(slope) - mu * std::cos(slope)));
    EXPECT_NEAR(world.axis_value(axis), 0.5 * a, 1e-8) << slope;
  }
}

/// A pendulum in a pin of radius r: the load has a part of gravity and one of the speed, and is itself
/// independent of the friction, a pure torque.
TEST(LoadFriction, OfAPinFollowsTheReaction) {
  World world;
  const MassProperties m = MassProperties::box(Vec3(1, 0.1, 0.1), 2);
  const BodyId rod = world.add_body({.mass = m, .pose = {.p = Vec3(0.5, 0, 0)}});
  const JointId pin = world.add("", Hinge::at(world, kGround, rod, Vec3::Zero(), Vec3::UnitY()));
  const AxisId axis = world.axis(pin, "angle");
  const double mu_r = 0.05, l = 0.5, inertia = m.inertia_B()(1, 1) + 2 * l * l;
  world.set_friction(axis, AxisFriction{.per_load = mu_r});
  Simulator simulator(world);
  run(simulator, 1e-3, 1200);

  // θ from the horizontal, downwards: I θ̈ = m g l cos θ − sign(θ̇) μr |F|, F = m (a − g), a by θ̇ and θ̈: a
  // fixed point in θ̈, and Runge–Kutta in time.
  double theta = 0, rate = 0;
  const auto acceleration = [&](double angle, double speed) {
    double alpha = 0;
    for (int pass = 0; pass < 60; ++pass) {
      const double along = -2 * l * speed * speed - 2 * kG * std::sin(angle),
                   across = 2 * l * alpha - 2 * kG * std::cos(angle);
      const double sign = speed > 0 ? 1 : speed < 0 ? -1 : 1;
      alpha = (2 * kG * l * std::cos(angle) - sign * mu_r * std::hypot(along, across)) / inertia;
    }
    return alpha;
  };
  const double h = 1e-4;
  for (int i = 0; i < 12000; ++i) {
    const double a1 = acceleration(theta, rate), v2 = rate + 0.5 * h * a1,
                 a2 = acceleration(theta + 0.5 * h * rate, v2), v3 = rate + 0.5 * h * a2,
                 a3 = acceleration(theta + 0.5 * h * v2, v3), v4 = rate + h * a3,
                 a4 = acceleration(theta + h * v3, v4);
    theta += h / 6 * (rate + 2 * v2 + 2 * v3 + v4);
    rate += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  // Second order, and a turning point at which the friction jumps, which costs a step's worth of h².
  EXPECT_NEAR(world.axis_value(axis), theta, 2e-5);
}

}  // namespace
}  // namespace taut::ball_axes_test
