#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/refusal.h"
#include "tests/solvers/laws/sliding_block.h"

/// Quadratic drag of an axis, −c θ̇ |θ̇|, against closed forms.
namespace taut::axis_drag_test {
namespace {

using testing::kG;
using testing::refusal;
using testing::run;
using testing::Slide;

constexpr Integrator kByRows[] = {Integrator::kRattle, Integrator::kMoreauJean};
constexpr Integrator kByState[] = {Integrator::kRecursive, Integrator::kRecursiveMidpoint,
                                   Integrator::kLagrangian, Integrator::kLagrangianMidpoint};

/// A block of 2 kg that is thrown along x with 3 m/s.
struct Thrown : Slide {
  explicit Thrown(double c) : Slide(Vec3::UnitX()) {
    world.set_property(axis, AxisDrag{.coefficient = c});
    world.set_twist(block, {Vec3::Zero(), Vec3(3, 0, 0)});
  }
  double rate() const { return world.axis_rate(axis); }
};

/// Greatest error of rate and way after `time`: v = v₀/(1 + c v₀ t/m), x = m/c ln(1 + c v₀ t/m).
double error_of(Integrator integrator, double c, double time, int steps) {
  Thrown s(c);
  Simulator simulator(s.world, {.integrator = integrator});
  for (int i = 0; i < steps; ++i)
    EXPECT_TRUE(simulator.step(time / steps).ok()) << simulator.report().message;
  const double grown = 1 + c * 3 * time / 2;
  return std::max(std::abs(s.rate() - 3 / grown),
                  std::abs(s.world.axis_value(s.axis) - 2 / c * std::log(grown)));
}

TEST(AxisDrag, SlowsASliderAsInClosedFormWithOrderTwo) {
  for (const Integrator integrator : {Integrator::kRattle, Integrator::kMoreauJean,
                                      Integrator::kRecursiveMidpoint, Integrator::kLagrangianMidpoint}) {
    const double coarse = error_of(integrator, 1.5, 1, 50), fine = error_of(integrator, 1.5, 1, 100);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.05) << static_cast<int>(integrator);
    EXPECT_LE(fine, 1e-4) << static_cast<int>(integrator);
  }
  for (const Integrator integrator : {Integrator::kRecursive, Integrator::kLagrangian})
    EXPECT_LE(error_of(integrator, 1.5, 1, 100), 1e-8) << static_cast<int>(integrator);
}

/// About an axis through its centre a box of 2 kg has the inertia m (a² + b²)/12.
TEST(AxisDrag, SlowsAHingeAsInClosedForm) {
  World world;
  const BodyId wheel = world.add_body({.mass = MassProperties::box(Vec3(0.6, 0.3, 0.1), 2)});
  const AxisId angle{world.add("axle", Hinge::at(world, kGround, wheel, Vec3::Zero(), Vec3::UnitZ())), 0};
  world.set_property(angle, AxisDrag{.coefficient = 0.01});
  world.set_twist(wheel, {Vec3(0, 0, -20), Vec3::Zero()});
  Simulator simulator(world);
  run(simulator, 1e-3, 1000);
  const double inertia = 2 * (0.36 + 0.09) / 12;
  EXPECT_NEAR(world.axis_rate(angle), -20 / (1 + 0.01 * 20 / inertia), 1e-5);
}

/// Falls at √(m g/c); what the drag takes is in the ledger's damping, and what it gives in its own column.
TEST(AxisDrag, LeavesATerminalSpeed) {
  for (const Integrator integrator : kByRows)
    for (const double c : {0.05, 5.0, 500.0}) {
      Slide s(-Vec3::UnitZ());
      s.world.set_property(s.axis, AxisDrag{.coefficient = c});
      Simulator simulator(s.world, {.integrator = integrator});
      const double weight = 2 * kG, rate = std::sqrt(weight / c), h = 1e-2;
      run(simulator, h, 6000);
      EXPECT_NEAR(s.world.axis_rate(s.axis), rate, 1e-9 * rate) << c;
      EXPECT_NEAR(simulator.report().ledger.damping, -weight * rate * h, 1e-8 * weight * rate * h) << c;
      EXPECT_NEAR(simulator.axis_report(s.axis).force.drag, -weight, 1e-8 * weight) << c;
      EXPECT_NEAR(simulator.axis_report(s.axis).power.drag, -weight * rate, 1e-8 * weight * rate) << c;
      EXPECT_NEAR(simulator.report().ledger.integration, 0, 1e-8 * weight * rate * h) << c;
    }
}

/// c h v up to 1e15 kg: the block slows down in each step, never turns, and no energy comes from nowhere.
TEST(AxisDrag, IsStableHoweverStiff) {
  for (const Integrator integrator : kByRows)
    for (const double c : {1e2, 1e5, 1e10, 1e17}) {
      Thrown s(c);
      Simulator simulator(s.world, {.integrator = integrator});
      double before = s.rate();
      for (int i = 0; i < 200; ++i) {
        run(simulator, 1e-2, 1);
        ASSERT_GE(s.rate(), -1e-9) << c << " " << i;
        ASSERT_LE(s.rate(), before * (1 + 1e-12) + 1e-9) << c << " " << i;
        before = s.rate();
      }
      EXPECT_LE(s.rate(), 1.1 * 2 / (2 * c) + 1e-12) << c;  // v → m/(c t), in steps of order 1
    }
}

/// Eight rods on hinges, whose axes push each other far from where each would go by itself.
TEST(AxisDrag, OfAChainIsMetHoweverStiff) {
  for (const Integrator integrator : kByRows)
    for (const double c : {1e-3, 1.0, 1e3, 1e5, 1e7}) {
      World world;
      BodyId last = kGround;
      for (int i = 0; i < 8; ++i) {
        const BodyId rod = world.add_body({.mass = {1, Vec3(4e-4, 2.1e-2, 2.1e-2)},
                                           .pose = {.p = Vec3(0.25 + 0.5 * i, 0, 0)},
                                           .twist = {Vec3(0, 5, 0), Vec3(0, 0, -1.25 - 2.5 * i)}});
        const JointId hinge = world.add("", Hinge::at(world, last, rod, Vec3(0.5 * i, 0, 0), Vec3::UnitY()));
        world.set_property(world.axis(hinge, "angle"), AxisDrag{.coefficient = i % 3 == 2 ? 0.01 * c : c});
        last = rod;
      }
      Simulator simulator(world, {.integrator = integrator});
      for (int i = 0; i < 30; ++i) {
        const StepReport& report = simulator.step(1e-2);
        ASSERT_TRUE(report.exact()) << c << ' ' << i << ' ' << report.message;
        ASSERT_LE(report.ledger.damping, 1e-9) << c << ' ' << i;
      }
    }
}

/// With dry friction, a spring and limits on the same axis the works of all of them close the ledger.
TEST(AxisDrag, SharesItsAxisWithOthers) {
  for (const Integrator integrator : kByRows) {
    Thrown s(0.8);
    s.world.set_friction(s.axis, AxisFriction{6, 4, 0.2});
    s.world.set_spring(s.axis, AxisSpring{.stiffness = 40, .damping = 0.3});
    s.world.set_limits(s.axis, AxisLimits{.lower = -0.2, .upper = 0.3, .restitution = 0.5});
    Simulator simulator(s.world, {.integrator = integrator});
    double taken = 0;
    for (int i = 0; i < 300; ++i) {
      run(simulator, 5e-3, 1);
      taken += simulator.axis_report(s.axis).work.drag;
    }
    EXPECT_LT(taken, -0.1);
    EXPECT_NEAR(s.rate(), 0, 1e-6);
  }
}

TEST(AxisDrag, IsNamedByWhatDoesNotTakeIt) {
  Thrown s(1);
  const std::string reason =
      refusal([&] { Simulator(s.world, {.integrator = Integrator::kRattle4}).step(1e-2); });
  EXPECT_NE(reason.find("drag"), std::string::npos) << reason;
  EXPECT_NE(refusal([&] {
              s.world.set_property(s.axis, AxisDrag{.coefficient = -1.5});
            }).find("drag coefficient of slide displacement: must be finite and not negative"),
            std::string::npos);
  s.world.set_property(s.axis, std::optional<AxisDrag>());
  EXPECT_FALSE(s.world.has_axis_properties(s.joint));
  // It was the drag.
  EXPECT_EQ(refusal([&] { Simulator(s.world, {.integrator = Integrator::kRattle4}).step(1e-2); }), "");
}

/// Reduced coordinates take it at the state.
TEST(AxisDrag, IsReportedByReducedCoordinates) {
  for (const Integrator integrator : kByState) {
    Thrown s(1.5);
    Simulator simulator(s.world, {.integrator = integrator});
    ASSERT_TRUE(simulator.step(1e-3).ok());
    EXPECT_NEAR(simulator.axis_report(s.axis).force.drag, -1.5 * 9, 0.05);
    EXPECT_NEAR(simulator.report().ledger.damping, simulator.axis_report(s.axis).work.drag, 1e-15);
  }
}

/// A rate whose square is no number ends the step with a status, and nothing has changed.
TEST(RobustAxisDrag, WhatIsNotFiniteIsAStatus) {
  Slide s(Vec3::UnitX());
  s.world.set_property(s.axis, AxisDrag{.coefficient = 1e300});
  s.world.set_twist(s.block, {Vec3::Zero(), Vec3(1e20, 0, 0)});
  Simulator simulator(s.world);
  const StepReport& report = simulator.step(1e-2);
  EXPECT_EQ(report.status, Status::kNotFinite);
  EXPECT_EQ(report.message, "the law of slider slide displacement is not finite");
  EXPECT_EQ(s.world.axis_rate(s.axis), 1e20);
}

TEST(RobustResume, ADragGoesOnBitForBit) {
  for (const Integrator integrator : kByRows) {
    const auto end = [&](bool interrupted) {
      Thrown s(0.7);
      Simulator simulator(s.world, {.integrator = integrator});
      run(simulator, 1e-2, 10);
      if (interrupted) {
        const Checkpoint kept = simulator.checkpoint();
        run(simulator, 1e-2, 5);
        simulator.restore(kept);
      }
      run(simulator, 1e-2, 10);
      return std::pair(s.rate(), simulator.axis_report(s.axis).work.drag);
    };
    EXPECT_EQ(end(false), end(true));
  }
}

}  // namespace
}  // namespace taut::axis_drag_test
