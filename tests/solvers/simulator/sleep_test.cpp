#include <gtest/gtest.h>

#include <cmath>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "tests/allocation_counter.h"
#include "tests/solvers/simulator/sleeping.h"

// Islands at rest fall asleep, and wake.
namespace taut::sleep_test {
namespace {

using testing::add_box;
using testing::kStep;
using testing::sleeping;
using testing::with_floor;

constexpr double kWeight = 9.81;  // of one box [N]

/// Boxes 1 mm above each other at x.
std::vector<BodyId> add_stack(World& world, double x, int count, double restitution = 0) {
  std::vector<BodyId> boxes;
  Material material;
  material.restitution = restitution;
  for (int i = 0; i < count; ++i)
    boxes.push_back(add_box(world, {x, 0, 0.1 + 0.001 * (i + 1) + 0.2 * i}, material));
  return boxes;
}

/// For so many seconds.
void advance(Simulator& simulator, double time) {
  testing::advance(simulator, static_cast<int>(std::lround(time / kStep)));
}

double force_on(const Simulator& simulator, BodyId body) {
  double force = 0;
  for (const ContactReport& c : simulator.contacts()) {
    if (c.contact.B == body) force += c.force.z();
    if (c.contact.A == body) force -= c.force.z();
  }
  return force;
}

bool equal_bits(const State& a, const State& b) {
  for (std::size_t i = 0; i < a.poses.size(); ++i)
    if (a.poses[i].p != b.poses[i].p || a.poses[i].q.coeffs() != b.poses[i].q.coeffs()) return false;
  return true;
}

TEST(Sleep, a_stack_at_rest_sleeps_and_its_contacts_still_bear_it) {
  World world = with_floor();
  const std::vector<BodyId> boxes = add_stack(world, 0, 5);
  Simulator simulator(world, sleeping());
  advance(simulator, 0.4);
  EXPECT_EQ(simulator.report().asleep, 0);
  const double energy = simulator.report().energy();
  advance(simulator, 1);
  EXPECT_EQ(simulator.report().asleep, 5);
  EXPECT_EQ(world.asleep_count(), 5);
  EXPECT_NEAR(simulator.report().energy(), energy, 1e-4 * energy);
  for (BodyId box : boxes) {
    EXPECT_TRUE(world.is_asleep(box));
    EXPECT_NEAR(force_on(simulator, box), kWeight, 1e-6);
  }
  const State then = world.state();
  advance(simulator, 1);
  EXPECT_TRUE(equal_bits(then, world.state()));
}

/// Nor does rest without sleep.
/// One thread: another one would allocate when it gets its first work, which may be late.
TEST(Sleep, rest_costs_no_analysis_and_no_allocation) {
  World world = with_floor();
  for (int k = 0; k < 20; ++k) (void)add_stack(world, 0.5 * k, 3);
  Settings settings = sleeping(false);
  settings.threads = 1;
  Simulator simulator(world, settings);
  advance(simulator, 1.5);
  const long before = allocation_count();
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(simulator.step(kStep).exact());
    ASSERT_EQ(simulator.report().counts.analyses, 0);
  }
  EXPECT_EQ(allocation_count() - before, 0);
}

TEST(Sleep, costs_no_analysis_and_no_allocation) {
  World world = with_floor();
  for (int k = 0; k < 20; ++k) (void)add_stack(world, 0.5 * k, 3);
  Simulator simulator(world, sleeping());
  advance(simulator, 1.5);
  ASSERT_EQ(simulator.report().asleep, 60);
  const long before = allocation_count();
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(simulator.step(kStep).exact());
    ASSERT_EQ(simulator.report().counts.analyses, 0);
  }
  EXPECT_EQ(allocation_count() - before, 0);
}

/// A ball drops on one of two stacks that sleep: what follows is what follows without sleep, but the other
/// stack sleeps on.
TEST(Sleep, what_is_touched_wakes_in_time_for_the_impact) {
  const auto drop = [](bool sleep, bool& other_slept) {
    World world = with_floor();
    const std::vector<BodyId> hit = add_stack(world, 0, 3, 0.5), other = add_stack(world, 2, 3);
    Material material;
    material.restitution = 0.5;
    const BodyId ball = world.add_body(
        {.mass = MassProperties::sphere(0.1, 0.5), .pose = {Quat::Identity(), {0.01, 0.02, 6}}});
    world.add_shape(ball, Sphere{0.1}, {}, material);
    Simulator simulator(world, sleeping(sleep));
    advance(simulator, 1.0);
    EXPECT_EQ(world.is_asleep(hit[2]), sleep);
    advance(simulator, 0.5);  // it falls 5.3 m in 1.04 s
    EXPECT_FALSE(world.is_asleep(hit[2]));
    EXPECT_FALSE(world.is_asleep(hit[0]));
    other_slept = world.is_asleep(other[0]) && world.is_asleep(other[2]);
    return std::pair(world.state().poses[ball.index], world.state().poses[hit[2].index]);
  };
  bool awake = false, asleep = false;
  const auto [ball, box] = drop(false, awake);
  const auto [ball_then, box_then] = drop(true, asleep);
  EXPECT_FALSE(awake);
  EXPECT_TRUE(asleep);
  // Residual velocities up to the sleeping speed are all that differs.
  EXPECT_LT((ball.p - ball_then.p).norm(), 1e-6);
  EXPECT_LT((box.p - box_then.p).norm(), 1e-6);
  EXPECT_GT(ball.p.z(), 0.75);  // it has bounced
}

TEST(Sleep, what_is_set_wakes_what_it_concerns) {
  World world = with_floor();
  const std::vector<BodyId> a = add_stack(world, 0, 2), b = add_stack(world, 2, 2);
  Simulator simulator(world, sleeping());
  const auto sleep_again = [&] {
    advance(simulator, 1.5);
    ASSERT_EQ(world.asleep_count(), 4);
  };
  const auto wakes = [&](const char* what, int count) {
    SCOPED_TRACE(what);
    ASSERT_TRUE(simulator.step(kStep).exact());
    EXPECT_EQ(simulator.report().asleep, 4 - count);
  };
  sleep_again();
  world.set_twist(a[1], {Vec3::Zero(), {0, 0, 0.5}});
  wakes("a velocity", 2);
  EXPECT_GT(world.twist(a[1]).v.z(), 0.4);
  sleep_again();
  Pose lifted = world.pose(a[1]);
  lifted.p.z() += 0.01;
  world.set_pose(a[1], lifted);
  wakes("a pose", 2);
  sleep_again();
  const ForceId force = world.add_force(PointForce(b[0], Vec3::Zero(), {0.1, 0, 0}));
  wakes("a force", 2);
  sleep_again();
  world.set_force(force, std::make_shared<PointForce>(b[0], Vec3::Zero(), Vec3(0, 0.1, 0)));
  wakes("another force", 2);
  sleep_again();
  world.set_gravity({0, 0, -9.8});
  wakes("gravity", 4);
  sleep_again();
  world.wake(a[0]);
  wakes("being woken", 2);
  sleep_again();
  State state = world.state();
  state.poses[b[1].index].p.z() += 0.01;
  world.set_state(state);
  wakes("a state", 2);
  sleep_again();
  (void)add_stack(world, 4, 1);
  wakes("nothing", 0);
}

/// A law of time that only the user knows begins to act.
TEST(Sleep, a_force_that_comes_to_act_wakes) {
  World world = with_floor();
  const std::vector<BodyId> a = add_stack(world, 0, 1), b = add_stack(world, -2, 1);
  world.add_force(ForceCallback(
      [body = a[0].index](const State& state, std::span<Wrench> wrenches) {
        if (state.time > 2) wrenches[body].force += Vec3(20, 0, 0);
      },
      false));
  Simulator simulator(world, sleeping());
  advance(simulator, 1.9);
  ASSERT_EQ(world.asleep_count(), 2);
  advance(simulator, 0.6);
  EXPECT_FALSE(world.is_asleep(a[0]));
  EXPECT_TRUE(world.is_asleep(b[0]));
  // From t = 2: (20 − μ m g) / m, found one step late at the most.
  const double acceleration = 20 - 0.5 * kWeight, time = 0.5;
  EXPECT_NEAR(world.pose(a[0]).p.x(), 0.5 * acceleration * time * time, acceleration * time * 2 * kStep);
}

/// What does not sleep goes on as if nothing had happened.
TEST(Sleep, others_are_not_disturbed) {
  const auto run = [](bool sleep) {
    World world = with_floor();
    (void)add_stack(world, 0, 3);
    Material rough;
    rough.static_friction = rough.dynamic_friction = 0.6;
    BodyId last = kGround;
    for (int i = 0; i < 4; ++i) {
      const BodyId rod = world.add_body({.mass = MassProperties::box({0.5, 0.05, 0.05}, 1),
                                         .pose = {Quat::Identity(), {3.25 + 0.5 * i, 0, 5}}});
      world.add("", Ball::at(world, last, rod, {3 + 0.5 * i, 0, 5}));
      last = rod;
    }
    const BodyId slider = world.add_body({.mass = MassProperties::box({0.2, 0.2, 0.2}, 1),
                                          .pose = {Quat::Identity(), {0, 3, 0.1}},
                                          .twist = {Vec3::Zero(), {0, 4, 0}}});
    world.add_shape(slider, Box{{0.2, 0.2, 0.2}}, {}, rough);
    Simulator simulator(world, sleeping(sleep));
    advance(simulator, 1);
    EXPECT_EQ(simulator.report().asleep, sleep ? 3 : 0);  // the slider has stopped 0.3 s ago
    return std::pair(world.state(), simulator.report().energy());
  };
  const auto [state, energy] = run(false);
  const auto [with_sleep, energy_with] = run(true);
  for (std::size_t b = 0; b < state.poses.size(); ++b)
    EXPECT_LT((state.poses[b].p - with_sleep.poses[b].p).norm(), 1e-7) << b;
  EXPECT_NEAR(energy, energy_with, 1e-6);
}

/// Σ of the ledgers is the change of energy, over falling asleep and waking.
TEST(Sleep, the_books_are_kept) {
  World world = with_floor();
  const std::vector<BodyId> boxes = add_stack(world, 0, 3);
  const BodyId ball =
      world.add_body({.mass = MassProperties::sphere(0.1, 0.5), .pose = {Quat::Identity(), {0, 0, 8}}});
  world.add_shape(ball, Sphere{0.1});
  Simulator simulator(world, sleeping());
  const double start = world.potential_energy(world.state());
  double sum = 0;
  bool slept = false;
  for (int i = 0; i < 360; ++i) {
    ASSERT_TRUE(simulator.step(kStep).exact());
    sum += simulator.report().ledger.total();
    slept = slept || world.is_asleep(boxes[0]);
    EXPECT_NEAR(simulator.report().energy() - start, sum, 1e-10);
  }
  EXPECT_TRUE(slept);
  EXPECT_FALSE(world.is_asleep(boxes[0]));
}

/// A chain with friction in its joints comes to rest hanging; what it bears is known while it sleeps.
struct Chain {
  World world;
  std::vector<JointId> joints;
  std::vector<BodyId> rods;
  Chain() {
    BodyId last = kGround;
    for (int i = 0; i < 3; ++i) {
      rods.push_back(world.add_body({.mass = MassProperties::box({0.1, 0.1, 0.5}, 1),
                                     .pose = {Quat::Identity(), {0, 0, -0.25 - 0.5 * i}}}));
      joints.push_back(world.add("", Hinge::at(world, last, rods.back(), {0, 0, -0.5 * i}, Vec3::UnitY())));
      world.set_friction({joints.back(), 0}, AxisFriction{.static_friction = 0.2, .dynamic_friction = 0.2});
      last = rods.back();
    }
  }
};

TEST(Sleep, joints_of_sleeping_bodies_report_what_they_bear) {
  Chain chain;
  Simulator simulator(chain.world, sleeping());
  advance(simulator, 1);
  ASSERT_EQ(chain.world.asleep_count(), 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(simulator.mean_reaction(chain.joints[i]).force.z(), (3 - i) * kWeight, 1e-8);
    EXPECT_NEAR(simulator.reaction(chain.joints[i]).force.z(), (3 - i) * kWeight, 1e-8);
  }
  EXPECT_EQ(simulator.analyze_rank().freedoms, 3);
  chain.world.set_motor({chain.joints[2], 0}, AxisMotor{.target = 1, .max_force = 5});
  ASSERT_TRUE(simulator.step(kStep).exact());
  EXPECT_EQ(chain.world.asleep_count(), 0);
  advance(simulator, 1);
  EXPECT_EQ(chain.world.asleep_count(), 0);  // a motor that turns
}

TEST(Sleep, a_motor_that_cannot_turn_and_a_driver_that_will_move_stay_awake) {
  World world;
  const BodyId held = world.add_body(
      {.mass = MassProperties::box({1, 0.1, 0.1}, 1), .pose = {Quat::Identity(), {0.5, 0, 0}}});
  const JointId hinge = world.add("", Hinge::at(world, kGround, held, Vec3::Zero(), Vec3::UnitY()));
  world.set_limits({hinge, 0}, AxisLimits{.lower = -1, .upper = 0});
  world.set_motor({hinge, 0}, AxisMotor{.target = 1, .max_force = 50});
  Simulator simulator(world, sleeping());
  advance(simulator, 1);
  EXPECT_EQ(world.asleep_count(), 0);
}

TEST(Sleep, merged_bodies_sleep_and_wake_together) {
  World world = with_floor();
  const std::vector<BodyId> boxes = add_stack(world, 0, 2), others = add_stack(world, 3, 1);
  const BodyId side =
      world.add_body({.mass = MassProperties::box({0.2, 0.2, 0.2}, 1),
                      .pose = {Quat::Identity(), world.pose(boxes[1]).p + Vec3(0.05, 0, 0.2)}});
  const JointId weld = world.add("", Fixed::at(world, boxes[1], side, world.pose(side).p));
  Settings settings = sleeping();
  settings.merge_fixed_joints = true;
  Simulator simulator(world, settings);
  advance(simulator, 1.2);
  EXPECT_EQ(world.asleep_count(), 4);
  EXPECT_TRUE(world.is_asleep(side));
  EXPECT_NEAR(simulator.mean_reaction(weld).force.z(), kWeight, 1e-6);
  world.wake(side);
  ASSERT_TRUE(simulator.step(kStep).exact());
  EXPECT_FALSE(world.is_asleep(side) || world.is_asleep(boxes[1]) || world.is_asleep(boxes[0]));
  EXPECT_TRUE(world.is_asleep(others[0]));
}

TEST(Sleep, with_every_integrator) {
  for (Integrator integrator : {Integrator::kRattle4, Integrator::kForceEuler, Integrator::kForceRungeKutta,
                                Integrator::kMoreauJean}) {
    Chain chain;
    for (JointId joint : chain.joints)
      if (integrator != Integrator::kMoreauJean) chain.world.set_friction({joint, 0}, {});
    Settings settings = sleeping();
    settings.integrator = integrator;
    Simulator simulator(chain.world, settings);
    advance(simulator, 1);
    EXPECT_EQ(chain.world.asleep_count(), 3) << static_cast<int>(integrator);
    chain.world.set_twist(chain.rods[2], {{0, 1, 0}, Vec3::Zero()});
    ASSERT_TRUE(simulator.step(kStep).exact());
    EXPECT_EQ(chain.world.asleep_count(), 0);
    EXPECT_GT(kinetic_energy(chain.world, chain.world.state()), 1e-4);
  }
}

/// The same bits twice, and awake again for another simulator.
TEST(Sleep, is_repeatable_and_ends_with_its_simulator) {
  const auto run = [] {
    World world = with_floor();
    (void)add_stack(world, 0, 3), (void)add_stack(world, 1, 2);
    {
      Simulator simulator(world, sleeping());
      advance(simulator, 1.5);
    }
    EXPECT_EQ(world.asleep_count(), 5);
    return world;
  };
  World first = run(), second = run();
  EXPECT_TRUE(equal_bits(first.state(), second.state()));
  Simulator other(first, sleeping(false));
  ASSERT_TRUE(other.step(kStep).exact());
  EXPECT_EQ(first.asleep_count(), 0);
}

}  // namespace
}  // namespace taut::sleep_test
