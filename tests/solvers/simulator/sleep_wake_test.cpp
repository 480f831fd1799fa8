#include <gtest/gtest.h>

#include <cmath>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "tests/solvers/simulator/sleeping.h"

// What bodies wake for, and what is known of contacts and friction over sleep, waking and what is set between
// steps.
namespace taut::sleep_wake_test {
namespace {

using testing::add_box;
using testing::advance;
using testing::kStep;
using testing::sleeping;
using testing::with_floor;

Material compliant(double compliance) {
  Material material;
  material.compliance = compliance;
  return material;
}

/// Air resistance, so that a body on springs comes to rest.
void add_drag(World& world, BodyId body) {
  world.add_force(ForceCallback([body](const State& state, std::span<Wrench> wrenches) {
    wrenches[body.index].force -= 50 * state.twists[body.index].v;
    wrenches[body.index].torque -= state.twists[body.index].w;
  }));
}

std::shared_ptr<const Force> push(BodyId body, const Vec3& force) {
  return std::make_shared<PointForce>(body, Vec3::Zero(), force);
}

TEST(SleepWake, a_support_that_is_moved_in_the_step_before_sleep) {
  World world;
  const BodyId platform = world.add_body({.pose = {Quat::Identity(), {0, 0, -0.5}}, .fixed = true});
  world.add_shape(platform, Box{{1, 1, 1}});
  const BodyId box = add_box(world, {0, 0, 0.1});
  int last_awake = 0;
  {
    World trial = world;
    Simulator simulator(trial, sleeping());
    for (; trial.asleep_count() == 0; ++last_awake) ASSERT_TRUE(simulator.step(kStep).exact());
  }
  Simulator simulator(world, sleeping());
  advance(simulator, last_awake - 1);
  ASSERT_EQ(world.asleep_count(), 0);
  State state = world.state();
  state.poses[platform.index].p.z() -= 3;
  world.set_state(state);
  advance(simulator, 120);
  EXPECT_NEAR(world.pose(box).p.z(), 0.1 - 0.5 * 9.81 * 0.25, 1e-6);
}

TEST(SleepWake, shapes_of_another_world_that_is_appended) {
  World world = with_floor();
  const BodyId box = add_box(world, {0, 0, 0.1});
  Simulator simulator(world, sleeping());
  advance(simulator, 240);
  ASSERT_TRUE(world.is_asleep(box));
  World other;
  other.add_shape(kGround, Box{{1, 1, 0.1}}, {Quat::Identity(), {0, 0, 0.02}});  // its top is at 0.07
  world.append(other, "other/");
  advance(simulator, 240);
  EXPECT_NEAR(world.pose(box).p.z(), 0.17, 1e-3);
}

TEST(SleepWake, a_sleeper_whose_simulator_is_gone) {
  World world = with_floor();
  const BodyId lower = add_box(world, {0, 0, 0.1}), upper = add_box(world, {0, 0, 0.3});
  Simulator other(world, sleeping(false));
  advance(other, 1);
  {
    Simulator simulator(world, sleeping());
    advance(simulator, 300);
    ASSERT_EQ(world.asleep_count(), 2);
  }
  world.set_pose(lower, {Quat::Identity(), {5, 0, 0.1}});
  advance(other, 240);
  EXPECT_NEAR(world.pose(upper).p.z(), 0.1, 1e-3);
}

/// It dwells 2 mm off a sleeping box, then goes on at 1 m/s in the middle of a step: against a wall that
/// could not be done.
TEST(SleepWake, what_a_driver_pushes_without_warning) {
  World world = with_floor();
  const BodyId box = add_box(world, {0.5, 0, 0.1});
  const BodyId pusher = world.add_body(
      {.mass = MassProperties::box({0.2, 0.2, 0.1}, 1), .pose = {Quat::Identity(), {0.2, 0, 0.15}}});
  world.add_shape(pusher, Box{{0.2, 0.2, 0.1}});
  const JointId slider = world.add("", Slider::at(world, kGround, pusher, {0, 0, 0.15}, Vec3::UnitX()));
  world.add("", Driver(world, {slider, 0}, [](double t) {
              if (t < 1) return MotionPoint{};
              if (t < 2) return MotionPoint{0.098 * (t - 1), 0.098};
              return t < 3.001 ? MotionPoint{0.098} : MotionPoint{0.098 + (t - 3.001), 1};
            }));
  Simulator simulator(world, sleeping());
  advance(simulator, 696);
  EXPECT_TRUE(world.is_asleep(box));
  EXPECT_FALSE(world.is_asleep(pusher));  // a driver that may go on
  advance(simulator, 64);
  EXPECT_NEAR(world.pose(box).p.x(), world.pose(pusher).p.x() + 0.2, 1e-2);
  EXPECT_GT(world.pose(box).p.x(), 0.55);
}

/// A force that jumps throws a slider over 8 mm within one step: the touch is found afterwards, and the step
/// taken again, with the contact that it found: the slider comes no deeper than where nobody sleeps.  It has
/// no friction, with which an impact between two boxes that it wedges has more than one solution.
TEST(SleepWake, what_is_touched_unforeseen) {
  const auto run = [](bool sleep, double& apart) {
    World world = with_floor();
    const BodyId box = add_box(world, {0.5, 0, 0.1});
    add_box(world, {0.5, 0, 0.3});
    const BodyId slider = world.add_body(
        {.mass = MassProperties::box({0.2, 0.2, 0.1}, 1), .pose = {Quat::Identity(), {0.292, 0, 0.08}}});
    world.add_shape(slider, Box{{0.2, 0.2, 0.1}}, {}, {.static_friction = 0, .dynamic_friction = 0});
    world.add("", Slider::at(world, kGround, slider, {0, 0, 0.08}, Vec3::UnitX()));
    const BodyId wheel = world.add_body(
        {.mass = MassProperties::sphere(0.05, 0.01), .pose = {Quat::Identity(), {0.292, 0, 0.08}}});
    const JointId axle = world.add("", Hinge::at(world, slider, wheel, {0.292, 0, 0.08}, Vec3::UnitX()));
    world.set_motor({axle, 0}, AxisMotor{.target = 1, .max_force = 1});  // keeps the slider awake
    world.add_force(ForceCallback(
        [slider](const State& state, std::span<Wrench> wrenches) {
          if (state.time > 2.002 && state.time < 2.016) wrenches[slider.index].force.x() += 1200;
        },
        false));
    Simulator simulator(world, sleeping(sleep));
    double sum = 0;
    const double start = world.potential_energy(world.state()) + kinetic_energy(world, world.state());
    for (int i = 0; i < 490; ++i) {
      EXPECT_TRUE(simulator.step(kStep).exact()) << simulator.report().message;
      if (i == 470) {
        EXPECT_EQ(world.asleep_count(), sleep ? 2 : 0);
      }
      apart = std::min(apart, world.pose(box).p.x() - world.pose(slider).p.x() - 0.2);
      sum += simulator.report().ledger.total();
    }
    EXPECT_NEAR(simulator.report().energy() - start, sum, 1e-9);
    return world.twist(box).v.x();
  };
  double apart = 0, apart_awake = 0;
  const double awake = run(false, apart_awake), asleep = run(true, apart);
  // 1200 N for three steps on 3 kg.
  EXPECT_NEAR(awake, asleep, 0.05 * awake);
  EXPECT_GT(apart, apart_awake - 1e-6);
}

TEST(SleepWake, reactions_of_an_island_that_is_being_woken) {
  World world;
  BodyId last = kGround, first;
  std::vector<JointId> joints;
  for (int i = 0; i < 3; ++i) {
    const BodyId rod = world.add_body({.mass = MassProperties::box({0.1, 0.1, 0.5}, 1),
                                       .pose = {Quat::Identity(), {0, 0, -0.25 - 0.5 * i}}});
    joints.push_back(world.add("", Hinge::at(world, last, rod, {0, 0, -0.5 * i}, Vec3::UnitY())));
    if (i == 0) first = rod;
    last = rod;
  }
  Simulator simulator(world, sleeping());
  advance(simulator, 240);
  ASSERT_EQ(world.asleep_count(), 3);
  world.add_force(PointForce(first, Vec3::Zero(), {0, 0, -10}));
  EXPECT_NEAR(simulator.reaction(joints[0]).force.z(), 3 * 9.81 + 10, 1e-8);
}

TEST(SleepWake, joints_that_cannot_be_closed_at_the_start) {
  World world;
  const BodyId bar = world.add_body({.mass = MassProperties::box({1, 0.1, 0.1}, 1)});
  world.add("", Ball::at(world, kGround, bar, Vec3::Zero()));
  world.set_pose(bar, {Quat::Identity(), {5, 0, 0}});
  world.add("", Ball::at(world, kGround, bar, {6, 0, 0}));
  Simulator simulator(world, sleeping());
  for (int i = 0; i < 3; ++i) EXPECT_EQ(simulator.step(kStep).status, Status::kContradiction);
}

TEST(SleepWake, a_step_that_fails_puts_nobody_to_sleep) {
  World world = with_floor();
  const BodyId box = add_box(world, {0, 0, 0.1}), other = add_box(world, {9, 0, 9});
  bool bad = false;
  world.add_force(ForceCallback(
      [&bad, other](const State&, std::span<Wrench> wrenches) {
        if (bad) wrenches[other.index].force.x() += std::numeric_limits<double>::quiet_NaN();
      },
      false));
  Simulator simulator(world, sleeping());
  advance(simulator, 120);
  ASSERT_EQ(world.asleep_count(), 0);
  const Twist before = world.twist(box);
  bad = true;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(simulator.step(kStep).status, Status::kNotFinite);
    EXPECT_EQ(simulator.report().asleep, world.asleep_count());
    EXPECT_EQ(world.asleep_count(), 0);
    EXPECT_EQ(world.twist(box).v, before.v);
  }
  bad = false;
  advance(simulator, 130);
  EXPECT_TRUE(world.is_asleep(box));
}

/// A block on compliant ground is held by friction at an elastic deflection, C F / points: forgotten, it
/// would slide by it once more.
double deflection(double compliance, double force) { return compliance * force / 4; }

TEST(Memory, of_contacts_over_forces_that_are_set_in_each_step) {
  for (const bool merge : {false, true})
    for (const double spin : {0.1, 900.0}) {  // of a top beside it, which asks for sub-steps
      World world = with_floor();
      const BodyId block = add_box(world, {0, 0, 0.1}, compliant(1e-5));
      add_drag(world, block);
      if (merge) {
        const BodyId lid = world.add_body({.mass = MassProperties::box({0.1, 0.1, 0.1}, 0.3),
                                           .pose = {exp_so3(Vec3(0, 0, 0.3)), {0.01, 0.02, 0.26}}});
        world.add("", Fixed::at(world, block, lid, {0, 0, 0.2}));
      }
      const BodyId top = world.add_body({.mass = MassProperties::box({0.1, 0.2, 0.3}, 1),
                                         .pose = {Quat::Identity(), {5, 0, 5}},
                                         .twist = {{0, 0, spin}, Vec3::Zero()}});
      world.add("", Ball::at(world, kGround, top, {5, 0, 5}));
      const ForceId load = world.add_force(push(block, {3, 0, 0}));
      Settings settings;
      settings.merge_fixed_joints = merge;
      Simulator simulator(world, settings);
      for (int i = 0; i < 2000; ++i) {
        world.set_force(load, push(block, {3, 0, 0}));
        ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
      }
      EXPECT_EQ(simulator.report().substeps > 1, spin > 1);
      EXPECT_LT(std::abs(world.pose(block).p.x()), 10 * deflection(1e-5, 3)) << merge << ' ' << spin;
    }
}

TEST(Memory, of_contacts_over_sleep) {
  World world;
  world.set_gravity({2, 0, -9.6});
  world.add_shape(kGround, HalfSpace{});
  const BodyId block = add_box(world, {0, 0, 0.1}, compliant(1e-4));
  add_drag(world, block);
  Simulator simulator(world, sleeping());
  advance(simulator, 480);
  ASSERT_TRUE(world.is_asleep(block));
  const double x = world.pose(block).p.x();
  for (int i = 0; i < 20; ++i) {
    world.wake(block);
    advance(simulator, 480);
    EXPECT_TRUE(world.is_asleep(block));
  }
  EXPECT_NEAR(world.pose(block).p.x(), x, 0.1 * deflection(1e-4, 2));
}

TEST(Memory, of_the_awake_where_others_are_woken) {
  World world;
  world.set_gravity({2, 0, -9.6});
  world.add_shape(kGround, HalfSpace{});
  const BodyId block = add_box(world, {0, 0, 0.1}, compliant(1e-4)), other = add_box(world, {0, 5, 0.1});
  add_drag(world, block);
  const BodyId wheel =
      world.add_body({.mass = MassProperties::sphere(0.05, 0.01), .pose = {Quat::Identity(), {0, 0, 0.1}}});
  const JointId axle = world.add("", Hinge::at(world, block, wheel, {0, 0, 0.1}, Vec3::UnitZ()));
  world.set_motor({axle, 0}, AxisMotor{.target = 1, .max_force = 1});  // keeps it awake
  const ForceId force = world.add_force(push(other, Vec3::Zero()));
  Simulator simulator(world, sleeping());
  advance(simulator, 480);
  const double x = world.pose(block).p.x();
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(world.is_asleep(other) && !world.is_asleep(block));
    world.set_force(force, push(other, {0, 0, -0.1 * (i % 2)}));
    advance(simulator, 240);
  }
  EXPECT_NEAR(world.pose(block).p.x(), x, 0.1 * deflection(1e-4, 2));
}

TEST(Memory, of_friction_in_joints_over_sleep_but_not_where_bodies_were_moved) {
  World world;
  const BodyId arm = world.add_body(
      {.mass = MassProperties::box({1, 0.1, 0.1}, 2), .pose = {Quat::Identity(), {0.5, 0, 0}}});
  const JointId hinge = world.add("", Hinge::at(world, kGround, arm, Vec3::Zero(), Vec3::UnitY()));
  world.set_friction({hinge, 0}, AxisFriction{.static_friction = 10, .dynamic_friction = 8});
  Simulator simulator(world, sleeping());
  for (int i = 0; i < 20; ++i) {
    advance(simulator, 240);
    ASSERT_TRUE(world.is_asleep(arm));
    EXPECT_NEAR(simulator.axis_report({hinge, 0}).force.friction, -9.81, 1e-8);
    world.wake(arm);
  }
  EXPECT_NEAR(world.axis_value({hinge, 0}), 0, 1e-12);
  const Quat turn = exp_so3(Vec3(0, 0.2, 0));
  world.set_pose(arm, {turn, turn * Vec3(0.5, 0, 0)});
  advance(simulator, 240);
  EXPECT_NEAR(world.axis_value({hinge, 0}), 0.2, 1e-9);
}

/// A load that is hung on a taut chain between two steps: as many sub-steps as at a new start.
TEST(Forces, that_jump_are_met_by_sub_steps) {
  World world;
  BodyId last = kGround;
  for (int i = 0; i < 10; ++i) {
    const BodyId link = world.add_body({.mass = MassProperties::box({0.02, 0.02, 0.1}, 0.1),
                                        .pose = {Quat::Identity(), {0, 0, -0.05 - 0.1 * i}}});
    world.add("", Ball::at(world, last, link, {0, 0, -0.1 * i}));
    last = link;
  }
  const BodyId beside = world.add_body(
      {.mass = MassProperties::box({0.1, 0.1, 0.1}, 1), .pose = {Quat::Identity(), {4, 0, 0}}});
  const JointId hinge = world.add("", Hinge::at(world, kGround, beside, {4, 0, 0}, Vec3::UnitY()));
  world.set_friction({hinge, 0}, AxisFriction{.static_friction = 1, .dynamic_friction = 1});
  const ForceId load = world.add_force(PointForce(last, {0, 0, -0.05}, {1e-3, 0, 0}));
  Simulator simulator(world);
  advance(simulator, 50);
  world.set_force(load, std::make_shared<PointForce>(last, Vec3(0, 0, -0.05), Vec3(0, 0, -2e4)));
  World same = world;
  Simulator fresh(same);
  advance(fresh, 1), advance(simulator, 1);
  EXPECT_GT(fresh.report().substeps, 10);
  EXPECT_GE(simulator.report().substeps, fresh.report().substeps);
  EXPECT_NEAR(kinetic_energy(world, world.state()), kinetic_energy(same, same.state()), 1e-3);
}

}  // namespace
}  // namespace taut::sleep_wake_test
