#include <gtest/gtest.h>

#include <cmath>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "solvers/simulator/simulator.h"

/// Joints that break, leave and come while a simulation runs.
namespace taut::breaking_test {
namespace {

constexpr double kG = 9.81;

BodyId add_block(World& world, const Vec3& p, double mass = 2) {
  return world.add_body({.mass = MassProperties::box(Vec3(0.1, 0.1, 0.1), mass), .pose = {.p = p}});
}

/// A block on a joint that is pulled down with rate · t besides its weight.
struct RisingPull {
  static constexpr double kMass = 2, kRate = 40, kStrength = 50;
  /// When mass · g + rate · t is the strength.
  static constexpr double kBreak = (kStrength - kMass * kG) / kRate;
  World world;
  BodyId block;
  JointId joint;
  explicit RisingPull(bool with_axes) {
    block = add_block(world, Vec3::Zero(), kMass);
    joint = world.add("link", Fixed::at(world, kGround, block, Vec3(0, 0, 0.05)));
    world.set_break(joint, BreakLimits{.force = kStrength});
    world.add_force(ForceCallback(
        [b = block](const State& s, std::span<Wrench> w) { w[b.index].force.z() -= kRate * s.time; }, false));
    if (!with_axes) return;
    const BodyId other = add_block(world, Vec3(1, 0, 0));
    const JointId hinge = world.add("", Hinge::at(world, kGround, other, Vec3(1, 0, 0), Vec3::UnitY()));
    world.set_friction(world.axis(hinge, "angle"), AxisFriction{1, 1, 0});
  }
  /// z of the block at time t: free fall under weight and pull since the break.
  static double height(double t) {
    const double s = t - kBreak;
    return -(0.5 * kG + kRate * kBreak / (2 * kMass)) * s * s - kRate / kMass * s * s * s / 6;
  }
};

TEST(Breaking, AJointLeavesWithinTheStepWhenItsLoadReachesItsStrength) {
  for (bool with_axes : {false, true}) {
    RisingPull s(with_axes);
    Simulator simulator(s.world);
    const double dt = 0.01;
    int events = 0, steps = 0, broke_in = 1000;
    for (; s.world.time() < 1; ++steps) {
      const StepReport& r = simulator.step(dt);
      ASSERT_TRUE(r.exact()) << r.message;
      ASSERT_EQ(r.counts.analyses, steps == 0 || steps == broke_in + 1);
      for (const BreakEvent& event : r.breaks) {
        ++events;
        broke_in = steps;
        EXPECT_EQ(event.joint, s.joint);
        // The load is linear in time, and so are its means over sub-steps.
        EXPECT_NEAR(event.time, RisingPull::kBreak, 1e-9);
        EXPECT_GE(event.force, RisingPull::kStrength);
        EXPECT_LE(event.force, RisingPull::kStrength + RisingPull::kRate * dt);
        EXPECT_FALSE(s.world.is_attached(s.joint));
        // Half of the sub-step's impulse before the break, none after it.
        EXPECT_NEAR(simulator.mean_reaction(s.joint).force.z(),
                    RisingPull::kStrength * (RisingPull::kBreak - (r.time - dt)) / dt,
                    0.5 * RisingPull::kRate * dt);
      }
      if (s.world.time() < RisingPull::kBreak) {
        ASSERT_LE(s.world.pose(s.block).p.norm(), 1e-10);
      }
    }
    EXPECT_EQ(events, 1);
    EXPECT_NEAR(s.world.pose(s.block).p.z(), RisingPull::height(s.world.time()), dt * dt);
    EXPECT_EQ(simulator.mean_reaction(s.joint).force.norm(), 0);
    EXPECT_LE(s.world.pose(s.block).p.head<2>().norm(), 1e-12);
  }
}

/// Four rods side by side share a load equally, so that each that breaks overloads the next.
TEST(Breaking, GoesOnUntilWhatIsLeftBearsTheLoad) {
  World world;
  const BodyId block = add_block(world, Vec3::Zero(), 10);
  const double weight = 10 * kG;
  std::vector<JointId> joints;
  for (double strength : {0.2, 0.3, 0.6, 2.0}) {
    joints.push_back(world.add("", Ball::at(world, kGround, block, Vec3::Zero())));
    world.set_break(joints.back(), BreakLimits{.force = strength * weight});
  }
  Simulator simulator(world);
  ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
  const StepReport& r = simulator.report();
  ASSERT_EQ(r.breaks.size(), 2u);
  EXPECT_EQ(r.breaks[0].joint, joints[0]);
  EXPECT_NEAR(r.breaks[0].force, weight / 4, 1e-6 * weight);  // the pseudo-inverse is right to its shift
  EXPECT_EQ(r.breaks[1].joint, joints[1]);
  EXPECT_NEAR(r.breaks[1].force, weight / 3, 1e-6 * weight);
  EXPECT_EQ(r.breaks[1].time, 0);
  EXPECT_LE(r.gap.metres, 1e-9);
  for (int k : {2, 3}) EXPECT_NEAR(simulator.mean_reaction(joints[k]).force.z(), weight / 2, 1e-6 * weight);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_LE(world.pose(block).p.norm(), 1e-9);
}

TEST(Breaking, EqualJointsUnderEqualLoadsBreakTogether) {
  World world;
  const BodyId beam = world.add_body({.mass = MassProperties::box(Vec3(2, 0.1, 0.1), 8)});
  for (double x : {-1.0, 1.0}) {
    const JointId joint = world.add("", Rope(kGround, beam, Vec3(x, 0, 1), Vec3(x, 0, 0), 1));
    world.set_break(joint, BreakLimits{.force = 4 * kG * 0.99});
  }
  Simulator simulator(world);
  ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_EQ(simulator.report().breaks.size(), 2u);
  for (int i = 1; i < 200; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_NEAR(world.pose(beam).p.z(), -0.5 * kG * 0.04, 1e-10);
  EXPECT_LE(world.twist(beam).w.norm(), 1e-9);
}

TEST(Breaking, ByTorqueAboutTheAnchor) {
  World world;
  const BodyId arm =
      world.add_body({.mass = MassProperties::box(Vec3(1, 0.1, 0.1), 2), .pose = {.p = Vec3(0.5, 0, 0)}});
  const JointId root = world.add("root", Fixed::at(world, kGround, arm, Vec3::Zero()));
  world.set_break(root, BreakLimits{.torque = 2 * kG * 0.5 * 1.01});
  Simulator simulator(world);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_TRUE(world.is_attached(root));
  world.set_break(root, BreakLimits{.torque = 2 * kG * 0.5 * 0.99});
  ASSERT_TRUE(simulator.step(1e-3).exact());
  ASSERT_EQ(simulator.report().breaks.size(), 1u);
  EXPECT_NEAR(simulator.report().breaks[0].torque, 2 * kG * 0.5, 1e-8);
}

TEST(Breaking, TakesGearsAlongAndLosesTheEnergyOfItsSprings) {
  World world;
  world.set_gravity(Vec3::Zero());
  const BodyId a = add_block(world, Vec3::Zero()), b = add_block(world, Vec3(1, 0, 0));
  const JointId first = world.add("first", Hinge::at(world, kGround, a, Vec3::Zero(), Vec3::UnitZ()));
  const JointId second = world.add("second", Hinge::at(world, kGround, b, Vec3(1, 0, 0), Vec3::UnitZ()));
  const AxisId angle = world.axis(first, "angle");
  world.add("gear", Gear(world, angle, world.axis(second, "angle"), -1));
  world.set_spring(angle, AxisSpring{.stiffness = 0.1, .rest = 0.7});
  world.add_force(PointForce(a, Vec3::Zero(), Vec3(100, 0, 0)));
  world.set_break(first, BreakLimits{.force = 90});
  Simulator simulator(world);
  ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
  const StepReport& r = simulator.report();
  ASSERT_EQ(r.breaks.size(), 2u);
  EXPECT_EQ(r.breaks[1].joint, world.joint("gear"));
  EXPECT_EQ(r.breaks[1].with, first);
  EXPECT_FALSE(world.is_attached(world.joint("gear")));
  EXPECT_NEAR(r.ledger.breaking, -0.5 * 0.1 * 0.49, 1e-15);
  EXPECT_NEAR(r.ledger.start + r.ledger.total(), r.energy(), 1e-14);
  EXPECT_NEAR(world.twist(a).v.x(), 100.0 / 2 * 1e-3, 1e-12);
}

TEST(Breaking, IsRefusedWithOtherIntegrators) {
  RisingPull s(false);
  for (Integrator integrator : {Integrator::kRattle4, Integrator::kForceEuler}) {
    Simulator simulator(s.world, {.integrator = integrator});
    EXPECT_THROW(simulator.step(1e-3), std::invalid_argument);
  }
}

/// Two bodies in flight are joined, and parted again.
TEST(AttachDetach, KeepsMomentaAndBooksTheEnergy) {
  World world;
  world.set_gravity(Vec3::Zero());
  const BodyId a = add_block(world, Vec3(0, 0, 0), 2), b = add_block(world, Vec3(0.3, 0.1, 0), 3);
  world.set_twist(a, {Vec3(1, 2, 3), Vec3(0.5, 0, 0)});
  world.set_twist(b, {Vec3(-1, 0, 2), Vec3(-0.5, 0.4, 0)});
  Simulator simulator(world);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
  const Vec3 momentum = linear_momentum(world, world.state()), spin = angular_momentum(world, world.state());
  const double energy = kinetic_energy(world, world.state());
  const JointId joint = world.add("catch", Ball::at(world, a, b, Vec3(0.15, 0.05, 0)));
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(simulator.step(1e-3).exact());
    const StepReport& r = simulator.report();
    ASSERT_LE(r.gap.metres, 1e-9);
    ASSERT_NEAR(r.ledger.start + r.ledger.total(), r.energy(), 1e-13);
    if (i == 0) {
      EXPECT_EQ(r.counts.analyses, 1);
      EXPECT_LT(r.ledger.stabilisation, -0.1);  // a plastic impact
      EXPECT_NEAR(energy + r.ledger.stabilisation, r.energy(), 1e-5);
    }
  }
  EXPECT_LE((linear_momentum(world, world.state()) - momentum).norm(), 1e-12);
  EXPECT_LE((angular_momentum(world, world.state()) - spin).norm(), 1e-12);
  const Twist before = world.twist(a);
  world.detach(joint);
  ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_LE((world.twist(a).v - before.v).norm(), 1e-12);
  EXPECT_EQ(simulator.report().ledger.stabilisation, 0);
  EXPECT_LE((linear_momentum(world, world.state()) - momentum).norm(), 1e-12);
  world.attach(joint);  // at once, before the bodies have parted by more than the simulator closes
  ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
  EXPECT_LE(simulator.report().gap.metres, 1e-9);
}

/// A block that friction holds stays held, with its static bound, while joints come and go elsewhere.
TEST(AttachDetach, LeavesStickingAxesStuck) {
  World world;
  const BodyId block = add_block(world, Vec3::Zero()), other = add_block(world, Vec3(3, 0, 0));
  const double slope = 0.5, pull = 2 * kG * std::sin(slope);
  const JointId slide = world.add(
      "slide", Slider::at(world, kGround, block, Vec3::Zero(), Vec3(std::cos(slope), 0, -std::sin(slope))));
  const AxisId axis = world.axis(slide, "displacement");
  world.set_friction(axis, AxisFriction{1.01 * pull, 0.5 * pull, 0});  // would slide if it once let go
  Simulator simulator(world);
  for (int i = 0; i < 300; ++i) {
    if (i % 20 == 10) world.add("", Ball::at(world, kGround, other, world.pose(other).p));
    if (i % 20 == 0 && i > 0) world.detach({world.joint_count() - 1});
    ASSERT_TRUE(simulator.step(1e-2).exact());
  }
  EXPECT_LE(std::abs(world.axis_value(axis)), 1e-10);
}

}  // namespace
}  // namespace taut::breaking_test
