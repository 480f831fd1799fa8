#include "solvers/integrators/reduced/axis_modes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "solvers/common/setting_checks.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/integrators/reduced/reduced_runs.h"

namespace taut::axis_modes_test {
namespace {

using namespace testing;

constexpr double kG = 9.81;

/// A body of 2 kg on a slider.
struct OnSlider {
  explicit OnSlider(const Vec3& axis, double rate = 0) {
    body = world.add_body({.mass = MassProperties(2, Vec3(0.1, 0.2, 0.3)),
                           .pose = {.p = axis},
                           .twist = {Vec3::Zero(), rate * axis}});
    joint = world.add("slider", Slider::at(world, kGround, body, axis, axis));
    way = world.axis(joint, "displacement");
    start = world.axis_value(way);
  }
  double moved() const { return world.axis_value(way) - start; }
  /// Limits half a metre below where it starts, and a metre above.
  void limit(double restitution) {
    world.set_limits(way, AxisLimits{.lower = start - 0.5, .upper = start + 1, .restitution = restitution});
  }

  World world;
  BodyId body;
  JointId joint;
  AxisId way;
  double start = 0;
};

/// Free fall is exact by these methods: what is left is how well impacts are located.
TEST(AxisModes, ABodyBouncesAsInClosedForm) {
  for (const Integrator integrator : kReduced) {
    OnSlider it(Vec3::UnitZ());
    it.limit(0.8);
    Simulator simulator(it.world, fine_settings(integrator));
    const double fall = std::sqrt(2 * 0.5 / kG);
    double struck = 0, time = 0, lost = 0;
    for (int i = 0; i < 100; ++i) {
      const double before = total_energy(it.world, it.world.state());
      ASSERT_TRUE(simulator.step(0.01).exact()) << simulator.report().message;
      time += 0.01;
      struck += simulator.axis_report(it.way).impact_time.has_value();
      EXPECT_LE(total_energy(it.world, it.world.state()), before + 1e-9);
      lost += simulator.report().ledger.limits;
      EXPECT_NEAR(simulator.report().ledger.limits, total_energy(it.world, it.world.state()) - before, 1e-9);
    }
    EXPECT_EQ(struck, 2);  // at 0.319 s and 0.830 s
    double v = 0.8 * kG * fall, t = time - fall;
    t -= 2 * v / kG;
    v *= 0.8;
    EXPECT_NEAR(it.moved(), -0.5 + v * t - 0.5 * kG * t * t, 2e-8);
    EXPECT_NEAR(lost, -2 * kG * 0.5 * (1 - std::pow(0.8, 4)), 1e-7);
  }
}

/// Bounces of e = 0.5 follow each other faster and faster, up to 3 times the time of the fall.
TEST(AxisModes, ABodyComesToRestOnItsLimit) {
  for (const Integrator integrator : kReduced) {
    OnSlider it(Vec3::UnitZ());
    it.limit(0.5);
    Simulator simulator(it.world, fine_settings(integrator));
    const double end = 3 * std::sqrt(2 * 0.5 / kG);  // 0.958 s
    for (int i = 0; i < 94; ++i) ASSERT_TRUE(simulator.step(0.01).exact()) << simulator.report().message;
    EXPECT_LT(0.94, end);
    EXPECT_GT(it.world.twist(it.body).v.norm(), 1e-3);
    for (int i = 0; i < 6; ++i) ASSERT_TRUE(simulator.step(0.01).exact()) << simulator.report().message;
    EXPECT_NEAR(it.moved(), -0.5, 1e-12);
    EXPECT_LE(it.world.twist(it.body).v.norm(), 1e-12);
    EXPECT_TRUE(simulator.axis_report(it.way).at_limit);
    EXPECT_NEAR(simulator.axis_report(it.way).force.limit, 2 * kG, 1e-9);
    EXPECT_NEAR(simulator.reaction(it.joint).force.norm(), 2 * kG, 1e-6);
  }
}

/// It stops after v m/τ, and stays to the last bits until what pulls is more than static friction; then
/// m ẍ = F − τ_d.
TEST(AxisModes, FrictionStopsHoldsAndLetsGoAsInClosedForm) {
  for (const Integrator integrator : kReduced) {
    OnSlider it(Vec3::UnitX(), 3.01);  // for 1.204 s
    it.world.set_friction(it.way, AxisFriction{.static_friction = 8, .dynamic_friction = 5});
    it.world.add_force(ForceCallback(
        [body = it.body](const State& state, std::span<Wrench> wrenches) {
          wrenches[body.index].force.x() += std::max(0.0, 10 * (state.time - 2));
        },
        false));
    Simulator simulator(it.world, fine_settings(integrator));
    double friction = 0;
    for (int i = 0; i < 150; ++i) {
      ASSERT_TRUE(simulator.step(0.01).exact()) << simulator.report().message;
      friction += simulator.report().ledger.friction;
      EXPECT_EQ(simulator.axis_report(it.way).stuck, i >= 120) << i;
    }
    EXPECT_NEAR(it.moved(), 3.01 * 3.01 / (2 * 2.5), 1e-8);  // v²/2a
    EXPECT_NEAR(friction, -3.01 * 3.01, 1e-7);
    const double stopped = it.moved();
    for (int i = 150; i < 275; ++i) ASSERT_TRUE(simulator.step(0.01).exact()) << simulator.report().message;
    EXPECT_NEAR(it.moved(), stopped, 1e-13);
    EXPECT_NEAR(simulator.axis_report(it.way).force.friction, -7.45, 1e-9);
    for (int i = 275; i < 300; ++i) ASSERT_TRUE(simulator.step(0.01).exact()) << simulator.report().message;
    // From 2.8 s on, s later: ẍ = (8 + 10 s − 5)/2.
    const double s = 0.2;
    EXPECT_NEAR(it.moved() - stopped, (1.5 * s * s + 10 * s * s * s / 6) / 2,
                is_midpoint(integrator) ? 1e-5 : 1e-9);
    EXPECT_NEAR(it.world.twist(it.body).v.x(), (3 * s + 5 * s * s) / 2, 1e-8);
  }
}

/// α = τ/I up to the target, which is kept then, with the force that gravity asks for.
TEST(AxisModes, AMotorSpeedsUpAndKeepsItsTarget) {
  for (const Integrator integrator : kReduced) {
    OnSlider it(Vec3::UnitZ());
    it.world.set_motor(it.way, AxisMotor{.target = 0.7, .max_force = 2 * (kG + 1)});
    Simulator simulator(it.world, fine_settings(integrator));
    double work = 0;
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(simulator.step(0.0101).exact()) << simulator.report().message;
      EXPECT_EQ(simulator.axis_report(it.way).saturated, (i + 1) * 0.0101 < 0.7) << i;
      work += simulator.report().ledger.motors;
    }
    EXPECT_NEAR(it.world.twist(it.body).v.z(), 0.7, 1e-12);
    EXPECT_NEAR(it.moved(), 0.245 + 0.7 * 0.31, 1e-8);
    EXPECT_NEAR(simulator.axis_report(it.way).force.motor, 2 * kG, 1e-8);
    EXPECT_NEAR(work, 2 * kG * it.moved() + 0.49, 1e-7);
    // Of any force: at once.
    it.world.set_motor(it.way, AxisMotor{.target = -0.2});
    ASSERT_TRUE(simulator.step(0.01).exact()) << simulator.report().message;
    EXPECT_NEAR(it.world.twist(it.body).v.z(), -0.2, 1e-12);
    EXPECT_NEAR(simulator.report().ledger.motors, -2 * kG * 0.002 + 0.04 - 0.49, 1e-9);
  }
}

MassProperties uneven_mass(double mass) { return MassProperties(mass, Vec3(mass * Vec3(0.04, 0.09, 0.11))); }

/// Four bodies on hinges of different directions, from the horizontal.
World arm() {
  World world;
  BodyId last = kGround;
  for (int k = 0; k < 4; ++k) {
    const Vec3 at(0.5 * k, 0, 0);
    const BodyId next =
        world.add_body({.name = "link" + std::to_string(k),
                        .mass = uneven_mass(1 + 0.3 * k),
                        .pose = {.q = exp_so3(Vec3(0.2 * k, 0.1, -0.1)), .p = at + Vec3(0.25, 0, 0)}});
    world.add(
        "hinge" + std::to_string(k),
        Hinge::at(world, last, next, at, (k % 2 == 0 ? Vec3(0.1, 1, 0) : Vec3(0, 0.9, 0.4)).normalized()));
    last = next;
  }
  return world;
}

AxisId angle(const World& world, int k) {
  return world.axis(world.joint("hinge" + std::to_string(k)), "angle");
}

/// Limits, friction and motors at once.
World busy_arm() {
  World world = arm();
  world.set_limits(angle(world, 1), AxisLimits{.lower = -0.4, .upper = 0.3, .restitution = 0.6});
  world.set_limits(angle(world, 3), AxisLimits{.lower = -0.3, .upper = 0.4});
  world.set_friction(angle(world, 0), AxisFriction{.static_friction = 6, .dynamic_friction = 5});
  world.set_friction(angle(world, 3), AxisFriction{.static_friction = 0.5, .dynamic_friction = 0.5});
  world.set_motor(angle(world, 2), AxisMotor{.target = 0.5, .max_force = 3});
  return world;
}

World after(World world, Integrator integrator, double time, int steps) {
  run(world, fine_settings(integrator), time, steps);
  return world;
}

/// Events do not cost the order.
TEST(AxisModes, KeepTheOrderThroughEvents) {
  const World truth = after(busy_arm(), Integrator::kRecursive, 0.6, 2400);
  EXPECT_GT(distance(truth, busy_arm()), 0.3);
  const auto order = [&](Integrator integrator, int steps) {
    const double coarse = distance(after(busy_arm(), integrator, 0.6, steps), truth),
                 fine = distance(after(busy_arm(), integrator, 0.6, 4 * steps), truth);
    EXPECT_LE(coarse, 0.01);
    return std::log2(coarse / fine) / 2;
  };
  EXPECT_GE(order(Integrator::kRecursive, 60), 3.5);
  EXPECT_GE(order(Integrator::kLagrangian, 60), 3.5);
  EXPECT_GE(order(Integrator::kRecursiveMidpoint, 60), 1.7);
  EXPECT_LE(distance(after(busy_arm(), Integrator::kRecursiveMidpoint, 0.6, 1200), truth), 1e-4);
}

/// RATTLE's laws are those of mean rates, of order 1 at kinks: another formulation, with other errors.
TEST(AxisModes, AsRattle) {
  World start = busy_arm();  // where static friction is more RATTLE lets an axis turn that this holds
  start.set_friction(angle(start, 0), AxisFriction{.static_friction = 5, .dynamic_friction = 5});
  const World truth = after(start, Integrator::kRecursive, 0.6, 600);
  const double coarse = distance(after(start, Integrator::kRattle, 0.6, 1500), truth);
  const double fine = distance(after(start, Integrator::kRattle, 0.6, 24000), truth);
  EXPECT_LE(fine, 2e-4);
  EXPECT_LE(fine, coarse / 4);
}

/// Law of each step: limits and friction take energy, what motors give is theirs, and the ledger adds up.
TEST(AxisModes, NothingGainsEnergy) {
  for (const Integrator integrator : kReduced) {
    World world = arm();
    for (int k = 0; k < 4; ++k)
      world.set_limits(angle(world, k), AxisLimits{.lower = -0.2, .upper = 0.25, .restitution = 0.3 * k});
    world.set_friction(angle(world, 2), AxisFriction{.static_friction = 0.2, .dynamic_friction = 0.1});
    Simulator simulator(world, fine_settings(integrator));
    const bool midpoint =
        integrator == Integrator::kRecursiveMidpoint || integrator == Integrator::kLagrangianMidpoint;
    int impacts = 0;
    double off = 0;
    for (int i = 0; i < 300; ++i) {
      const double before = total_energy(world, world.state());
      ASSERT_TRUE(simulator.step(0.004).exact()) << i << simulator.report().message;
      const EnergyLedger& ledger = simulator.report().ledger;
      EXPECT_LE(ledger.limits, 1e-12) << i;
      EXPECT_LE(ledger.friction, 1e-9) << i;
      const double change = total_energy(world, world.state()) - before;
      EXPECT_NEAR(change, ledger.limits + ledger.friction, midpoint ? 2e-3 : 1e-6) << i;
      off += change - ledger.limits - ledger.friction;
      for (int k = 0; k < 4; ++k) impacts += simulator.axis_report(angle(world, k)).impact_time.has_value();
      EXPECT_LE(beyond(*world.axis_properties(angle(world, 1)).limits, world.axis_value(angle(world, 1))),
                1e-9);
    }
    EXPECT_GE(impacts, 10);
    EXPECT_LE(std::abs(off), midpoint ? 1e-2 : 1e-5);
  }
}

/// The whole arm swings on its first hinge; those that friction holds do not turn by a bit of what is closed.
TEST(AxisModes, WhatFrictionHoldsStays) {
  for (const Integrator integrator : kReduced) {
    World world = arm();
    for (int k = 1; k < 4; ++k)
      world.set_friction(angle(world, k), AxisFriction{.static_friction = 500, .dynamic_friction = 400});
    double angles[4];
    for (int k = 0; k < 4; ++k) angles[k] = world.axis_value(angle(world, k));
    Simulator simulator(world, fine_settings(integrator));
    for (int i = 0; i < 400; ++i) {
      ASSERT_TRUE(simulator.step(0.005).exact()) << simulator.report().message;
      for (int k = 1; k < 4; ++k) EXPECT_NEAR(world.axis_value(angle(world, k)), angles[k], 1e-12);
    }
    EXPECT_GT(std::abs(world.axis_value(angle(world, 0)) - angles[0]), 0.3);
    EXPECT_NEAR(simulator.report().ledger.friction, 0, 1e-12);
  }
}

/// Of four hinges of a linkage with one freedom any one would do to hold it: rows that depend on each other.
TEST(AxisModes, FrictionHoldsALoop) {
  World world;
  const Vec3 y = Vec3::UnitY(), at[] = {{0, 0, 0}, {0.1, 0, 0.4}, {1.2, 0, 0.8}, {1, 0, 0}};
  BodyId bars[3];
  for (int k = 0; k < 3; ++k)
    bars[k] = world.add_body({.mass = uneven_mass(1), .pose = {.p = (at[k] + at[k + 1]) / 2}});
  const BodyId ends[][2] = {{kGround, bars[0]}, {bars[0], bars[1]}, {bars[1], bars[2]}, {bars[2], kGround}};
  for (int k = 0; k < 4; ++k) {
    const JointId hinge =
        world.add("hinge" + std::to_string(k), Hinge::at(world, ends[k][0], ends[k][1], at[k], y));
    world.set_friction(world.axis(hinge, "angle"), AxisFriction{.static_friction = 3, .dynamic_friction = 2});
  }
  const World start = world;
  Simulator simulator(world, fine_settings(Integrator::kRecursive));
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(0.01).exact()) << simulator.report().message;
  EXPECT_LE(distance(world, start), 1e-11);
  // With less it moves, and friction takes what is lost.
  for (int k = 0; k < 4; ++k)
    world.set_friction(angle(world, k), AxisFriction{.static_friction = 0.2, .dynamic_friction = 0.1});
  const double before = total_energy(world, world.state());
  double friction = 0;
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(simulator.step(0.005).exact()) << simulator.report().message;
    EXPECT_LE(simulator.report().ledger.friction, 1e-12);
    friction += simulator.report().ledger.friction;
  }
  EXPECT_GT(distance(world, start), 0.05);
  EXPECT_LT(friction, -0.05);
  EXPECT_NEAR(total_energy(world, world.state()) - before, friction, 1e-6);
}

TEST(AxisModes, GoOnFromACheckpointWithTheSameBits) {
  for (const Integrator integrator : kReduced)
    expect_checkpoints_keep_bits(busy_arm, fine_settings(integrator), 0.004, 150);
}

}  // namespace
}  // namespace taut::axis_modes_test
