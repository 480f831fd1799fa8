#include <gtest/gtest.h>

#include <cmath>

#include "core/joints.h"
#include "solvers/simulator.h"

// Friction of a joint that sticks lets nothing through.
namespace taut {
namespace {

TEST(Stick, of_a_hinge_does_not_creep) {
  World world;
  const BodyId arm = world.add_body(
      {.mass = MassProperties::box({1, 0.1, 0.1}, 2), .pose = {Quat::Identity(), {0.5, 0, 0}}});
  const JointId hinge = world.add("hinge", Hinge::at(world, kGround, arm, Vec3::Zero(), Vec3::UnitY()));
  const AxisId angle{hinge, 0};
  // Its weight pulls with 2 · 9.81 · 0.5 = 9.81 N·m.
  world.set_friction(angle, AxisFriction{.static_friction = 10, .dynamic_friction = 8});
  Settings settings;
  settings.report_energy = false;
  Simulator simulator(world, settings);
  for (int i = 0; i < 100000; ++i) {
    if (simulator.step(1e-3).ok()) continue;
    FAIL() << "step " << i << ": " << simulator.report().message;
  }
  EXPECT_NEAR(world.axis_value(angle), 0, 1e-12);
  EXPECT_NEAR(world.axis_rate(angle), 0, 1e-12);
  EXPECT_NEAR(simulator.axis_report(angle).force.friction, -9.81, 1e-9);  // the torque of the weight is +
  world.set_friction(angle, AxisFriction{.static_friction = 9.8, .dynamic_friction = 8});
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(simulator.step(1e-3).ok());
  EXPECT_GT(std::abs(world.axis_rate(angle)), 0.01);  // 1.8 N·m on 0.67 kg m² for 10 ms
}

/// A block that friction holds while its load is set anew before each step, as a controller does.
TEST(Stick, of_a_contact_does_not_creep_under_forces_that_are_set_in_each_step) {
  World world;
  world.add_shape(kGround, HalfSpace{});
  const BodyId block = world.add_body(
      {.mass = MassProperties::box({0.2, 0.2, 0.2}, 1), .pose = {Quat::Identity(), {0, 0, 0.1}}});
  Material material;
  material.static_friction = material.dynamic_friction = 0.5;
  world.add_shape(block, Box{{0.2, 0.2, 0.2}}, {}, material);
  const auto push = [&](double force) {
    return std::make_shared<PointForce>(block, Vec3::Zero(), Vec3(force, 0, 0));
  };
  const ForceId load = world.add_force(std::shared_ptr<const Force>(push(0)));
  Simulator simulator(world);
  for (int i = 0; i < 5000; ++i) {
    world.set_force(load, push(4.9 * std::sin(0.05 * i) * 0.9));  // 4.905 N would move it
    ASSERT_TRUE(simulator.step(1e-3).ok()) << "step " << i << ": " << simulator.report().message;
    ASSERT_EQ(simulator.report().analyses, i == 0 ? simulator.report().analyses : 0);
  }
  EXPECT_NEAR(world.pose(block).p.x(), 0, 1e-12);
  for (int i = 0; i < 20; ++i) {
    world.set_force(load, push(1));
    ASSERT_TRUE(simulator.step(1e-3).ok());
  }
  EXPECT_EQ(simulator.report().factorizations,
            0);  // the impulses of the step before are known, and serve again
  world.set_force(load, push(6));
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(simulator.step(1e-3).ok());
  EXPECT_NEAR(world.pose(block).p.x(), 0.5 * (6 - 0.5 * 9.81) * 0.25, 1e-3);
}

}  // namespace
}  // namespace taut
