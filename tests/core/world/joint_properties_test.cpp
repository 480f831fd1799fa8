#include "core/world/joint_properties.h"

#include <limits>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "tests/core/constraints/row_checker.h"
#include "tests/core/expect_invalid.h"
#include "tests/core/world_rows_checker.h"

/// Strength and elasticity of joints, and joints that leave and come back.
namespace taut::joint_properties_test {
namespace {

using testing::expect_invalid;
using testing::kA;
using testing::kB;
using testing::pair_of_bodies;
using testing::Random;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(JointProperties, ErpAndCfmAreASpringAndADamper) {
  const double k = 3000, c = 20, h = 0.004;
  const ErpCfm imitation = to_erp_cfm({1 / k, c}, h);
  EXPECT_NEAR(imitation.erp, h * k / (h * k + c), 1e-15);
  EXPECT_NEAR(imitation.cfm, 1 / (h * k + c), 1e-15);
  const ComplianceDamping back = from_erp_cfm(imitation.erp, imitation.cfm, h);
  EXPECT_NEAR(back.compliance * k, 1, 1e-14);
  EXPECT_NEAR(back.damping, c, 1e-12);
  EXPECT_EQ(from_erp_cfm(0, 0.5, h).damping, 2);  // a damper only
  EXPECT_TRUE(std::isinf(from_erp_cfm(0, 0.5, h).compliance));
}

TEST(JointProperties, RefuseWrongValues) {
  World world = pair_of_bodies();
  const JointId joint = world.add("link", Ball::at(world, kA, kB, Vec3::Zero()));
  expect_invalid([&] { world.set_break(joint, BreakLimits{.force = 0}); }, {"break force of link", "0"});
  expect_invalid([&] { world.set_break(joint, BreakLimits{.torque = kNan}); }, {"break torque of link"});
  expect_invalid([&] { world.set_break({7}, BreakLimits{}); }, {"no such joint", "7"});
  expect_invalid([&] { world.set_compliance(joint, JointCompliance{.translation = -1}); },
                 {"link translation compliance", "-1"});
  expect_invalid([&] { world.set_compliance(joint, JointCompliance{.rotation_damping = -2}); },
                 {"link rotation damping", "-2"});
  expect_invalid([&] { world.set_compliance(joint, JointCompliance{.translation = kUnlimited}); },
                 {"link translation compliance", "without damping"});
  expect_invalid([] { from_erp_cfm(1.5, 1, 1); }, {"erp", "1.5"});
  expect_invalid([] { from_erp_cfm(0.5, 0, 1); }, {"cfm", "0"});
}

/// In axes of A an open soft joint has true rates and no resultant, whatever its multipliers.
TEST(SoftJoints, RowsAreConsistentWhereOpen) {
  Random random(221);
  for (int i = 0; i < 10; ++i) {
    World world = pair_of_bodies(random.pose(), random.pose());
    const JointId joint = world.add("weld", Fixed::at(world, kA, kB, random.vector()));
    world.set_compliance(joint, JointCompliance{.translation = 1e-3, .rotation = 1e-2});
    world.set_pose(kB, testing::moved(world.pose(kB), 0.3 * random.unit(), 0.3 * random.unit()));
    testing::WorldRowsChecker(world).check(random, {.stiffness = false});
  }
}

TEST(SoftJoints, ArePotentialsAndNoGaps) {
  World world = pair_of_bodies();
  const JointId joint = world.add("weld", Fixed::at(world, kA, kB, Vec3::Zero()));
  world.set_gravity(Vec3::Zero());
  world.set_compliance(joint, JointCompliance{.translation = 1e-3, .rotation = 1e-2});
  world.set_pose(kB, {exp_so3(Vec3(0.2, 0, 0)), Vec3(0.03, 0, 0.04)});
  // φ = 2 sin(angle/2) for rotations.
  const double angle = 2 * std::sin(0.1), expected = 0.5 * 0.05 * 0.05 / 1e-3 + 0.5 * angle * angle / 1e-2;
  EXPECT_NEAR(world.potential_energy(world.state()), expected, 1e-14);
  EXPECT_TRUE(world.validate().empty());
  const Rows rows(world);
  EXPECT_EQ(rows.axis_rows().size(), 6u);
  EXPECT_FALSE(rows.is_equality(0));
  world.set_compliance(joint, JointCompliance{.rotation = 1e-2});  // translations are rigid again
  EXPECT_EQ(Rows(world).axis_rows().size(), 3u);
  EXPECT_EQ(world.validate().size(), 1u);
}

TEST(Detach, LeavesIdsNamesAndPropertiesButNoRows) {
  World world = pair_of_bodies();
  const JointId hinge = world.add("hinge", Hinge::at(world, kGround, kA, Vec3::Zero(), Vec3::UnitZ()));
  const JointId other = world.add("other", Hinge::at(world, kA, kB, Vec3(1, 0, 0), Vec3::UnitZ()));
  const AxisId angle = world.axis(hinge, "angle");
  world.set_spring(angle, AxisSpring{.stiffness = 100, .rest = 0.5});
  const JointId gear = world.add("gear", Gear(world, angle, world.axis(other, "angle"), 2));
  const double energy = world.potential_energy(world.state());
  EXPECT_EQ(Rows(world).row_count(), 12);
  EXPECT_FALSE(world.may_collide(kGround, kA));

  const int topology = world.topology_version();
  world.detach(hinge);
  EXPECT_NE(world.topology_version(), topology);
  EXPECT_FALSE(world.is_attached(hinge));
  EXPECT_FALSE(world.is_attached(gear));  // couples its axis
  EXPECT_TRUE(world.is_attached(other));
  EXPECT_EQ(Rows(world).row_count(), 5);
  EXPECT_EQ(Rows(world).joint_of(0), other);
  EXPECT_NEAR(energy - world.potential_energy(world.state()), 0.5 * 100 * 0.25, 1e-12);
  EXPECT_TRUE(world.may_collide(kGround, kA));
  EXPECT_EQ(world.joint("hinge"), hinge);
  EXPECT_EQ(world.axis_properties(angle).spring->stiffness, 100);
  expect_invalid([&] { world.attach(gear); }, {"joint gear", "detached", "hinge"});
  expect_invalid([&] { world.add("gear 2", Gear(world, angle, world.axis(other, "angle"), 3)); },
                 {"joint gear 2", "detached", "hinge"});

  world.attach(hinge);
  world.attach(gear);
  EXPECT_EQ(Rows(world).row_count(), 12);
  EXPECT_NEAR(world.potential_energy(world.state()), energy, 1e-12);
}

TEST(Detach, AllButSomeAndWhatTheseCouple) {
  World world = pair_of_bodies();
  const JointId hinge = world.add("hinge", Hinge::at(world, kGround, kA, Vec3::Zero(), Vec3::UnitZ()));
  const JointId other = world.add("other", Hinge::at(world, kA, kB, Vec3(1, 0, 0), Vec3::UnitZ()));
  const JointId third = world.add("third", Ball::at(world, kGround, kB, Vec3(1, 0, 0)));
  const JointId driver = world.add("driver", Driver(world, world.axis(hinge, "angle"), linear_motion(0, 1)));
  World both = world;
  both.detach_all_but(std::vector{driver});
  EXPECT_TRUE(both.is_attached(driver));
  EXPECT_TRUE(both.is_attached(hinge));
  EXPECT_FALSE(both.is_attached(other));
  EXPECT_FALSE(both.is_attached(third));
  EXPECT_EQ(Rows(both).row_count(), 6);
  EXPECT_TRUE(both.may_collide(kA, kB));
  world.detach_all_but(std::vector{third});
  EXPECT_EQ(world.detached_count(), 3);
  EXPECT_EQ(Rows(world).row_count(), 3);
}

}  // namespace
}  // namespace taut::joint_properties_test
