#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/joints/joints.h"
#include "solvers/laws/axes/axis_law.h"
#include "tests/solvers/laws/axes/wheel.h"
#include "tests/solvers/laws/sliding_block.h"

/// Motors, friction and springs against closed forms and laws.
namespace taut::axes_test {
namespace {

using testing::kG;
using testing::run;
using testing::Slide;

Vec3 down_slope(double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  return {std::cos(a), 0, -std::sin(a)};
}

TEST(AxisFriction, HoldsUpToTheStaticForceWithoutCreep) {
  Slide s(down_slope(20));
  const double pull = 2 * kG * std::sin(20 * std::numbers::pi / 180);
  s.world.set_friction(s.axis, AxisFriction{1.001 * pull, 0.5 * pull, 0});
  Simulator simulator(s.world);
  run(simulator, 1e-2, 1000);
  EXPECT_LE(std::abs(s.world.axis_value(s.axis)), 1e-10);
  const AxisReport report = simulator.axis_report(s.axis);
  EXPECT_TRUE(report.stuck);
  EXPECT_NEAR(report.force.friction, -pull, 1e-9 * pull);
}

TEST(AxisFriction, SlidesWithTheDynamicForceOnceLoose) {
  Slide s(down_slope(30));
  const double pull = 2 * kG * 0.5;
  s.world.set_friction(s.axis, AxisFriction{0.99 * pull, 0.4 * pull, 0});
  Simulator simulator(s.world);
  run(simulator, 1e-2, 100);
  // Constant force: exact at any step.
  EXPECT_NEAR(s.world.axis_value(s.axis), 0.5 * 0.6 * pull / 2 * 1.0, 1e-9);
  EXPECT_NEAR(simulator.axis_report(s.axis).force.friction, -0.4 * pull, 1e-9 * pull);
}

TEST(AxisFriction, StopsASlidingBlockWhereCoulombSays) {
  Slide s(Vec3::UnitX());
  s.world.set_friction(s.axis, AxisFriction{6, 6, 0});
  s.world.set_twist(s.block, {Vec3::Zero(), Vec3(2, 0, 0)});
  Simulator simulator(s.world);
  run(simulator, 1e-3, 1000);  // stops after 2/3 s and 2/3 m
  EXPECT_NEAR(s.world.axis_value(s.axis), 2.0 * 2.0 / (2 * 3.0), 2e-6);
  EXPECT_LE(std::abs(s.world.axis_rate(s.axis)), 1e-12);
}

TEST(AxisMotor, SpinsUpWithItsTorqueAndHoldsItsTarget) {
  Wheel w;
  w.world.set_motor(w.axis, AxisMotor{.target = 10, .max_force = 0.6});
  Simulator simulator(w.world);
  const double t = 10 * w.inertia / 0.6;
  const int half = static_cast<int>(0.5 * t / 1e-3);
  run(simulator, 1e-3, half);
  EXPECT_TRUE(simulator.axis_report(w.axis).saturated);
  EXPECT_NEAR(w.world.axis_rate(w.axis), 0.6 / w.inertia * half * 1e-3, 1e-9);
  run(simulator, 1e-3, half + 100);
  EXPECT_FALSE(simulator.axis_report(w.axis).saturated);
  EXPECT_NEAR(w.world.axis_rate(w.axis), 10, 1e-10);
  EXPECT_NEAR(simulator.axis_report(w.axis).force.motor, 0, 1e-9);
}

TEST(AxisMotor, WithNothingToGiveIsSaturated) {
  Wheel w;
  w.world.set_motor(w.axis, AxisMotor{.target = 1, .max_force = 0});
  Simulator simulator(w.world);
  run(simulator, 1e-3, 10);
  EXPECT_TRUE(simulator.axis_report(w.axis).saturated);
  EXPECT_EQ(simulator.axis_report(w.axis).force.motor, 0);
}

/// A load of 3 N·m turns the wheel back against a motor that has only 2 N·m.
TEST(AxisMotor, IsDrivenBackWhereItsTorqueIsTooSmall) {
  Wheel w;
  w.world.set_motor(w.axis, AxisMotor{.target = 5, .max_force = 2});
  w.world.add_force(BodyTorque(w.wheel, Vec3(0, 0, -3)));
  Simulator simulator(w.world);
  run(simulator, 1e-3, 500);
  EXPECT_NEAR(w.world.axis_rate(w.axis), -1 / w.inertia * 0.5, 1e-9 / w.inertia);
  const AxisReport report = simulator.axis_report(w.axis);
  EXPECT_TRUE(report.saturated);
  EXPECT_NEAR(report.force.motor, 2, 1e-9);
  // The mean rate of the last step is half a step behind.
  EXPECT_NEAR(report.power.motor, 2 * (w.world.axis_rate(w.axis) + 0.5e-3 / w.inertia), 1e-7 / w.inertia);
  EXPECT_LT(simulator.report().ledger.motors, 0);
}

TEST(AxisMotor, FollowsItsTorqueSpeedCurve) {
  Wheel w;
  // τ = 1 − ω/20: I ω̇ = 1 − ω/20.
  w.world.set_motor(w.axis, AxisMotor{.target = 100, .force_of_speed = Curve({{0, 1}, {20, 0}})});
  Simulator simulator(w.world);
  run(simulator, 1e-3, 500);
  EXPECT_NEAR(w.world.axis_rate(w.axis), 20 * (1 - std::exp(-0.5 / (20 * w.inertia))), 2e-5);
}

TEST(AxisMotor, GoesToAPositionManyTurnsAway) {
  Wheel w;
  const double turns = 10 * std::numbers::pi;
  w.world.set_motor(w.axis, AxisMotor{.mode = AxisMotor::Mode::kPosition, .target = turns, .max_speed = 15});
  Simulator simulator(w.world);
  run(simulator, 5e-3, 500);
  EXPECT_NEAR(w.world.axis_value(w.axis), turns, 1e-9);
  EXPECT_LE(std::abs(w.world.axis_rate(w.axis)), 1e-9);
}

TEST(AxisMotor, WithATrajectoryThatIsNotFiniteIsNamed) {
  const double nan = std::nan("");
  const Motion value = [=](double t) { return MotionPoint{t < 0.105 ? 0 : nan, 0, 0}; };
  const Motion rate = [=](double t) { return MotionPoint{0, t < 0.105 ? 0 : nan, 0}; };
  for (const Motion& motion : {value, rate}) {
    for (Integrator integrator : {Integrator::kRattle, Integrator::kMoreauJean}) {
      Wheel w;
      w.world.set_motor(w.axis, AxisMotor{.mode = AxisMotor::Mode::kTrajectory, .trajectory = motion});
      Settings settings;
      settings.integrator = integrator;
      Simulator simulator(w.world, settings);
      StepReport last;
      for (int i = 0; i < 30 && last.exact(); ++i) last = simulator.step(0.01);
      EXPECT_EQ(last.status, Status::kNotFinite) << last.message;
      EXPECT_EQ(last.message, "what the motor of hinge axle angle follows is not finite");
      EXPECT_NEAR(w.world.time(), 0.1, 0.0105);  // Moreau–Jean reads it at the start of a step
    }
  }
}

TEST(AxisSpring, OscillatesAtItsFrequencyAndKeepsItsEnergy) {
  Slide s(Vec3::UnitX());
  s.world.set_spring(s.axis, AxisSpring{.stiffness = 200});  // ω = 10
  s.world.set_twist(s.block, {Vec3::Zero(), Vec3(1, 0, 0)});
  Simulator simulator(s.world);
  simulator.step(1e-3);
  const double energy = simulator.report().energy();
  run(simulator, 1e-3, 999);
  EXPECT_NEAR(s.world.axis_value(s.axis), 0.1 * std::sin(10), 1e-5);
  EXPECT_NEAR(simulator.report().energy(), energy, 1e-9);
}

TEST(AxisSpring, IsStableAtAnyStiffness) {
  for (double k : {1e4, 1e8, 1e12}) {
    Slide s(Vec3(0, 0, -1));
    s.world.set_spring(s.axis, AxisSpring{.stiffness = k, .damping = 1e-3 * k});
    Simulator simulator(s.world);
    run(simulator, 1e-2, 1000);
    EXPECT_NEAR(s.world.axis_value(s.axis), 2 * kG / k, 1e-3 * kG / k + 1e-9) << k;
  }
}

/// Three blocks one below the other on springs of 10, 1e5 and 1e9 N/m, at a step of many periods of the
/// stiffest.
TEST(AxisSpring, IsStableBesideOnesOfAnyOtherStiffness) {
  World world;
  BodyId last = kGround;
  std::vector<AxisId> axes;
  const double stiffness[] = {10, 1e5, 1e9}, damping[] = {15, 2e4, 2e8};
  for (int i = 0; i < 3; ++i) {
    const Vec3 p(0, 0, -1.0 - i);
    const BodyId block =
        world.add_body({.mass = MassProperties::box(Vec3(0.1, 0.1, 0.1), 2), .pose = {.p = p}});
    axes.push_back({world.add("", Slider::at(world, last, block, p, -Vec3::UnitZ())), 0});
    world.set_spring(axes.back(), AxisSpring{.stiffness = stiffness[i], .damping = damping[i]});
    last = block;
  }
  Simulator simulator(world);
  run(simulator, 1e-2, 2000);
  for (int i = 0; i < 3; ++i) {
    const double stretch = (3 - i) * 2 * kG / stiffness[i];
    EXPECT_NEAR(world.axis_value(axes[i]), stretch, 1e-6 * stretch + 1e-10) << i;
  }
}

/// A four-bar whose friction holds it against a torque, in a loop where the shares of its hinges are not
/// unique; each may give 1 N·m, and 5 are too many for all of them.
TEST(Axes, FrictionHoldsAClosedLoop) {
  for (const double torque : {1.5, 5.0}) {
    World world;
    world.set_gravity(Vec3::Zero());
    const Vec3 y = Vec3::UnitY(), corners[] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}};
    BodyId bodies[5];
    bodies[0] = bodies[4] = kGround;
    for (int i = 0; i < 3; ++i)
      bodies[i + 1] = world.add_body({.mass = MassProperties::box(Vec3(1, 0.1, 1), 1),
                                      .pose = {.p = 0.5 * (corners[i] + corners[i + 1])}});
    AxisId crank;
    for (int i = 0; i < 4; ++i) {
      const AxisId axis{world.add("", Hinge::at(world, bodies[i], bodies[i + 1], corners[i], y)), 0};
      world.set_friction(axis, AxisFriction{1, 0.8, 0});
      if (i == 0) crank = axis;
    }
    world.add_force(BodyTorque(bodies[1], torque * y));
    Simulator simulator(world);
    run(simulator, 5e-3, 40);
    if (torque < 4) {
      EXPECT_LE(std::abs(world.axis_value(crank)), 1e-10);
      EXPECT_TRUE(simulator.axis_report(crank).stuck);
    } else {
      EXPECT_GT(std::abs(world.axis_value(crank)), 1e-3);
    }
  }
}

/// Both hinges of a door have the same stop.
TEST(Axes, RedundantLimitsShareTheirLoad) {
  World world;
  const BodyId door =
      world.add_body({.mass = MassProperties::box(Vec3(0.8, 0.05, 2), 10), .pose = {.p = {0.4, 0, 0}}});
  world.set_gravity(Vec3::Zero());
  std::vector<AxisId> axes;
  for (const double z : {-0.8, 0.8}) {
    axes.push_back({world.add("", Hinge::at(world, kGround, door, Vec3(0, 0, z), Vec3::UnitZ())), 0});
    world.set_limits(axes.back(), AxisLimits{.upper = 0.5, .restitution = 0});
  }
  world.set_twist(door, {Vec3(0, 0, 2), Vec3(0, 0.8, 0)});
  world.add_force(BodyTorque(door, Vec3(0, 0, 3)));
  Simulator simulator(world);
  run(simulator, 5e-3, 200);
  double sum = 0;
  for (const AxisId axis : axes) {
    EXPECT_NEAR(world.axis_value(axis), 0.5, 1e-9);
    sum += simulator.axis_report(axis).force.limit;
  }
  EXPECT_NEAR(sum, -3, 1e-6);
}

TEST(Axes, MotorAgainstALimitStallsThere) {
  Wheel w;
  w.world.set_limits(w.axis, AxisLimits{.upper = 1});
  w.world.set_motor(w.axis, AxisMotor{.target = 5, .max_force = 0.3});
  w.world.set_friction(w.axis, AxisFriction{0.1, 0.1, 0});
  Simulator simulator(w.world);
  run(simulator, 5e-3, 1000);
  const AxisReport report = simulator.axis_report(w.axis);
  EXPECT_NEAR(w.world.axis_value(w.axis), 1, 1e-9);
  EXPECT_NEAR(report.force.motor, 0.3, 1e-9);
  EXPECT_NEAR(report.force.limit + report.force.friction, -0.3, 1e-9);
  EXPECT_TRUE(report.saturated);
  EXPECT_TRUE(report.at_limit);
}

/// Whatever the solver has left of the rate: what friction, the motor and the limit give is the impulse.
TEST(AxisParts, AreTheImpulseAtARateThatIsOffByATolerance) {
  AxisLaw law;
  law.friction.at = 0, law.friction.bound = 0.3;
  law.motor.at = 0.5, law.motor.bound = 2;
  law.limits.lower_at = -RowLaw::kInfinity, law.limits.upper_at = 0.8;
  struct Case {
    double lambda, w, motor = 0, friction = 0, limit = 0;
  };
  const Case cases[] = {
      {2.3, -1, 2, 0.3},    {2.1, 0, 2, 0.1},      {1.7, 0.2, 2, -0.3},
      {-0.3, 0.5, 0, -0.3}, {-2.3, 0.7, -2, -0.3}, {-9.3, 0.8, -2, -0.3, -7},
  };
  AxisProperties p;
  p.limits = AxisLimits{.upper = 3};
  for (const auto& [lambda, w, motor, friction, limit] : cases)
    for (const double off : {-1e-6, 0.0, 1e-6}) {
      const AxisImpulse shared = law.split(lambda, law.rate_of(p, lambda, w + off));
      EXPECT_NEAR(shared.friction, friction, 1e-14) << lambda << " " << off;
      EXPECT_NEAR(shared.motor, motor, 1e-14) << lambda << " " << off;
      EXPECT_NEAR(shared.limit, limit, 1e-14) << lambda << " " << off;
    }
}

/// A crate at rest beside it made the solver leave 1e-9 of the rate, and single steps report all of
/// max_force.
TEST(AxisMotor, AtItsTargetGivesNothingBesideAContact) {
  for (const Integrator integrator : {Integrator::kRattle, Integrator::kMoreauJean})
    for (const double h : {0.004, 0.001}) {
      World world;
      world.add_shape(kGround, HalfSpace{});
      const BodyId crate =
          world.add_body({.mass = MassProperties::box(Vec3(0.3, 0.3, 0.3), 5), .pose = {.p = {5, 5, 0.15}}});
      world.add_shape(crate, Box{Vec3(0.3, 0.3, 0.3)});
      const BodyId arm =
          world.add_body({.mass = MassProperties::box(Vec3(1, 0.05, 0.2), 7), .pose = {.p = {0.5, 0, 1}}});
      const AxisId axis{world.add("shaft", Hinge::at(world, kGround, arm, Vec3::UnitZ(), Vec3::UnitZ())), 0};
      world.set_motor(axis, AxisMotor{.target = 1, .max_force = 1000});
      Simulator simulator(world, {.integrator = integrator});
      for (int k = 0; k < 250; ++k) {
        const StepReport& report = simulator.step(h);
        ASSERT_TRUE(report.ok()) << report.message;
        if (k < 20) continue;
        // RATTLE to the accuracy of its rates; the flow of Moreau–Jean is of order 1.
        const bool second_order = integrator == Integrator::kRattle;
        EXPECT_LE(std::abs(simulator.axis_report(axis).force.motor), second_order ? 1e-6 : h)
            << h << " " << k;
        EXPECT_FALSE(simulator.axis_report(axis).saturated) << h << " " << k;
        EXPECT_LE(std::abs(report.ledger.integration), second_order ? 1e-8 : h * h) << h << " " << k;
      }
    }
}

/// Iterative solvers leave the rate of a motor without bound off its target: the report said an infinite
/// force, and NaN where two of them met.
TEST(RobustAxes, AMotorOfAnyForceReportsAFiniteOneByIterativeSolvers) {
  for (const Solver solver : {Solver::kGaussSeidel, Solver::kPairwise, Solver::kPropagation}) {
    World world;
    BodyId last = kGround;
    AxisId motor;
    for (int i = 0; i < 4; ++i) {
      const BodyId rod = world.add_body({.mass = MassProperties::box({1, 0.1, 0.1}, 1 + 10 * i),
                                         .pose = {Quat::Identity(), {i + 0.5, 0, 0}}});
      const JointId joint = world.add("", Hinge::at(world, last, rod, Vec3(i, 0, 0), Vec3::UnitY()));
      if (i == 1) motor = world.axis(joint, "angle");
      last = rod;
    }
    world.set_motor(motor, AxisMotor{.target = 3});
    world.set_friction(motor, AxisFriction{0.5});
    Settings settings;
    settings.solver = solver;
    settings.iterations = 3;
    Simulator simulator(world, settings);
    for (int i = 0; i < 20; ++i) {
      ASSERT_TRUE(simulator.step(0.01).ok()) << simulator.report().message;
      const AxisReport report = simulator.axis_report(motor);
      EXPECT_TRUE(std::isfinite(report.force.motor)) << i;
      EXPECT_TRUE(std::isfinite(report.work.motor)) << i;
      EXPECT_LE(std::abs(report.force.friction), 0.5 * (1 + 1e-12)) << i;
    }
  }
}

}  // namespace
}  // namespace taut::axes_test
