#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/joints/joints.h"
#include "tests/solvers/laws/axes/wheel.h"
#include "tests/solvers/laws/sliding_block.h"

/// Limits of axes against closed forms and laws.
namespace taut::axes_test {
namespace {

using testing::kG;
using testing::run;
using testing::Slide;

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

TEST(RobustAxisLimits, MetAtAnyRateDoNotExcludeEachOther) {
  for (const bool rattle : {true, false})
    for (const double rate : {1e10, 1e13, 1e20, 9e29})
      for (const double sign : {-1.0, 1.0}) {
        Slide s(Vec3::UnitX());
        s.world.set_gravity(Vec3::Zero());
        s.world.set_limits(s.axis, AxisLimits{.lower = -1, .upper = 1, .restitution = 0.5});
        s.world.set_twist(s.block, {Vec3::Zero(), Vec3(sign * rate, 0, 0)});
        Settings settings;
        settings.integrator = rattle ? Integrator::kRattle : Integrator::kMoreauJean;
        Simulator simulator(s.world, settings);
        for (int i = 0; i < 3; ++i) {
          const StepReport& r = simulator.step(0.01);
          EXPECT_TRUE(r.ok() || !r.message.empty()) << rate;
        }
        EXPECT_LE(std::abs(s.world.twist(s.block).v.x()), 2 * rate);
      }
}

}  // namespace
}  // namespace taut::axes_test
