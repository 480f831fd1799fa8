#include <gtest/gtest.h>

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

}  // namespace
}  // namespace taut
