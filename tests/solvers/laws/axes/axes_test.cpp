#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/joints/joints.h"
#include "solvers/laws/axes/axis_law.h"
#include "tests/solvers/laws/sliding_block.h"

/// Limits, motors, friction and springs against closed forms and laws.
namespace taut::axes_test {
namespace {

using testing::kG;
using testing::run;
using testing::Slide;

/// A wheel about z.
struct Wheel {
  World world;
  BodyId wheel;
  AxisId axis;
  double inertia;
  explicit Wheel(double mass = 3, double radius = 0.2) {
    const MassProperties m = MassProperties::cylinder(radius, 0.05, mass);
    wheel = world.add_body({.name = "wheel", .mass = m});
    const JointId joint = world.add("axle", Hinge::at(world, kGround, wheel, Vec3::Zero(), Vec3::UnitZ()));
    axis = world.axis(joint, "angle");
    inertia = m.inertia_B()(2, 2);
    world.set_gravity(Vec3::Zero());
  }
};

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

TEST(AxisLimits, StopAtFiveTurns) {
  Wheel w;
  w.world.set_limits(w.axis, AxisLimits{.upper = 10 * std::numbers::pi});
  w.world.set_twist(w.wheel, {Vec3(0, 0, 20), Vec3::Zero()});
  Simulator simulator(w.world);
  run(simulator, 5e-3, 400);
  EXPECT_NEAR(w.world.axis_value(w.axis), 10 * std::numbers::pi, 1e-9);
  EXPECT_LE(std::abs(w.world.axis_rate(w.axis)), 1e-9);
}

TEST(AxisLimits, ReverseTheRateByTheRestitution) {
  for (double e : {0.0, 0.5, 1.0}) {
    Slide s(Vec3::UnitX());
    s.world.set_limits(s.axis, AxisLimits{.lower = -1, .upper = 1, .restitution = e});
    s.world.set_twist(s.block, {Vec3::Zero(), Vec3(3, 0, 0)});
    Simulator simulator(s.world);
    run(simulator, 7e-3, 60);  // hits at 1/3 s
    EXPECT_NEAR(s.world.axis_rate(s.axis), -3 * e, 1e-10) << e;
    EXPECT_NEAR(s.world.axis_value(s.axis), 1 - 3 * e * (0.42 - 1. / 3), 0.0071 * 3 * (1 + e)) << e;
  }
}

/// Height at time t of a point that is dropped from h and bounces without loss.
double bouncing_height(double h, double t) {
  const double fall = std::sqrt(2 * h / kG), since = std::remainder(t, 2 * fall);
  return h - 0.5 * kG * since * since;
}

TEST(AxisLimits, BounceAtTheTimeOfImpactWhateverTheStep) {
  Slide s(Vec3::UnitZ());
  s.world.set_limits(s.axis, AxisLimits{.lower = -0.5, .restitution = 1});
  Simulator simulator(s.world);
  const double fall = std::sqrt(2 * 0.5 / kG);
  int impacts = 0;
  for (int i = 0; i < 500; ++i) {
    run(simulator, 7e-3, 1);
    if (const auto time = simulator.axis_report(s.axis).impact_time) {
      EXPECT_NEAR(*time, (2 * impacts + 1) * fall, 1e-7);
      ++impacts;
    }
    ASSERT_LE(simulator.report().substeps, 2);
    // Rates are constant but for gravity, so that nothing but the tolerance of positions is left.
    ASSERT_NEAR(s.world.axis_value(s.axis), bouncing_height(0.5, s.world.time()) - 0.5, 1e-6) << i;
  }
  EXPECT_EQ(impacts, 5);
  EXPECT_NEAR(simulator.report().energy(), 0, 1e-7);
}

/// Each bounce takes (1 − e²) of the kinetic energy, as the work of the limit, and nothing else is left over:
/// gravity works at the rates before it.
TEST(AxisLimits, ImpactsAreInTheLedger) {
  constexpr double e = 0.8, h = 0.5;
  for (const double dt : {0.02, 7e-3}) {
    Slide s(Vec3::UnitZ());
    const double energy = s.world.mass_properties(s.block).mass() * kG * h;
    s.world.set_limits(s.axis, AxisLimits{.lower = -h, .restitution = e});
    Simulator simulator(s.world);
    const double fall = std::sqrt(2 * h / kG);
    double left = energy, work = 0;
    for (double next = fall; s.world.time() < 1.5;) {
      run(simulator, dt, 1);
      const EnergyLedger& ledger = simulator.report().ledger;
      ASSERT_NEAR(ledger.unexplained(), 0, 1e-9 * energy) << s.world.time();
      ASSERT_LE(ledger.limits, 1e-12 * energy);
      work += ledger.limits;
      for (; s.world.time() > next; left *= e * e) next += 2 * fall * std::sqrt(left / energy) * e;
    }
    EXPECT_NEAR(work, left - energy, 1e-6 * energy) << dt;
    EXPECT_LT(left, 0.3 * energy);  // after three bounces
  }
}

/// Also where the sub-step that would end with the impact is too short to be taken.
TEST(AxisLimits, BounceWhereverInAStepTheyAreMet) {
  for (const Solver solver : {Solver::kDirect, Solver::kGaussSeidel})
    for (const double way : {1e-8, 1e-6, 9e-6, 0.004, 0.009995, 0.01, 0.010005, 0.0199999}) {
      Slide s(Vec3::UnitX());
      s.world.set_gravity(Vec3::Zero());
      s.world.set_limits(s.axis, AxisLimits{.lower = -way, .restitution = 0.8});
      s.world.set_twist(s.block, {Vec3::Zero(), Vec3(-1, 0, 0)});
      Settings settings;
      settings.solver = solver;
      Simulator simulator(s.world, settings);
      run(simulator, 0.01, 3);
      EXPECT_NEAR(s.world.axis_rate(s.axis), 0.8, 1e-9) << way;
    }
}

/// A wagon bounces off the carrier that it runs on; the carrier's motor or driver gives what that takes, and
/// leaves others their restitution.
TEST(AxisLimits, BounceOffWhatAMotorDrives) {
  for (const bool by_driver : {false, true}) {
    World world;
    world.set_gravity(Vec3::Zero());
    const MassProperties mass = MassProperties::box(Vec3(0.1, 0.1, 0.1), 1);
    const auto block = [&](Vec3 p, double speed) {
      const BodyId body = world.add_body({.mass = mass, .pose = {.p = p}});
      world.set_twist(body, {Vec3::Zero(), Vec3(speed, 0, 0)});
      return body;
    };
    const auto rail = [&](BodyId on, BodyId body, Vec3 p) {
      return world.axis(world.add("", Slider::at(world, on, body, p, Vec3::UnitX())), "displacement");
    };
    const BodyId carrier = block(Vec3::Zero(), 1), wagon = block(Vec3(0.105, 0, 0), 0),
                 other = block(Vec3(0, 9, 0), -0.1);
    const AxisId driven = rail(kGround, carrier, Vec3::Zero()),
                 rolls = rail(carrier, wagon, Vec3(0.105, 0, 0)),
                 beside = rail(kGround, other, Vec3(0, 9, 0));
    if (by_driver)
      world.add("drive", Driver(world, driven, linear_motion(0, 1)));
    else
      world.set_motor(driven, AxisMotor{.target = 1});
    world.set_limits(rolls, AxisLimits{.lower = -0.1005, .restitution = 0.8});
    world.set_limits(beside, AxisLimits{.lower = -0.01005, .restitution = 0.8});
    Simulator simulator(world);
    for (int i = 0; i < 12; ++i) {
      run(simulator, 0.01, 1);
      ASSERT_NEAR(simulator.report().ledger.unexplained(), 0, 1e-12);
    }
    EXPECT_NEAR(world.axis_rate(rolls), 0.8, 1e-9) << by_driver;
    EXPECT_NEAR(world.axis_rate(beside), 0.08, 1e-9) << by_driver;
  }
}

/// What strikes elsewhere leaves a limit alone that has pushed an axis back into its range.
TEST(AxisLimits, DoNotPushWhereOthersStrike) {
  for (const double beyond : {1e-6, 1e-3}) {
    World world;
    world.set_gravity(Vec3::Zero());
    std::vector<AxisId> axes;
    for (const double speed : {0.0, -1.0}) {
      const Vec3 at(0, speed, 0);
      const BodyId block =
          world.add_body({.mass = MassProperties::box(Vec3(0.1, 0.1, 0.1), 1), .pose = {.p = at}});
      world.set_twist(block, {Vec3::Zero(), Vec3(speed, 0, 0)});
      axes.push_back(
          world.axis(world.add("", Slider::at(world, kGround, block, at, Vec3::UnitX())), "displacement"));
    }
    world.set_limits(axes[0], AxisLimits{.lower = beyond});
    world.set_limits(axes[1], AxisLimits{.lower = -0.0005, .restitution = 0.5});
    Simulator simulator(world);
    for (int i = 0; i < 3; ++i) {
      run(simulator, 0.001, 1);
      ASSERT_LE(simulator.report().ledger.limits, 1e-12) << beyond;
    }
    EXPECT_NEAR(world.axis_rate(axes[0]), 0, 1e-9) << beyond;
    EXPECT_NEAR(world.axis_rate(axes[1]), 0.5, 1e-9) << beyond;
  }
}

/// A block on a rail is struck by a ball as it bounces: rounds of impacts, each with its own mean rates.
TEST(AxisLimits, AreInTheLedgerBesideContactsThatStrikeAtOnce) {
  World world;
  world.set_gravity(Vec3::Zero());
  Material smooth;
  smooth.static_friction = smooth.dynamic_friction = 0;
  smooth.restitution = 1;
  const auto ball = [&](double x, double speed) {
    const BodyId body = world.add_body({.mass = MassProperties::sphere(0.05, 1), .pose = {.p = {x, 0, 0}}});
    world.add_shape(body, Sphere{0.05}, {}, smooth);
    world.set_twist(body, {Vec3::Zero(), Vec3(speed, 0, 0)});
    return body;
  };
  const BodyId held = ball(0, -1), free = ball(0.13, -4);
  const AxisId axis = world.axis(world.add("", Slider::at(world, kGround, held, Vec3::Zero(), Vec3::UnitX())),
                                 "displacement");
  world.set_limits(axis, AxisLimits{.lower = -0.01, .restitution = 1});  // both after 0.01 s
  Simulator simulator(world);
  for (int i = 0; i < 4; ++i) {
    run(simulator, 0.007, 1);
    const StepReport& report = simulator.report();
    ASSERT_NEAR(report.kinetic_energy, 8.5, 1e-9) << i;
    ASSERT_NEAR(report.ledger.unexplained(), 0, 1e-9) << i;
    ASSERT_NEAR(report.ledger.limits, 0, 1e-9) << i;
    ASSERT_NEAR(report.ledger.contacts, 0, 1e-9) << i;
  }
  EXPECT_GT(world.twist(free).v.x(), 0);
}

/// The step is looked at once more without the limit, and with all else as it is: the mean rate of a damped
/// block is v/(1 + a), a = c h/2m, and it meets the limit where (solvers/laws, Eq. 4) has it.
TEST(AxisLimits, AreMetByTheFreeMotionOfWhatIsDamped) {
  constexpr double h = 0.01, v = 1, way = 0.004;
  for (const bool by_drag : {false, true}) {
    Slide s(Vec3::UnitX());
    s.world.set_gravity(Vec3::Zero());
    const double c = 20 * s.world.mass_properties(s.block).mass();
    s.world.set_limits(s.axis, AxisLimits{.upper = way, .restitution = 1});
    if (by_drag)
      s.world.set_property(s.axis, AxisDrag{.coefficient = c / v});
    else
      s.world.set_friction(s.axis, AxisFriction{.viscous = c});
    s.world.set_twist(s.block, {Vec3::Zero(), Vec3(v, 0, 0)});
    const double a = 20 * h / 2;  // w + a w = v; with drag w + a w²/v = v
    const double w = by_drag ? v * (std::sqrt(1 + 4 * a) - 1) / (2 * a) : v / (1 + a);
    const double p = v * h / (2 * (w - v)), q = -way * h / (w - v);  // s² + 2 p s + q = 0
    const double expected = -p - std::sqrt(p * p - q);
    Simulator simulator(s.world);
    ASSERT_TRUE(simulator.step(h).exact());
    EXPECT_NEAR(simulator.axis_report(s.axis).impact_time.value_or(0), expected, 1e-9) << by_drag;
  }
}

TEST(AxisLimits, TwoImpactsInOneStepHaveTheirOwnTimes) {
  World world;
  world.set_gravity(Vec3::Zero());
  std::vector<AxisId> axes;
  for (double start : {0.0, 0.004}) {
    const BodyId block =
        world.add_body({.mass = MassProperties::box(Vec3(0.1, 0.1, 0.1), 2), .pose = {.p = {start, 1, 0}}});
    const JointId joint = world.add("", Slider::at(world, kGround, block, Vec3(start, 1, 0), Vec3::UnitX()));
    axes.push_back(world.axis(joint, "displacement"));
    world.set_limits(axes.back(), AxisLimits{.upper = 0.5 - start, .restitution = 1});
    world.set_twist(block, {Vec3::Zero(), Vec3(1, 0, 0)});
  }
  Simulator simulator(world);
  run(simulator, 0.06, 9);  // hit at 0.496 s and 0.5 s, in the ninth step
  EXPECT_EQ(simulator.report().substeps, 3);
  EXPECT_NEAR(simulator.axis_report(axes[1]).impact_time.value_or(0), 0.496, 1e-8);
  EXPECT_NEAR(simulator.axis_report(axes[0]).impact_time.value_or(0), 0.5, 1e-8);
  EXPECT_NEAR(world.axis_value(axes[0]), 0.5 - 0.04, 1e-7);
  EXPECT_NEAR(world.axis_value(axes[1]), 0.496 - 0.044, 1e-7);
}

/// Angle after two bounces of a bar that falls against a stop.
double bounced_bar(double dt) {
  World world;
  const BodyId bar =
      world.add_body({.mass = MassProperties::box(Vec3(1, 0.05, 0.05), 1), .pose = {.p = Vec3(0.5, 0, 0)}});
  const JointId joint = world.add("pin", Hinge::at(world, kGround, bar, Vec3::Zero(), Vec3::UnitY()));
  const AxisId axis = world.axis(joint, "angle");
  world.set_limits(axis, AxisLimits{.upper = 1.2, .restitution = 0.7});
  Simulator simulator(world);
  run(simulator, dt, static_cast<int>(std::lround(1.2 / dt)));
  return world.axis_value(axis);
}

TEST(AxisLimits, ImpactsKeepTheSecondOrder) {
  const double finest = bounced_bar(1.2 / 9600);
  // The constant depends on where in a step the impacts fall; impacts at the ends of steps are 50 times off
  // at the shortest.
  for (int n : {75, 150, 300, 600, 1200})
    EXPECT_LE(std::abs(bounced_bar(1.2 / n) - finest), 7.0 / (n * n)) << n;
}

TEST(AxisLimits, AChainThatRattlesAgainstItsLimitsLosesEnergy) {
  World world;
  std::vector<AxisId> axes;
  BodyId last = kGround;
  for (int i = 0; i < 6; ++i) {
    const BodyId bar = world.add_body(
        {.mass = MassProperties::box(Vec3(0.3, 0.04, 0.04), 1), .pose = {.p = Vec3(0.15 + 0.3 * i, 0, 0)}});
    const JointId joint =
        world.add("", Hinge::at(world, last, bar, Vec3(0.3 * i, 0, 0), Vec3(0, std::cos(i), std::sin(i))));
    axes.push_back(world.axis(joint, "angle"));
    world.set_limits(axes.back(), AxisLimits{.lower = -0.2, .upper = 0.25, .restitution = 0.6});
    last = bar;
  }
  Simulator simulator(world);
  constexpr double dt = 2e-3;
  double energy = 0;
  int impacts = 0;
  for (int i = 0; i < 1000; ++i) {
    run(simulator, dt, 1);
    const EnergyLedger& ledger = simulator.report().ledger;
    // Of order 2, of the 22 J that get lost: what presses holds the axis at both ends of a step, no more.
    ASSERT_LE(ledger.limits, 10 * dt * dt) << i;
    ASSERT_LE(std::abs(ledger.unexplained()), 2.5e3 * dt * dt) << i;
    energy = simulator.report().energy();
    for (const AxisId axis : axes) {
      ASSERT_GE(world.axis_value(axis), -0.2 - 1e-9) << i;
      ASSERT_LE(world.axis_value(axis), 0.25 + 1e-9) << i;
      impacts += simulator.axis_report(axis).impact_time.has_value();
    }
  }
  EXPECT_GT(impacts, 100);
  EXPECT_LE(energy, -20);
}

TEST(AxisLimits, CarryTheWeightAtRest) {
  Slide s(Vec3(0, 0, -1));
  s.world.set_limits(s.axis, AxisLimits{.upper = 0.5, .restitution = 0.3});
  Simulator simulator(s.world);
  run(simulator, 1.0 / 240, 600);
  EXPECT_NEAR(s.world.axis_value(s.axis), 0.5, 1e-9);
  EXPECT_LE(std::abs(s.world.axis_rate(s.axis)), 1e-9);
  EXPECT_NEAR(simulator.axis_report(s.axis).force.limit, -2 * kG, 1e-8);
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
