#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "core/joints/joints.h"
#include "core/state/same_state.h"
#include "core/world/diagnostics.h"
#include "scenes/builders/scene.h"
#include "scenes/files/scene_file.h"
#include "solvers/simulator/simulator.h"
#include "tests/source_dir.h"

// A simulation whose world is replaced, whose force laws throw, and whose springs stall.
namespace taut::robust_simulator_test {
namespace {

Scene adversary(const std::string& name) {
  return load_scene_file(testing::source_dir() + "/tests/adversary/" + name);
}

/// All joints that a report names are there.
void expect_joints_are_there(const StepReport& report, const World& world) {
  for (JointId joint : report.contradiction.joints) EXPECT_LT(joint.index, world.joint_count());
  for (const DependentRow& row : report.dependent_rows) EXPECT_LT(row.joint.index, world.joint_count());
  EXPECT_EQ(names_of(report.contradiction, world).size(), report.contradiction.joints.size() +
                                                              report.contradiction.bounds.size() +
                                                              report.contradiction.contacts.size());
}

class RobustSpringWorlds : public ::testing::TestWithParam<const char*> {};

TEST_P(RobustSpringWorlds, ThatStallAreTakenForNoJoints) {
  Scene scene = adversary(GetParam());
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 200; ++i) {
    const StepReport& report = simulator.step(scene.dt);
    expect_joints_are_there(report, scene.world);
    if (!report.ok()) break;
  }
}

INSTANTIATE_TEST_SUITE_P(Worlds, RobustSpringWorlds,
                         ::testing::Values("spring_stall_heap_overflow.json", "m624.json", "m626.json"));

/// Limits, friction and contacts at once: an impulse that had been on a piece of its law which the renewed
/// law did not have counted as infinitely far off, and the step was cut down to nothing.
TEST(RobustLimits, OfAFallenRagdollAreMet) {
  Scene scene = adversary("ragdoll_at_limits.json");
  Simulator simulator(scene.world, scene.settings);
  for (double t = 0; t < scene.duration; t += scene.dt) {
    const StepReport& report = simulator.step(scene.dt);
    ASSERT_EQ(report.status, Status::kSuccess) << "t = " << t << ": " << report.message;
    ASSERT_LE(std::max(report.gap.metres, report.gap.radians), 1e-9);
    ASSERT_LE(report.natural_residual, 1e-8);
  }
}

/// Its spring hangs on a body 1e77 m away.
TEST(RobustSpringsInput, FarBeyondReachAreRefused) {
  EXPECT_THROW((void)adversary("spring_row_named_as_joint.json"), std::invalid_argument);
}

/// A joint of three bodies whose compliance is too stiff for the step wrote past the places of two.
TEST(RobustSprings, OfJointsOfThreeBodiesStayWithinTheirPlaces) {
  World world;
  world.set_gravity(Vec3::Zero());
  const auto ball = [&](const Vec3& p, const Vec3& v) {
    return world.add_body(
        {.mass = MassProperties::sphere(0.1, 1), .pose = {Quat::Identity(), p}, .twist = {Vec3::Zero(), v}});
  };
  const BodyId a = ball({-1, 0, -1}, {0.1, 0, -0.5}), sheaves = ball({0, 0.2, 0}, {0, 0.1, 0.2}),
               b = ball({1, 0, -1}, {0, 0.1, -0.5});
  const JointId pulley =
      world.add("", Pulley::at(world, a, {-1, 0, -0.9}, sheaves, {-1, 0, 0}, {1, 0, 0}, b, {1, 0, -0.9}));
  world.set_compliance(pulley, JointCompliance{.translation = 1e-6});
  const auto momentum = [&] {
    Vec3 p = Vec3::Zero();
    for (BodyId body : {a, sheaves, b}) p += world.mass_properties(body).mass() * world.twist(body).v;
    return p;
  };
  const Vec3 before = momentum();
  const double energy = kinetic_energy(world, world.state());
  Simulator simulator(world);
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(simulator.step(0.01).exact()) << simulator.report().message;
    EXPECT_LE((momentum() - before).norm(), 1e-13);
    EXPECT_LE(kinetic_energy(world, world.state()), energy * (1 + 1e-3));
  }
}

/// Dependent rows of contacts that are gone belong to nothing, and were read beyond the end of all rows.
TEST(RobustContactsGone, LeaveNoDependentRows) {
  Scene scene = adversary("dependent_contacts_gone.json");
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 200 && simulator.step(scene.dt).ok(); ++i)
    expect_joints_are_there(simulator.report(), scene.world);
}

World pendulum(int rods, double length = 1) {
  World world;
  BodyId last = kGround;
  for (int k = 0; k < rods; ++k) {
    const Vec3 centre((k + 0.5) * length, 0, 0);
    const BodyId rod = world.add_body(
        {.mass = MassProperties::box({length, 0.1, 0.1}, 1), .pose = {Quat::Identity(), centre}});
    world.add("", Hinge::at(world, last, rod, centre - Vec3(length / 2, 0, 0), Vec3::UnitY()));
    last = rod;
  }
  return world;
}

void step(Simulator& simulator, int steps) {
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulator.step(1e-3);
    ASSERT_TRUE(report.exact()) << report.message;
  }
}

/// As a simulator that has never seen another world.
void expect_as_new(World& world, Simulator& simulator) {
  World copy = world;
  Simulator fresh(copy);
  step(simulator, 20), step(fresh, 20);
  EXPECT_TRUE(same(world.state(), copy.state()));
}

TEST(RobustWorldAssigned, AStateOfBeforeIsTakenUp) {
  World world = pendulum(2);
  Simulator simulator(world);
  step(simulator, 10);
  const World saved = world;
  step(simulator, 10);
  world = saved;  // as many changes, other contents
  expect_as_new(world, simulator);
}

TEST(RobustWorldAssigned, OtherTopologyIsSeenThoughItCountsAlike) {
  World world = pendulum(2), other;
  {
    const BodyId a =
        other.add_body({.mass = MassProperties::sphere(0.1, 1), .pose = {Quat::Identity(), Vec3::UnitX()}});
    const BodyId b = other.add_body(
        {.mass = MassProperties::sphere(0.1, 1), .pose = {Quat::Identity(), 2 * Vec3::UnitX()}});
    other.add("", Slider::at(other, kGround, a, Vec3::UnitX(), Vec3(1, 0, 1).normalized()));
    other.add("", Ball::at(other, a, b, Vec3::UnitX()));
  }
  Simulator simulator(world), of_other(other);
  step(simulator, 5), step(of_other, 5);
  world = other;
  expect_as_new(world, simulator);
}

TEST(RobustWorldAssigned, FewerBodiesAndQuestionsBeforeTheNextStep) {
  World world = pendulum(5);
  const World small = pendulum(1);
  Simulator simulator(world, {.sleep = true});
  step(simulator, 5);
  world = small;
  EXPECT_TRUE(simulator.mean_reaction(JointId{0}).force.isZero(0));
  EXPECT_THROW((void)simulator.mean_reaction(JointId{4}), std::invalid_argument);
  EXPECT_TRUE(simulator.contacts().empty());
  EXPECT_TRUE(simulator.contact_stretches().empty());
  // A rod that is let go: m g I / (I + m l²/4).
  const double inertia = (1 + 0.01) / 12;
  EXPECT_NEAR(simulator.reaction(JointId{0}).force.norm(), 9.81 * inertia / (inertia + 0.25), 1e-9);
  expect_as_new(world, simulator);
  world = pendulum(8);
  expect_as_new(world, simulator);
}

TEST(RobustWorldAssigned, WithMergedBodies) {
  World world = pendulum(3);
  const BodyId load = world.add_body({.mass = MassProperties::sphere(0.1, 2), .pose = world.pose(BodyId{3})});
  world.add("load", Fixed::at(world, BodyId{3}, load, world.pose(load).p));
  Simulator simulator(world, {.merge_fixed_joints = true});
  step(simulator, 5);
  const World saved = world;
  step(simulator, 5);
  world = saved;
  World copy = world;
  Simulator fresh(copy, {.merge_fixed_joints = true});
  step(simulator, 20), step(fresh, 20);
  EXPECT_TRUE(same(world.state(), copy.state()));
  world = pendulum(1);
  step(simulator, 20);
}

TEST(RobustFailure, OfAStepThatBeganByClosingJointsLeavesTheStateAsItWas) {
  World world = pendulum(2);
  bool bad = false;
  world.add_force(ForceCallback(
      [&](const State&, std::span<Wrench> wrenches) {
        if (bad) wrenches[1].force.x() = std::numeric_limits<double>::quiet_NaN();
      },
      false));
  Simulator simulator(world);
  step(simulator, 2);
  Pose open = world.pose(BodyId{2});
  open.p += Vec3(1e-3, 0, 0);
  world.set_pose(BodyId{2}, open);
  const State before = world.state();
  bad = true;
  EXPECT_FALSE(simulator.step(1e-3).ok());
  EXPECT_TRUE(same(world.state(), before));
  bad = false;
  step(simulator, 2);
}

/// A step closes joints that are open; a question about the solver before it does not.
TEST(RobustFailure, ASolverIsDescribedWithoutMovingBodies) {
  for (const bool merges : {false, true}) {
    World world = pendulum(2);
    Pose open = world.pose(BodyId{2});
    open.p += Vec3(1e-3, 0, 0);
    world.set_pose(BodyId{2}, open);
    const World copy = world;
    World other = world;
    Settings settings;
    settings.merge_fixed_joints = merges;
    Simulator asked(world, settings), not_asked(other, settings);
    EXPECT_FALSE(asked.solver_description().empty());
    EXPECT_TRUE(same(world.state(), copy.state()));
    step(asked, 2), step(not_asked, 2);
    EXPECT_TRUE(same(world.state(), other.state()));
  }
}

/// Throws at its n-th call, counting from now.
struct Trap {
  int calls_left = -1;
  void spring() {
    if (calls_left >= 0 && calls_left-- == 0) throw std::runtime_error("trap");
  }
};

class RobustCallback : public ::testing::TestWithParam<std::tuple<bool, Integrator>> {
 protected:
  Settings settings() const {
    return {.integrator = std::get<1>(GetParam()), .merge_fixed_joints = std::get<0>(GetParam())};
  }
};

TEST_P(RobustCallback, WhateverThrowsLeavesWorldAndReportAsTheyWere) {
  World world = pendulum(2);
  const BodyId load = world.add_body({.mass = MassProperties::sphere(0.1, 2), .pose = world.pose(BodyId{2})});
  world.add("load", Fixed::at(world, BodyId{2}, load, world.pose(load).p));
  auto trap = std::make_shared<Trap>();
  const auto wind = [trap](const State& state, std::span<Wrench> wrenches) {
    trap->spring();
    wrenches[1].force -= 0.1 * state.twists[1].v;
  };
  const auto potential = [trap](const State&) {
    trap->spring();
    return 0.0;
  };
  world.add_force(ForceCallback(wind, true, potential));
  World untouched = world;  // shares the law, and so the trap, which is set only for the other
  Simulator simulator(world, settings()), other(untouched, settings());
  step(simulator, 5), step(other, 5);
  int thrown = 0;
  for (int calls = 0; calls < 200; ++calls) {
    const World before = world;
    const double energy = simulator.report().energy();
    const int newton = simulator.report().newton_iterations;
    trap->calls_left = calls;
    bool threw = false;
    try {
      (void)simulator.step(1e-3);
    } catch (const std::runtime_error&) {
      threw = true;
    }
    trap->calls_left = -1;
    if (!threw) break;  // a step makes fewer calls
    ++thrown;
    EXPECT_TRUE(same(world.state(), before.state())) << calls;
    EXPECT_TRUE(simulator.report().exact());
    EXPECT_EQ(simulator.report().energy(), energy) << calls;
    EXPECT_EQ(simulator.report().newton_iterations, newton) << calls;
  }
  EXPECT_GT(thrown, 3);
  EXPECT_LT(thrown, 200);
  step(simulator, 20), step(other, 21);
  for (int b = 1; b < world.body_count(); ++b)
    EXPECT_LT((world.pose(BodyId{b}).p - untouched.pose(BodyId{b}).p).norm(), 1e-9) << b;
}

/// Boxes that stick, slide and roll over, on a floor, and a hinge with friction: what laws know of the steps
/// before is no more than a guess.
TEST_P(RobustCallback, WhateverThrowsIsNoStepOfContacts) {
  if (std::get<1>(GetParam()) == Integrator::kRattle4) return;  // has no contacts
  World world = pendulum(2);
  world.set_friction(world.axis(JointId{1}, "angle"),
                     AxisFriction{.static_friction = 0.2, .dynamic_friction = 0.1});
  world.add_shape(kGround, HalfSpace{}, Pose{Quat::Identity(), {0, 0, -3}},
                  Material{.static_friction = 0.4, .dynamic_friction = 0.4});
  for (int i = 0; i < 3; ++i) {
    const BodyId box = world.add_body({.mass = MassProperties::box({0.4, 0.4, 0.4}, 1.0),
                                       .pose = {Quat::Identity(), {3, 1.0 * i, -2.79}},
                                       .twist = {{0, 1.0 * i, 0}, {0.5 * i, 0, 0}}});
    world.add_shape(box, Box{.size = {0.4, 0.4, 0.4}}, Pose{},
                    Material{.static_friction = 0.4, .dynamic_friction = 0.4});
  }
  auto trap = std::make_shared<Trap>();
  world.add_force(ForceCallback([trap](const State&, std::span<Wrench>) { trap->spring(); }, true));
  World untouched = world;
  Simulator simulator(world, settings()), other(untouched, settings());
  for (int i = 0; i < 40; ++i) {
    step(simulator, 10), step(other, 10);
    trap->calls_left = i % 3;
    EXPECT_THROW((void)simulator.step(1e-3), std::runtime_error) << i;
    trap->calls_left = -1;
  }
  for (int b = 1; b < world.body_count(); ++b)
    EXPECT_LT((world.pose(BodyId{b}).p - untouched.pose(BodyId{b}).p).norm(), 1e-8) << b;
}

TEST_P(RobustCallback, ThatChangesTheWorldThrowsAndChangesNothing) {
  World world = pendulum(2);
  const BodyId load = world.add_body({.mass = MassProperties::sphere(0.1, 2), .pose = world.pose(BodyId{2})});
  world.add("load", Fixed::at(world, BodyId{2}, load, world.pose(load).p));
  Simulator simulator(world, settings());
  std::function<void(World&)> deed = [](World&) {};
  world.add_force(ForceCallback([&](const State&, std::span<Wrench>) { deed(world); }, false));
  step(simulator, 3);
  const World other = pendulum(1);
  const std::vector<std::function<void(World&)>> deeds = {
      [](World& w) { w.add_body({}); },
      [](World& w) { w.detach(JointId{0}); },
      [](World& w) { w.set_gravity(Vec3::Zero()); },
      [](World& w) { w.set_pose(BodyId{1}, Pose{}); },
      [](World& w) { w.set_friction(w.axis(JointId{0}, "angle"), AxisFriction{.viscous = 1}); },
      [](World& w) { w.add_shape(BodyId{1}, Sphere{1}); },
      [&](World& w) { w = other; },
      [](World& w) { w.set_state(State(w.state())); }};
  for (std::size_t i = 0; i < deeds.size(); ++i) {
    deed = deeds[i];
    const State before = world.state();
    const int bodies = world.body_count();
    EXPECT_THROW((void)simulator.step(1e-3), std::logic_error) << i;
    EXPECT_TRUE(same(world.state(), before)) << i;
    EXPECT_EQ(world.body_count(), bodies) << i;
    deed = [](World&) {};
    step(simulator, 2);
  }
}

INSTANTIATE_TEST_SUITE_P(MergedOrNot, RobustCallback,
                         ::testing::Combine(::testing::Bool(),
                                            ::testing::Values(Integrator::kRattle, Integrator::kRattle4,
                                                              Integrator::kMoreauJean)));

TEST(RobustCallbackBreaking, AJointThatBrokeInTheStepIsBack) {
  World world = pendulum(2);
  world.set_break(JointId{1}, BreakLimits{.force = 6});
  Simulator simulator(world);
  bool trap = false;
  world.add_force(ForceCallback([](const State&, std::span<Wrench>) {}, false,
                                [&](const State&) {
                                  if (trap && !world.is_attached(JointId{1}))
                                    throw std::runtime_error("trap");
                                  return 0.0;
                                }));
  trap = true;
  bool threw = false;
  for (int i = 0; i < 5000 && !threw; ++i) {
    const State before = world.state();
    try {
      ASSERT_TRUE(simulator.step(1e-3).exact());
    } catch (const std::runtime_error&) {
      threw = true;
      EXPECT_TRUE(world.is_attached(JointId{1}));
      EXPECT_TRUE(same(world.state(), before));
    }
  }
  ASSERT_TRUE(threw);
  trap = false;
  step(simulator, 5);
  EXPECT_FALSE(world.is_attached(JointId{1}));
}

}  // namespace
}  // namespace taut::robust_simulator_test
