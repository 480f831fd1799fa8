#include <gtest/gtest.h>

#include <cmath>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "solvers/simulator/simulator.h"

/// Joints that give way, and limits that do.
namespace taut::joint_compliance_test {
namespace {

constexpr double kG = 9.81;

BodyId add_block(World& world, const Vec3& p, double mass = 2) {
  return world.add_body({.mass = MassProperties::box(Vec3(0.2, 0.1, 0.1), mass), .pose = {.p = p}});
}

void run(Simulator& simulator, double dt, int steps) {
  for (int i = 0; i < steps; ++i) {
    const StepReport& r = simulator.step(dt);
    ASSERT_TRUE(r.exact()) << "step " << i << ": " << r.message;
    ASSERT_LE(std::max(r.gap.metres, r.gap.radians), 1e-9);
    ASSERT_NEAR(r.ledger.start + r.ledger.total(), r.energy(), 1e-12 * (1 + std::abs(r.energy()))) << i;
  }
}

/// Sags of blocks that hang one below the other, softest and stiffest eight decades apart.
TEST(JointCompliance, CarriesLoadsByItsSagAtAnyRatioOfStiffness) {
  World world;
  const BodyId upper = add_block(world, Vec3(0, 0, -1)), lower = add_block(world, Vec3(0, 0, -2));
  const double stiff = 1e-10, soft = 1e-2;
  const JointId first = world.add("", Ball::at(world, kGround, upper, Vec3::Zero()));
  const JointId second = world.add("", Ball::at(world, upper, lower, Vec3(0, 0, -1)));
  world.set_compliance(first, JointCompliance{.translation = stiff, .translation_damping = 1e6});
  world.set_compliance(second, JointCompliance{.translation = soft, .translation_damping = 20});
  Simulator simulator(world);
  run(simulator, 1e-2, 1500);
  EXPECT_NEAR(world.pose(upper).p.z(), -1 - 4 * kG * stiff, 1e-12);
  EXPECT_NEAR(world.pose(lower).p.z(), -2 - 4 * kG * stiff - 2 * kG * soft, 1e-9);
  EXPECT_NEAR(simulator.mean_reaction(first).force.z(), 4 * kG, 1e-6);
}

/// A mass on a spring moves as the implicit midpoint rule says: cos(ω h) = (1 − x²)/(1 + x²), x = ω₀ h/2.
TEST(JointCompliance, OscillatesLikeASpringAndKeepsItsEnergyWhateverTheStep) {
  for (double k : {50.0, 5e4, 5e8}) {
    World world;
    world.set_gravity(Vec3::Zero());
    const BodyId block = add_block(world, Vec3::Zero());
    const JointId joint = world.add("", Fixed::at(world, kGround, block, Vec3::Zero()));
    world.set_compliance(joint, JointCompliance{.translation = 1 / k});
    world.set_twist(block, {Vec3::Zero(), Vec3(1, 0, 0)});
    Simulator simulator(world);
    const double dt = 1e-2, x = std::sqrt(k / 2) * dt / 2, turn = 2 * std::atan(x);
    run(simulator, dt, 1);
    const double energy = simulator.report().energy();
    EXPECT_NEAR(energy, 1, 1e-9);
    run(simulator, dt, 199);
    EXPECT_NEAR(world.twist(block).v.x(), std::cos(200 * turn), 1e-7) << k;
    EXPECT_NEAR(simulator.report().energy(), energy, 1e-9) << k;
  }
}

TEST(JointCompliance, ErpAndCfmGiveTheSagOfTheirSpring) {
  World world;
  const BodyId block = add_block(world, Vec3::Zero());
  const double dt = 5e-3, erp = 0.2, cfm = 1e-3;
  const ComplianceDamping spring = from_erp_cfm(erp, cfm, dt);
  const JointId joint = world.add("", Fixed::at(world, kGround, block, Vec3::Zero()));
  world.set_compliance(
      joint, JointCompliance{.translation = spring.compliance, .translation_damping = spring.damping});
  Simulator simulator(world);
  run(simulator, dt, 400);
  EXPECT_NEAR(world.pose(block).p.z(), -2 * kG * dt * cfm / erp, 1e-9);  // −m g/k
}

TEST(JointCompliance, KeepsMomentaOfBodiesInFlightAndDampsTheirPlay) {
  World world;
  world.set_gravity(Vec3::Zero());
  const BodyId a = add_block(world, Vec3::Zero()), b = add_block(world, Vec3(0.3, 0, 0), 3);
  world.set_twist(a, {Vec3(1, 2, 3), Vec3(0.5, 0, 0)});
  world.set_twist(b, {Vec3(-1, 0, 2), Vec3(-0.5, 0.4, 0)});
  const JointId joint = world.add("", Fixed::at(world, a, b, Vec3(0.15, 0, 0)));
  world.set_compliance(joint, JointCompliance{1e-3, 1e-1, 5, 0.1});
  const Vec3 momentum = linear_momentum(world, world.state()), spin = angular_momentum(world, world.state());
  Simulator simulator(world);
  run(simulator, 1e-3, 1);
  const double energy = simulator.report().energy();
  run(simulator, 1e-3, 499);
  EXPECT_LE((linear_momentum(world, world.state()) - momentum).norm(), 1e-11);
  EXPECT_LE((angular_momentum(world, world.state()) - spin).norm(), 1e-11);
  EXPECT_LT(simulator.report().energy(), energy - 0.5);
  EXPECT_LE((world.twist(a).w - world.twist(b).w).norm(), 0.1);  // of 2.4: they turn together in the end
}

/// A double pendulum on very stiff joints, against the ideal one.
TEST(JointCompliance, TendsToTheIdealJoint) {
  const auto tip = [](double compliance) {
    World world;
    const BodyId a = add_block(world, Vec3(0.5, 0, 0)), b = add_block(world, Vec3(1.5, 0, 0));
    const JointId first = world.add("", Hinge::at(world, kGround, a, Vec3::Zero(), Vec3::UnitY()));
    const JointId second = world.add("", Hinge::at(world, a, b, Vec3(1, 0, 0), Vec3::UnitY()));
    for (JointId joint : {first, second})
      if (compliance > 0)
        world.set_compliance(
            joint, JointCompliance{compliance, compliance, 1 / compliance * 1e-3, 1 / compliance * 1e-3});
    Simulator simulator(world);
    run(simulator, 1e-3, 500);
    return world.pose(b).p;
  };
  const Vec3 ideal = tip(0);
  EXPECT_LE((tip(1e-6) - ideal).norm(), 1e-2);
  EXPECT_LE((tip(1e-9) - ideal).norm(), 1e-5);
}

TEST(SoftLimits, CarryTheWeightByTheirSag) {
  World world;
  const BodyId block = add_block(world, Vec3::Zero());
  const JointId slide = world.add("", Slider::at(world, kGround, block, Vec3::Zero(), Vec3::UnitZ()));
  const AxisId axis = world.axis(slide, "displacement");
  world.set_limits(axis, AxisLimits{.lower = -0.5, .compliance = 1e-3, .damping = 30});
  Simulator simulator(world);
  run(simulator, 1e-3, 5000);
  EXPECT_NEAR(world.axis_value(axis), -0.5 - 2 * kG * 1e-3, 1e-9);
  EXPECT_NEAR(simulator.axis_report(axis).force.elastic_limit, 2 * kG, 1e-6);
  EXPECT_TRUE(simulator.axis_report(axis).at_limit);
}

/// Without a damper the block comes back to where it fell from.
TEST(SoftLimits, ThrowBackWithoutLoss) {
  World world;
  const BodyId block = add_block(world, Vec3::Zero());
  const JointId slide = world.add("", Slider::at(world, kGround, block, Vec3::Zero(), Vec3::UnitZ()));
  const AxisId axis = world.axis(slide, "displacement");
  const double k = 4000, fall = 0.5;
  world.set_limits(axis, AxisLimits{.lower = -fall, .compliance = 1 / k});
  Simulator simulator(world);
  double highest = -1, deepest = 0;
  for (int i = 0; i < 1000; ++i) {
    run(simulator, 1e-3, 1);
    deepest = std::min(deepest, world.axis_value(axis));
    if (i > 500) highest = std::max(highest, world.axis_value(axis));
  }
  // m g (fall + x) = ½ k x².
  const double x = (2 * kG + std::sqrt(4 * kG * kG + 4 * k * kG * fall)) / k;
  EXPECT_NEAR(deepest, -fall - x, 1e-4);
  EXPECT_NEAR(highest, 0, 2e-3);
}

}  // namespace
}  // namespace taut::joint_compliance_test
