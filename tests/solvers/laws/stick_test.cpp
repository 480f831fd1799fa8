#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"

// Friction of a joint that sticks lets nothing through.
namespace taut::stick_test {
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
  for (int i = 0; i < 1000000; ++i) {
    if (simulator.step(1e-3).exact()) continue;
    FAIL() << "step " << i << ": " << simulator.report().message;
  }
  EXPECT_NEAR(world.axis_value(angle), 0, 1e-12);
  EXPECT_NEAR(world.axis_rate(angle), 0, 1e-12);
  EXPECT_NEAR(simulator.axis_report(angle).force.friction, -9.81, 1e-9);  // the torque of the weight is +
  world.set_friction(angle, AxisFriction{.static_friction = 9.8, .dynamic_friction = 8});
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
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
    ASSERT_TRUE(simulator.step(1e-3).exact()) << "step " << i << ": " << simulator.report().message;
    ASSERT_EQ(simulator.report().counts.analyses, i == 0 ? simulator.report().counts.analyses : 0);
  }
  EXPECT_NEAR(world.pose(block).p.x(), 0, 1e-12);
  for (int i = 0; i < 20; ++i) {
    world.set_force(load, push(1));
    ASSERT_TRUE(simulator.step(1e-3).exact());
  }
  EXPECT_EQ(simulator.report().counts.factorizations,
            0);  // the impulses of the step before are known, and serve again
  world.set_force(load, push(6));
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_NEAR(world.pose(block).p.x(), 0.5 * (6 - 0.5 * 9.81) * 0.25, 1e-3);
}

/// A box on four points whose load is one that they can bear: forces of the ground that are `part` of static
/// friction at each point, against a turn about a point of the plane.
double slip_under(double part, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto between = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
  };
  constexpr double kStatic = 0.5;
  const Material material{.static_friction = kStatic, .dynamic_friction = 0.4};
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, material);
  const double height = between(0.05, 0.6), width = between(0.2, 1), length = between(0.2, 1);
  const Vec3 size(length, width, height);
  const double mass = between(0.5, 10);
  const BodyId box = world.add_body(
      {.mass = MassProperties::box(size, mass), .pose = {Quat::Identity(), {0, 0, 0.5 * size.z()}}});
  world.add_shape(box, Box{size}, {}, material);
  const double pole_y = between(-1, 1), pole_x = between(-1, 1);
  const Vec3 pole(pole_x, pole_y, -0.5 * size.z());
  double share[4], sum = 0;
  for (double& s : share) sum += s = between(0.1, 1);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  for (int i = 0; i < 4; ++i) {
    const Vec3 corner = 0.5 * Vec3(i & 1 ? size.x() : -size.x(), i & 2 ? size.y() : -size.y(), -size.z());
    const double normal = share[i] / sum * mass * 9.81;
    const Vec3 along = Vec3::UnitZ().cross(corner - pole).normalized();
    const Vec3 given = normal * (Vec3::UnitZ() - part * kStatic * along);
    force += given;
    torque += corner.cross(given);
  }
  world.add_force(PointForce(box, Vec3::Zero(), Vec3(-force.x(), -force.y(), 0)));
  world.add_force(BodyTorque(box, -torque));
  const Vec3 start = world.pose(box).p;
  Simulator simulator(world);
  double energy = 0;
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(simulator.step(1e-3).exact()) << seed << ": " << simulator.report().message;
    energy = std::max(energy, simulator.report().kinetic_energy);
  }
  if (part < 1) {
    EXPECT_LT(energy, 1e-15) << seed;
  }
  return (world.pose(box).p - start).norm() + world.pose(box).q.angularDistance(Quat::Identity());
}

/// How four points share a load is not determined: they hold if any division of it does.
TEST(Stick, of_four_points_holds_whatever_they_can_bear_together) {
  for (unsigned seed = 1; seed <= 40; ++seed) EXPECT_LT(slip_under(0.98, seed), 1e-9) << seed;
  // Beyond by more than another division could bring.
  for (unsigned seed = 1; seed <= 10; ++seed) EXPECT_GT(slip_under(1.3, seed), 1e-5) << seed;
}

/// One box of two slips, and the other, which its points can hold, does not follow.
TEST(Stick, of_one_body_outlasts_the_slip_of_another) {
  const Material material{.static_friction = 0.5, .dynamic_friction = 0.4};
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, material);
  std::vector<BodyId> boxes;
  for (const double part : {0.98, 1.05}) {
    boxes.push_back(world.add_body({.mass = MassProperties::box({0.5, 0.5, 0.2}, 5),
                                    .pose = {Quat::Identity(), {0, 3 * part * 10, 0.1}}}));
    world.add_shape(boxes.back(), Box{{0.5, 0.5, 0.2}}, {}, material);
    const double push = part * 0.5 * 5 * 9.81;
    world.add_force(
        PointForce(boxes.back(), Vec3::Zero(), {push * std::cos(0.4363), push * std::sin(0.4363), 0}));
  }
  const Vec3 held = world.pose(boxes[0]).p, slid = world.pose(boxes[1]).p;
  Simulator simulator(world);
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_LT((world.pose(boxes[0]).p - held).norm(), 1e-9);
  const double acceleration = 9.81 * (1.05 * 0.5 - 0.4);
  EXPECT_NEAR((world.pose(boxes[1]).p - slid).norm(), 0.5 * acceleration * 0.04, 1e-5);
}

/// Block on a slope at 98 % of the friction angle's tangent: what moves it along the slope is round-off. Gaps
/// of its corners, and its turn with them, are left alone within the tolerance of positions.
TEST(Stick, of_a_block_on_a_slope_does_not_creep) {
  constexpr double kFriction = 0.5;
  const Material material{.static_friction = kFriction, .dynamic_friction = kFriction};
  const Quat slope = exp_so3(Vec3(0, std::atan(0.98 * kFriction), 0));
  World world;
  world.add_shape(kGround, HalfSpace{}, {slope, Vec3::Zero()}, material);
  const BodyId block = world.add_body(
      {.mass = MassProperties::box({0.4, 0.3, 0.2}, 5), .pose = {slope, slope * Vec3(0, 0, 0.1)}});
  world.add_shape(block, Box{{0.4, 0.3, 0.2}}, {}, material);
  const Vec3 start = world.pose(block).p;
  Simulator simulator(world);
  for (int i = 0; i < 5000; ++i) ASSERT_TRUE(simulator.step(1e-3).exact()) << i;
  const Vec3 moved = slope.conjugate() * (world.pose(block).p - start);
  EXPECT_LT(moved.head<2>().norm(), 1e-12);
  EXPECT_LT(std::abs(moved.z()), Settings().position_tolerance);
  EXPECT_LT(world.pose(block).q.angularDistance(slope), Settings().position_tolerance);
}

/// Turn of a cylinder in a groove of two planes at 45° under a torque, as a part of what friction on both
/// bears: with both normal forces N and μ N across them, Σ N = √2 W/(1 + μ²), so that is μ R √2 W/(1 + μ²).
/// It cannot roll on one plane without slipping on the other.
double turn_in_groove(double part, double time) {
  constexpr double kFriction = 0.4, kRadius = 0.1, kWeight = 9.81 * 10;
  const Material material{.static_friction = kFriction, .dynamic_friction = kFriction};
  World world;
  for (const double side : {-1.0, 1.0})
    world.add_shape(kGround, HalfSpace{}, {exp_so3(Vec3(0, side * std::numbers::pi / 4, 0)), Vec3::Zero()},
                    material);
  const Quat along = exp_so3(Vec3(std::numbers::pi / 2, 0, 0));
  const BodyId roller = world.add_body({.mass = MassProperties::cylinder(kRadius, 0.3, 10),
                                        .pose = {along, {0, 0, std::numbers::sqrt2 * kRadius}}});
  world.add_shape(roller, Cylinder{kRadius, 0.3}, {}, material);
  const double most = kFriction * kRadius * std::numbers::sqrt2 * kWeight / (1 + kFriction * kFriction);
  world.add_force(BodyTorque(roller, Vec3(0, part * most, 0)));
  const Vec3 start = world.pose(roller).p;
  Simulator simulator(world);
  while (world.time() < time) {
    EXPECT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
    if (::testing::Test::HasFailure()) break;
  }
  EXPECT_LT((world.pose(roller).p - start).norm(), 1e-9);
  return world.pose(roller).q.angularDistance(along);
}

TEST(Stick, of_a_cylinder_in_a_groove_holds_its_torque_without_creep) {
  EXPECT_LT(turn_in_groove(0.98, 3), 1e-9);
  // Beyond it: 5 % of μ R √2 W/(1 + μ²) on ½ m R².
  const double torque = 0.05 * 0.4 * 0.1 * std::numbers::sqrt2 * 98.1 / 1.16;
  EXPECT_NEAR(turn_in_groove(1.05, 0.1), 0.5 * torque / (0.5 * 10 * 0.01) * 0.01, 1e-6);
}

}  // namespace
}  // namespace taut::stick_test
