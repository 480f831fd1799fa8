#include "tests/solvers/integrators/moreau_jean.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/world/diagnostics.h"

/// Moreau–Jean time stepping of joints and axes against closed forms and laws, and what it refuses.
namespace taut::moreau_jean_test {
namespace {

using namespace moreau_jean_parts;
using testing::rubbing;

TEST(MoreauJean, FreeFlightIsExactAtTheMiddleAndOffByOneOrderElsewhere) {
  // q₁ = q₀ + h ((1 − θ) V₀ + θ V₁) under constant force: (θ − ½) g h t behind the parabola.
  for (const double theta : {0.5, 0.75, 1.0}) {
    World world;
    const BodyId body = world.add_body({.name = "body", .mass = MassProperties::box(Vec3(1, 2, 3), 2)});
    world.set_twist(body, {Vec3(1, 2, 0.5), Vec3(3, 0, 4)});
    const Vec3 turns = angular_momentum(world, world.state());
    Simulator simulator(world, moreau_jean(theta));
    run(simulator, 0.01, 100);
    const double height = 4 - 0.5 * kG - (theta - 0.5) * kG * 0.01;
    EXPECT_NEAR(world.pose(body).p.x(), 3, 1e-12);
    EXPECT_NEAR(world.pose(body).p.z(), height, 1e-11) << theta;
    const Vec3 about_centre =
        angular_momentum(world, world.state()) - world.pose(body).p.cross(2 * world.twist(body).v);
    EXPECT_LE((about_centre - turns).norm(), 1e-11);  // of the free body about its centre: kept exactly
  }
}

double small_swing_error(double theta, double dt) {
  // A ball of 1 m on a hinge: I = 1 + 0.004 about it; 0.2 rad, whose period is longer by θ²/16 + 11 θ⁴/3072.
  World world;
  const double amplitude = 0.2;
  const Vec3 start(std::sin(amplitude), 0, -std::cos(amplitude));
  const BodyId bob =
      world.add_body({.name = "bob", .mass = MassProperties::sphere(0.1, 1), .pose = {.p = start}});
  world.add("axle", Hinge::at(world, kGround, bob, Vec3::Zero(), Vec3::UnitY()));
  Settings settings = moreau_jean(theta);
  settings.tension = TensionPolicy::kIgnore;
  Simulator simulator(world, settings);
  const double longer = 1 + amplitude * amplitude / 16 + 11 * std::pow(amplitude, 4) / 3072;
  const double period = 2 * std::numbers::pi * std::sqrt(1.004 / kG) * longer;
  const int steps = static_cast<int>(std::lround(period / dt));
  for (int i = 0; i < steps; ++i) EXPECT_TRUE(simulator.step(period / steps).exact());
  return (world.pose(bob).p - start).norm();  // back after a period
}

TEST(MoreauJean, APendulumConvergesWithOrderOneAtLeast) {
  for (const double theta : {0.5, 1.0}) {
    const double coarse = small_swing_error(theta, 4e-3), fine = small_swing_error(theta, 2e-3),
                 finest = small_swing_error(theta, 1e-3);
    EXPECT_GT(std::log2(coarse / fine), 0.8) << theta << ": " << coarse << " " << fine;
    EXPECT_GT(std::log2(fine / finest), 0.8) << theta << ": " << fine << " " << finest;
    EXPECT_LT(finest, 5e-3) << theta;
  }
}

TEST(MoreauJean, JointsDriftWithoutACureAndAreClosedWithThePush) {
  double gaps[2];
  for (const DriftCure cure : {DriftCure::kNone, DriftCure::kPositionPush}) {
    World world;
    add_chain(world, 6, Vec3::Zero(), true, nullptr);
    Simulator simulator(world, moreau_jean(0.5, cure));
    double& gap = gaps[cure == DriftCure::kNone ? 0 : 1] = 0;
    for (int i = 0; i < 400; ++i) {
      const StepReport& report = simulator.step(2e-3);
      ASSERT_TRUE(report.exact()) << report.message;
      gap = std::max(gap, report.gap.metres);
    }
  }
  EXPECT_GT(gaps[0], 1e-6);
  EXPECT_LE(gaps[1], 1e-9);
}

/// A ball on a slider with a spring, from 0.1 m: energy after and before 10 s.
double spring_energy(double theta) {
  World world;
  world.set_gravity(Vec3::Zero());
  const BodyId ball = world.add_body({.name = "ball", .mass = MassProperties::sphere(0.1, 1)});
  const JointId joint = world.add("slide", Slider::at(world, kGround, ball, Vec3::Zero(), Vec3::UnitX()));
  const AxisId axis = world.axis(joint, "displacement");
  world.set_spring(axis, AxisSpring{.stiffness = 100, .rest = 0.1});
  Simulator simulator(world, moreau_jean(theta));
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(simulator.step(0.01).exact());
  return total_energy(world, world.state()) / (0.5 * 100 * 0.01);
}

TEST(MoreauJean, KeepsTheEnergyOfASpringWithThetaOneHalfAndTakesItWithMore) {
  EXPECT_NEAR(spring_energy(0.5), 1, 1e-9);
  EXPECT_LT(spring_energy(0.75), 0.1);
  // Implicit Euler: each step multiplies the energy by 1/(1 + (ωh)²).
  EXPECT_NEAR(spring_energy(1), std::pow(1.01, -1000), 1e-6);
}

struct Sliders {
  std::vector<BodyId> blocks;
  std::vector<AxisId> axes;
};

/// Blocks of 2 kg beside each other that slide along x.
Sliders three_sliders(World& world) {
  Sliders sliders;
  for (int i = 0; i < 3; ++i) {
    const Vec3 p(0, i, 0);
    sliders.blocks.push_back(world.add_body({.name = numbered("block", i),
                                             .mass = MassProperties::box(Vec3(0.1, 0.1, 0.1), 2),
                                             .pose = {.p = p}}));
    const JointId joint =
        world.add(numbered("slide", i), Slider::at(world, kGround, sliders.blocks[i], p, Vec3::UnitX()));
    sliders.axes.push_back(world.axis(joint, "displacement"));
  }
  return sliders;
}

TEST(MoreauJean, AxesHaveFrictionLimitsAndMotors) {
  World world;
  world.set_gravity(Vec3::Zero());
  const auto [blocks, axes] = three_sliders(world);
  world.set_friction(axes[0], AxisFriction{.static_friction = 3, .dynamic_friction = 3});
  world.set_twist(blocks[0], {Vec3::Zero(), Vec3(1.5, 0, 0)});
  world.set_limits(axes[1], AxisLimits{.lower = -1, .upper = 0.5, .restitution = 0.4});
  world.set_twist(blocks[1], {Vec3::Zero(), Vec3(2, 0, 0)});
  world.set_motor(axes[2], AxisMotor{.mode = AxisMotor::Mode::kVelocity, .target = 0.6, .max_force = 4});
  Simulator simulator(world, moreau_jean());
  run(simulator, 1e-3, 400);
  EXPECT_NEAR(world.twist(blocks[0]).v.x(), 1.5 - 3.0 / 2 * 0.4, 1e-10);
  EXPECT_NEAR(world.pose(blocks[0]).p.x(), 1.5 * 0.4 - 0.5 * 1.5 * 0.16, 1e-10);
  EXPECT_NEAR(world.twist(blocks[1]).v.x(), -0.4 * 2, 1e-10);
  EXPECT_NEAR(world.twist(blocks[2]).v.x(), 0.6, 1e-10);  // 2 m/s² reach it after 0.3 s
  EXPECT_NEAR(world.pose(blocks[2]).p.x(), 0.5 * 0.6 * 0.3 + 0.6 * 0.1, 1e-9);
  run(simulator, 1e-3, 1000);
  EXPECT_LE(world.twist(blocks[0]).v.norm(), 1e-10);
  EXPECT_NEAR(world.pose(blocks[0]).p.x(), 1.5 * 1.5 / (2 * 1.5), 2e-3);
}

TEST(MoreauJean, DampersMotorsDriversAndSoftJointsFollowTheirClosedForms) {
  World world;
  const auto [blocks, axes] = three_sliders(world);
  world.set_spring(axes[0], AxisSpring{.stiffness = 0, .damping = 5});
  world.set_twist(blocks[0], {Vec3::Zero(), Vec3(1, 0, 0)});
  world.set_motor(axes[1], AxisMotor{.mode = AxisMotor::Mode::kPosition, .target = 0.3, .max_speed = 0.5});
  const Motion motion = harmonic_motion(0, 0.2, 3);
  world.add("drive", Driver(world, axes[2], motion));
  const BodyId bob = world.add_body({.name = "bob", .mass = MassProperties::sphere(0.1, 1)});
  const JointId soft = world.add("soft", Ball::at(world, kGround, bob, Vec3::Zero()));
  world.set_compliance(soft, JointCompliance{.translation = 1e-3, .translation_damping = 30});
  const double theta = 0.75, dt = 0.01;
  Simulator simulator(world, moreau_jean(theta));
  double rate = 1;
  for (int i = 0; i < 200; ++i) {
    const StepReport& report = simulator.step(dt);
    ASSERT_TRUE(report.exact()) << report.message;
    ASSERT_LE(report.gap.metres, 1e-9);
    rate *= (1 - (1 - theta) * dt * 5 / 2) / (1 + theta * dt * 5 / 2);
    ASSERT_NEAR(world.twist(blocks[0]).v.x(), rate, 1e-11);
    ASSERT_NEAR(world.pose(blocks[2]).p.x(), motion(world.time()).value, 1e-9);
  }
  EXPECT_NEAR(world.pose(blocks[1]).p.x(), 0.3, 1e-9);
  EXPECT_NEAR(world.pose(bob).p.z(), -1e-3 * kG, 1e-9);
}

/// In space, with three different moments, the push in action and θ beside the middle.
TEST(MoreauJean, TheLedgerClosesInSpace) {
  for (const double theta : {0.5, 0.8}) {
    World world;
    const MassProperties plate = MassProperties::box(Vec3(0.6, 0.3, 0.1), 2.0);
    const BodyId free = world.add_body({.name = "free", .mass = plate});
    world.set_twist(free, {Vec3(3, -2, 4), Vec3(1, 0, 0)});
    BodyId last = kGround;
    for (int i = 0; i < 3; ++i) {
      const BodyId next = world.add_body({.mass = plate, .pose = {.p = Vec3(2 + 0.6 * i, 0.1 * i, 0)}});
      world.add("pivot " + std::to_string(i), Ball::at(world, last, next, Vec3(1.7 + 0.6 * i, 0.05, 0.02)));
      last = next;
    }
    Simulator simulator(world, moreau_jean(theta));
    for (int i = 0; i < 200; ++i) {
      const StepReport& report = simulator.step(4e-3);
      ASSERT_TRUE(report.exact()) << report.message;
      ASSERT_NEAR(report.energy() - report.ledger.start, report.ledger.total(), 1e-11) << i;
    }
  }
}

TEST(MoreauJean, WhatItCannotDoIsRefused) {
  World world;
  world.add_body({.name = "body", .mass = MassProperties::sphere(0.1, 1)});
  for (const double theta : {0.4, 1.1, std::nan("")})
    EXPECT_THROW(Simulator(world, moreau_jean(theta)), std::invalid_argument) << theta;
  EXPECT_THROW(Simulator(world, moreau_jean(0.5, DriftCure::kBaumgarte)), std::invalid_argument);
  Settings iterative = moreau_jean();
  iterative.solver = Solver::kGaussSeidel;
  EXPECT_THROW(Simulator(world, iterative), std::invalid_argument);
  Settings implicit = moreau_jean();
  implicit.tension = TensionPolicy::kImplicit;
  EXPECT_THROW(Simulator(world, implicit), std::invalid_argument);
}

TEST(MoreauJean, CompliantContactsAndBreakingJointsAreRefusedByName) {
  Material soft = rubbing(0.5);
  soft.compliance = 1e-5;
  const auto message = [](World& world) -> std::string {
    Simulator simulator(world, moreau_jean());
    try {
      for (int i = 0; i < 200; ++i) (void)simulator.step(2e-3);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  World own;
  own.add_shape(kGround, HalfSpace{}, {}, rubbing(0.5));
  add_ball(own, "ball", Vec3(0, 0, 0.2), soft);
  EXPECT_NE(message(own).find("compliance"), std::string::npos);
  EXPECT_EQ(own.time(), 0);

  World pair;  // found when they come together; the world is left where it was
  const ShapeId floor = pair.add_shape(kGround, HalfSpace{}, {}, rubbing(0.5));
  const BodyId ball = add_ball(pair, "ball", Vec3(0, 0, 0.2), rubbing(0.5));
  pair.set_contact_material(floor, ShapeId{1}, soft);
  EXPECT_NE(message(pair).find("compliant"), std::string::npos);
  EXPECT_GT(pair.time(), 0.1);
  EXPECT_GT(pair.pose(ball).p.z(), 0.09);

  World weak;
  const std::vector<BodyId> rods = add_chain(weak, 2, Vec3::Zero(), true, nullptr);
  weak.set_break(JointId{0}, BreakLimits{.force = 10});
  EXPECT_NE(message(weak).find("break"), std::string::npos);
}

}  // namespace
}  // namespace taut::moreau_jean_test
