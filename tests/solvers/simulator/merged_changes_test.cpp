// Merged bodies while the user changes the world between steps and queries.
#include <gtest/gtest.h>

#include <limits>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/simulator/merging.h"

namespace taut::merged_changes_test {
namespace {

constexpr double kG = 9.81;

using testing::merging;

/// Two boxes of 1 kg welded to each other below a ball joint.
struct Hanging {
  World world;
  BodyId upper = box(world, "upper", -0.5), lower = box(world, "lower", -1.5);
  JointId pin = world.add("pin", Ball::at(world, kGround, upper, Vec3::Zero()));
  JointId weld = world.add("weld", Fixed::at(world, upper, lower, Vec3(0, 0, -1)));

  static BodyId box(World& world, const char* name, double z) {
    return world.add_body(
        {.name = name, .mass = MassProperties::box(Vec3(0.3, 0.2, 0.1), 1.0), .pose = {.p = Vec3(0, 0, z)}});
  }
};

TEST(MergedChanges, AComplianceOfNothingChangesNothing) {
  Hanging hanging;
  Simulator simulator(hanging.world, merging());
  ASSERT_TRUE(simulator.step(0.01).exact());
  for (JointId joint : {hanging.pin, hanging.weld}) {
    hanging.world.set_compliance(joint, JointCompliance{});
    ASSERT_TRUE(simulator.step(0.01).exact());
    hanging.world.set_compliance(joint, std::nullopt);
    ASSERT_TRUE(simulator.step(0.01).exact());
  }
  EXPECT_NEAR(simulator.reaction(hanging.weld).force.z(), kG, 1e-9);
}

TEST(MergedChanges, JointsThatCameLaterMayBeAskedForAtOnce) {
  Hanging hanging;
  const BodyId third = Hanging::box(hanging.world, "third", -2.5);
  Simulator simulator(hanging.world, merging());
  ASSERT_TRUE(simulator.step(0.01).exact());
  const JointId late =
      hanging.world.add("late", Fixed::at(hanging.world, hanging.lower, third, hanging.world.pose(third).p));
  EXPECT_EQ(simulator.mean_reaction(late).force, Vec3::Zero().eval());
  EXPECT_EQ(simulator.merged_joints().size(), 2U);
  EXPECT_NEAR(simulator.reaction(hanging.pin).force.z(), 3 * kG, 1e-6);
  EXPECT_NEAR(simulator.mean_reaction(hanging.weld).force.z(), kG, 1e-6);
  EXPECT_EQ(simulator.mean_reaction(late).force, Vec3::Zero().eval());
  ASSERT_TRUE(simulator.assemble().exact());
}

TEST(MergedChanges, ReactionsAreAskedForAnewWhereAWeldLearnsToBreak) {
  Hanging hanging;
  Simulator simulator(hanging.world, merging());
  ASSERT_TRUE(simulator.step(0.01).exact());
  EXPECT_NEAR(simulator.reaction(hanging.pin).force.z(), 2 * kG, 1e-9);
  hanging.world.set_break(hanging.weld, BreakLimits{.force = 1e6});
  EXPECT_NEAR(simulator.reaction(hanging.pin).force.z(), 2 * kG, 1e-9);
  EXPECT_NEAR(simulator.reaction(hanging.weld).force.z(), kG, 1e-9);
}

/// Two bodies of 1 kg at ±1 m/s that are caught in flight lose all their energy: 1 J.
TEST(MergedChanges, AWeldBetweenMovingBodiesCostsWhatTheBooksSay) {
  for (const bool asked : {false, true}) {
    World world;
    world.set_gravity(Vec3::Zero());
    const BodyId a = Hanging::box(world, "a", 0), b = Hanging::box(world, "b", 1);
    world.set_twist(a, {Vec3::Zero(), Vec3(0, 0, 1)});
    world.set_twist(b, {Vec3::Zero(), Vec3(0, 0, -1)});
    Simulator simulator(world, merging());
    ASSERT_TRUE(simulator.step(0.01).exact());
    world.add("catch", Fixed::at(world, a, b, world.pose(a).p));
    if (asked) {
      EXPECT_EQ(simulator.merged_joints().size(), 1U);
    }
    const StepReport& report = simulator.step(0.01);
    ASSERT_TRUE(report.exact()) << report.message;
    EXPECT_NEAR(report.ledger.start, 1, 1e-12);
    EXPECT_NEAR(report.ledger.stabilisation, -1, 1e-12);
    EXPECT_NEAR(report.energy(), 0, 1e-12);
  }
}

TEST(MergedChanges, AStepThatFailsLeavesTheWorldAsItWas) {
  Hanging hanging;
  World& world = hanging.world;
  world.set_twist(hanging.lower, {Vec3(0, 1, 0), Vec3(0.3, 0, 0)});  // does not fit the weld
  bool bad = true;
  world.add_force(ForceCallback([&](const State&, std::span<Wrench> wrenches) {
    if (bad) wrenches[hanging.upper.index].force.x() = std::numeric_limits<double>::quiet_NaN();
  }));
  Simulator simulator(world, merging());
  EXPECT_EQ(simulator.step(0.01).status, Status::kNotFinite);
  EXPECT_EQ(world.twist(hanging.lower).v, Vec3(0.3, 0, 0));
  EXPECT_EQ(world.twist(hanging.upper).v, Vec3(0, 0, 0));
  bad = false;
  EXPECT_TRUE(simulator.step(0.01).exact()) << simulator.report().message;
}

}  // namespace
}  // namespace taut::merged_changes_test
