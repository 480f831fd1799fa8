#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"

// Mechanisms that friction locks whatever drives them.
namespace taut::jam_test {
namespace {

/// A press that comes down along z onto a rod at 60° to the way of a guided block along x, whose friction is
/// μ times the force of its guide, against 5 N: it moves if μ < cot 60° = 0.577.
struct Wedge {
  World world;
  JointId press, guide;
  AxisId pressed, guided;
  explicit Wedge(double mu) {
    const double a = std::numbers::pi / 3;
    const Vec3 top(0, 0, std::sin(a)), side(std::cos(a), 0, 0);
    world.set_gravity(Vec3::Zero());
    const auto block = [&](const Vec3& p) {
      return world.add_body({.mass = MassProperties::box(Vec3(0.1, 0.1, 0.1), 1), .pose = {.p = p}});
    };
    const BodyId head = block(top), foot = block(side);
    press = world.add("press", Slider::at(world, kGround, head, top, -Vec3::UnitZ()));
    guide = world.add("guide", Slider::at(world, kGround, foot, side, Vec3::UnitX()));
    world.add("rod", Distance(head, foot, Vec3::Zero(), Vec3::Zero(), 1));
    pressed = world.axis(press, "displacement");
    guided = world.axis(guide, "displacement");
    world.add_force(PointForce(foot, Vec3::Zero(), Vec3(-5, 0, 0)));
    world.set_friction(guided, AxisFriction{.per_load = mu});
  }
};

TEST(Jam, AMotorOfBoundedForceStallsWhereTheWedgeLocks) {
  for (const double mu : {0.3, 0.6, 2.0}) {
    Wedge wedge(mu);
    wedge.world.set_motor(wedge.pressed, AxisMotor{.target = 0.1, .max_force = 50});
    Simulator simulator(wedge.world);
    for (int i = 0; i < 50; ++i) {
      ASSERT_TRUE(simulator.step(1e-3).exact()) << mu << ": " << simulator.report().message;
      ASSERT_LE(simulator.report().natural_residual, 1e-9);
    }
    const bool locks = mu > 1 / std::numbers::sqrt3;
    EXPECT_EQ(simulator.axis_report(wedge.guided).stuck, locks);
    EXPECT_EQ(simulator.axis_report(wedge.pressed).saturated, locks);
    if (locks)
      EXPECT_NEAR(wedge.world.axis_value(wedge.guided), 0, 1e-12);
    else
      EXPECT_NEAR(wedge.world.axis_rate(wedge.pressed), 0.1, 1e-9);
  }
}

TEST(Jam, WhatForcesALockedWedgeIsNamedWithTheFriction) {
  for (const bool motor : {false, true}) {
    Wedge wedge(0.8);
    JointId drive;
    if (motor)
      wedge.world.set_motor(wedge.pressed, AxisMotor{.target = 0.1});
    else
      drive = wedge.world.add("drive", Driver(wedge.world, wedge.pressed, linear_motion(0, 0.1)));
    Simulator simulator(wedge.world);
    const State before = wedge.world.state();
    const StepReport& report = simulator.step(1e-3);
    ASSERT_EQ(report.status, Status::kContradiction) << report.message;
    EXPECT_EQ(report.contradiction.residual, 0);
    const Contradiction& jam = report.contradiction;
    if (motor) {
      EXPECT_EQ(jam.joints, std::vector<JointId>{wedge.guide});
      ASSERT_EQ(jam.bounds.size(), 1u);
      EXPECT_EQ(jam.bounds[0], (Contradiction::Bound{wedge.pressed, Contradiction::Bound::Kind::kMotor}));
    } else {
      EXPECT_EQ(jam.joints, (std::vector<JointId>{wedge.guide, drive}));
      EXPECT_TRUE(jam.bounds.empty());
    }
    EXPECT_NE(report.message.find("jam"), std::string::npos) << report.message;
    EXPECT_LE(report.counts.factorizations, 2000);
    EXPECT_EQ(wedge.world.pose(BodyId{1}).p, before.poses[1].p);
  }
}

TEST(Jam, AWedgeJustBelowItsLimitMovesWithTheFrictionOfItsLoad) {
  for (const double part : {0.3, 0.6, 0.9, 0.999}) {
    const double mu = part / std::numbers::sqrt3;
    Wedge wedge(mu);
    wedge.world.set_motor(wedge.pressed, AxisMotor{.target = 0.1});
    Simulator simulator(wedge.world);
    for (int i = 0; i < 10; ++i) {
      ASSERT_TRUE(simulator.step(1e-3).exact()) << part << ": " << simulator.report().message;
      ASSERT_LE(simulator.report().natural_residual, 1e-9);
      const double load = simulator.mean_reaction(wedge.guide).force.tail<2>().norm();
      EXPECT_NEAR(simulator.axis_report(wedge.guided).force.friction, -mu * load, 1e-6 * mu * load);
    }
    EXPECT_NEAR(wedge.world.axis_value(wedge.pressed), 0.1 * 0.01, 1e-4);
  }
}

/// A spindle in a thread of the ground, pushed along its axis by a carriage with a rod, against 0.1 N m.  The
/// friction of the thread is `part` of what locks it.
struct Spindle {
  World world;
  JointId thread, drive;
  AxisId angle;
  double per_load;
  explicit Spindle(double part, double pitch = 0.02) : per_load(part * pitch / (2 * std::numbers::pi)) {
    world.set_gravity(Vec3::Zero());
    const BodyId spindle = world.add_body({.mass = MassProperties::box(Vec3(0.1, 0.1, 0.3), 1)});
    const BodyId carriage =
        world.add_body({.mass = MassProperties::box(Vec3(0.1, 0.1, 0.1), 1), .pose = {.p = {0, 0, -0.3}}});
    thread = world.add("thread", Screw::at(world, kGround, spindle, Vec3::Zero(), Vec3::UnitZ(), pitch));
    const JointId way =
        world.add("way", Slider::at(world, kGround, carriage, Vec3(0, 0, -0.3), Vec3::UnitZ()));
    world.add("rod", Distance(carriage, spindle, Vec3::Zero(), Vec3::Zero(), 0.3));
    angle = world.axis(thread, "angle");
    world.set_friction(angle, AxisFriction{.per_load = per_load});
    world.add_force(BodyTorque(spindle, Vec3(0, 0, -0.1)));
    drive = world.add("drive", Driver(world, world.axis(way, "displacement"), linear_motion(0, 0.01)));
  }
};

TEST(Jam, AThreadThatLocksItselfIsNamedWithItsDriver) {
  for (const double part : {1.02, 1.5, 4.0}) {
    Spindle s(part);
    Simulator simulator(s.world);
    const StepReport& report = simulator.step(1e-3);
    ASSERT_EQ(report.status, Status::kContradiction) << part << ": " << report.message;
    EXPECT_EQ(report.contradiction.joints, (std::vector{s.thread, s.drive}));
    EXPECT_NE(report.message.find("jam"), std::string::npos) << report.message;
  }
}

TEST(Jam, AThreadJustBelowItsLimitTurns) {
  for (const double part : {0.3, 0.9, 0.999}) {
    Spindle s(part);
    Simulator simulator(s.world);
    for (int i = 0; i < 10; ++i) {
      ASSERT_TRUE(simulator.step(1e-3).exact()) << part << ": " << simulator.report().message;
      ASSERT_LE(simulator.report().natural_residual, 1e-9);
      const double load = simulator.mean_reaction(s.thread).force.norm();
      EXPECT_NEAR(simulator.axis_report(s.angle).force.friction, -s.per_load * load,
                  1e-6 * s.per_load * load);
    }
    EXPECT_NEAR(s.world.axis_value(s.angle), 0.01 * 0.01 / 0.02 * 2 * std::numbers::pi, 1e-9);
  }
}

}  // namespace
}  // namespace taut::jam_test
