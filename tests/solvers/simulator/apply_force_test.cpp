#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/joints/joints.h"
#include "core/world/applied_force.h"
#include "scenes/builders/scene.h"
#include "solvers/common/setting_names.h"
#include "solvers/simulator/simulator.h"
#include "tests/refusal.h"
#include "tests/solvers/simulator/merging.h"
#include "tests/solvers/simulator/sleeping.h"

// Forces that act during one step.
namespace taut::apply_force_test {
namespace {

using testing::refusal;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Bob {
  World world;
  BodyId bob;
  explicit Bob(const Vec3& gravity = Vec3::Zero()) {
    world.set_gravity(gravity);
    bob = world.add_body(
        {.name = "bob", .mass = MassProperties(2, Vec3(1, 2, 3)), .pose = {.p = Vec3(1, 0, 0)}});
  }
};

/// Momentum grows by what was applied, in the next step alone, with every integrator.
TEST(ApplyForce, GivesItsImpulseInOneStep) {
  for (const auto& [name, integrator] : kIntegratorNames) {
    Bob b;
    Settings settings;
    settings.integrator = integrator;
    Simulator simulator(b.world, settings);
    simulator.apply_force(b.bob, {{0, 0, 3}, {4, 0, 0}});
    simulator.apply_force(b.bob, {{0, 0, 3}, {0, -8, 0}});  // they add up
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(simulator.step(0.01).exact()) << name;
      const Twist& V = b.world.twist(b.bob);
      EXPECT_NEAR((V.v - Vec3(0.02, -0.04, 0)).norm(), 0, 1e-14) << name << i;  // round-off
      EXPECT_NEAR((V.w - Vec3(0, 0, 0.02)).norm(), 0, 1e-14) << name << i;
    }
  }
}

TEST(ApplyForce, AtAPointHasItsTorque) {
  Bob b;
  b.world.set_pose(b.bob, {exp_so3(Vec3(0, 0, std::acos(0.0))), Vec3(1, 0, 0)});  // body x is world y
  Simulator simulator(b.world);
  simulator.apply_force(b.bob, Vec3(0.5, 0, 0), Vec3(6, 0, 0));  // r × f = (0, 0.5, 0) × (6, 0, 0)
  ASSERT_TRUE(simulator.step(0.01).exact());
  EXPECT_NEAR((b.world.twist(b.bob).v - Vec3(0.03, 0, 0)).norm(), 0, 1e-14);
  EXPECT_NEAR((b.world.twist(b.bob).w - Vec3(0, 0, -3 * 0.01 / 3)).norm(), 0, 1e-14);
}

/// Applied before each step it is a constant law, sub-steps and joints included.
TEST(ApplyForce, InEachStepIsAConstantLaw) {
  for (const Integrator integrator : {Integrator::kRattle, Integrator::kRattle4, Integrator::kMoreauJean}) {
    const Wrench wrench{{1, -2, 0.5}, {30, 10, 5}};
    State ends[2];
    for (const bool law : {true, false}) {
      Scene scene = build_scene("chain", {{"n", 6}});
      const BodyId last{scene.world.body_count() - 1};
      if (law)
        scene.world.add_force(ForceCallback(
            [&](const State&, std::span<Wrench> wrenches) {
              wrenches[last.index] = wrenches[last.index] + wrench;
            },
            false));
      scene.settings.integrator = integrator;
      Simulator simulator(scene.world, scene.settings);
      for (int i = 0; i < 40; ++i) {
        if (!law) simulator.apply_force(last, wrench);
        ASSERT_TRUE(simulator.step(0.01).ok()) << simulator.report().message;
      }
      ends[law] = scene.world.state();
    }
    // Equal but for round-off, which a chain that swings makes grow.
    for (std::size_t b = 0; b < ends[0].poses.size(); ++b) {
      EXPECT_NEAR((ends[0].poses[b].p - ends[1].poses[b].p).norm(), 0, 1e-9);
      EXPECT_NEAR((ends[0].twists[b].v - ends[1].twists[b].v).norm(), 0, 1e-8);
    }
  }
}

/// Its work is that of forces without a potential; all of it is kinetic energy here.
TEST(ApplyForce, ItsWorkIsInTheLedger) {
  Bob b;
  b.world.set_twist(b.bob, {Vec3::Zero(), Vec3(1, 0, 0)});
  Simulator simulator(b.world);
  simulator.apply_force(b.bob, {Vec3::Zero(), Vec3(4, 0, 0)});
  const EnergyLedger& ledger = simulator.step(0.1).ledger;
  const double work = 0.5 * 2 * (1.2 * 1.2 - 1);
  EXPECT_NEAR(ledger.forces, work, 1e-14);
  EXPECT_NEAR(ledger.kinetic, work, 1e-14);
  EXPECT_NEAR(ledger.unexplained(), 0, 1e-14);
  EXPECT_EQ(simulator.step(0.1).ledger.forces, 0);
}

/// A joint bears what is applied, and says so for the step in which it was; at the present instant it is
/// over.
TEST(ApplyForce, JointsBearItForOneStep) {
  for (const Settings& settings : {testing::solving(), testing::merging()}) {
    World world;
    world.set_gravity(Vec3::Zero());
    const BodyId a =
        world.add_body({.mass = MassProperties(1, Vec3(1, 1, 1)), .pose = {.p = Vec3(0.5, 0, 0)}});
    const BodyId b =
        world.add_body({.mass = MassProperties(1, Vec3(1, 1, 1)), .pose = {.p = Vec3(1.5, 0, 0)}});
    const JointId root = world.add("root", Fixed::at(world, kGround, a, Vec3::Zero()));
    const JointId weld = world.add("weld", Fixed::at(world, a, b, Vec3(1, 0, 0)));
    Simulator simulator(world, settings);
    ASSERT_TRUE(simulator.step(0.01).exact());
    simulator.apply_force(b, {Vec3::Zero(), Vec3(0, 0, -7)});
    ASSERT_TRUE(simulator.step(0.01).exact());
    for (const bool asked : {false, true}) {
      EXPECT_NEAR((simulator.mean_reaction(weld).force - Vec3(0, 0, 7)).norm(), 0, 1e-12) << asked;
      EXPECT_NEAR((simulator.mean_reaction(weld).torque - Vec3(0, -3.5, 0)).norm(), 0, 1e-12) << asked;
      EXPECT_NEAR((simulator.mean_reaction(root).torque - Vec3(0, -10.5, 0)).norm(), 0, 1e-12) << asked;
      EXPECT_NEAR(simulator.reaction(weld).force.norm(), 0, 1e-12);
    }
    ASSERT_TRUE(simulator.step(0.01).exact());
    EXPECT_NEAR(simulator.mean_reaction(weld).force.norm(), 0, 1e-12);
  }
}

/// What bodies that move as one get is what they get as bodies of their own, as they turn.
TEST(ApplyForce, MembersOfMergedBodiesFeelIt) {
  State ends[2];
  for (const bool merged : {false, true}) {
    Bob b;
    const BodyId arm =
        b.world.add_body({.mass = MassProperties(1, Vec3(1, 1, 1)), .pose = {.p = Vec3(2, 0, 0)}});
    b.world.add("weld", Fixed::at(b.world, b.bob, arm, Vec3(1.5, 0, 0)));
    Simulator simulator(b.world, merged ? testing::merging() : testing::solving());
    for (int i = 0; i < 50; ++i) {
      simulator.apply_force(arm, {Vec3(0, 1, 0), Vec3(0, 5, 0)});
      ASSERT_TRUE(simulator.step(0.01).exact());
    }
    ends[merged] = b.world.state();
  }
  // Two discretisations of order 2 of 0.5 s.
  for (std::size_t b = 1; b < ends[0].poses.size(); ++b) {
    EXPECT_NEAR((ends[0].poses[b].p - ends[1].poses[b].p).norm(), 0, 1e-4);
    EXPECT_GT((ends[1].poses[b].p - Vec3(b, 0, 0)).norm(), 0.1);
  }
}

/// A step that fails leaves it for the next try, whatever made it fail; then it acts once.
TEST(ApplyForce, AStepThatFailsKeepsIt) {
  enum class Trouble { kNone, kNotFinite, kThrows, kInterrupt } trouble = Trouble::kNone;
  for (const Trouble kind : {Trouble::kNotFinite, Trouble::kThrows, Trouble::kInterrupt}) {
    Bob b;
    b.world.add_force(ForceCallback([&](const State&, std::span<Wrench> wrenches) {
      if (trouble == Trouble::kThrows) throw std::runtime_error("no");
      if (trouble == Trouble::kNotFinite) wrenches[b.bob.index].force.x() = kNaN;
    }));
    Simulator simulator(b.world);
    simulator.set_interrupt([&] { return trouble == Trouble::kInterrupt; });
    ASSERT_TRUE(simulator.step(0.01).exact());
    simulator.apply_force(b.bob, {Vec3::Zero(), Vec3(4, 0, 0)});
    trouble = kind;
    if (kind == Trouble::kThrows) {
      EXPECT_THROW((void)simulator.step(0.01), std::runtime_error);
    } else {
      EXPECT_FALSE(simulator.step(0.01).ok());
    }
    trouble = Trouble::kNone;
    std::vector<Wrench> forces(b.world.body_count());
    b.world.forces(b.world.state(), forces);
    EXPECT_EQ(forces[b.bob.index].force, Vec3::Zero().eval());  // it is no force of the world
    for (int i = 0; i < 2; ++i) {
      ASSERT_TRUE(simulator.step(0.01).exact());
      EXPECT_NEAR(b.world.twist(b.bob).v.x(), 0.02, 1e-15) << static_cast<int>(kind);
    }
  }
}

TEST(ApplyForce, IsInCheckpoints) {
  for (const bool started : {false, true}) {
    Bob one(Vec3(0, 0, -9.81)), other(Vec3(0, 0, -9.81));
    Simulator simulator(one.world), again(other.world);
    if (started) testing::advance(simulator, 1, 0.01);
    simulator.apply_force(one.bob, {Vec3(1, 2, 3), Vec3(4, 0, 0)});
    const Checkpoint checkpoint = Checkpoint::from_bytes(simulator.checkpoint().bytes());
    again.restore(checkpoint);
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(simulator.step(0.01).exact());
      ASSERT_TRUE(again.step(0.01).exact());
      EXPECT_EQ(one.world.pose(one.bob).p, other.world.pose(other.bob).p);
      EXPECT_EQ(one.world.twist(one.bob).w, other.world.twist(other.bob).w);
    }
    EXPECT_GT(other.world.twist(other.bob).v.x(), 0.019);
    again.restore(checkpoint);  // it acts anew
    ASSERT_TRUE(again.step(0.01).exact());
    EXPECT_NEAR(other.world.twist(other.bob).v.x(), 0.02, 1e-15);
  }
}

/// The island that it pushes wakes, and no other.
TEST(ApplyForce, WakesTheIsland) {
  World world = testing::with_floor();
  const BodyId near = testing::add_box(world, {0, 0, 0.1}), on_top = testing::add_box(world, {0, 0, 0.3}),
               far = testing::add_box(world, {5, 0, 0.1});
  Simulator simulator(world, testing::sleeping());
  testing::advance(simulator, 240);
  ASSERT_EQ(world.asleep_count(), 3);
  simulator.apply_force(near, {Vec3::Zero(), Vec3(100, 0, 0)});
  testing::advance(simulator, 1);
  EXPECT_FALSE(world.is_asleep(near));
  EXPECT_FALSE(world.is_asleep(on_top));
  EXPECT_TRUE(world.is_asleep(far));
  EXPECT_GT(world.twist(near).v.x(), 0.3);  // 100 N less friction, for 1/240 s
}

/// Contacts and axes say what they gave in the step, also after a question about the present instant.
TEST(ApplyForce, ReportsOfTheStepStay) {
  World world = testing::with_floor();
  const BodyId box = testing::add_box(world, {0, 0, 0.1});
  const BodyId wheel =
      world.add_body({.mass = MassProperties(1, Vec3(1, 1, 1)), .pose = {.p = Vec3(5, 0, 1)}});
  const JointId axle = world.add("axle", Hinge::at(world, kGround, wheel, Vec3(5, 0, 1), Vec3::UnitY()));
  world.set_friction({axle, 0}, AxisFriction{.static_friction = 10, .dynamic_friction = 8});
  Simulator simulator(world);
  testing::advance(simulator, 5);
  simulator.apply_force(box, {Vec3::Zero(), Vec3(0, 0, -50)});
  simulator.apply_force(wheel, {Vec3(0, 6, 0), Vec3::Zero()});
  testing::advance(simulator, 1);
  for (const bool asked : {false, true}) {
    double force = 0;
    for (const ContactReport& c : simulator.contacts()) force += c.normal_force;
    EXPECT_NEAR(force, 59.81, 1e-6) << asked;
    // A stage with contacts meets its laws to 1e-9 of the largest impulse.
    EXPECT_NEAR(simulator.axis_report({axle, 0}).force.friction, -6, 6e-8) << asked;
    (void)simulator.reaction(axle);
  }
  testing::advance(simulator, 1);
  EXPECT_NEAR(simulator.axis_report({axle, 0}).force.friction, 0, 6e-8);
}

TEST(ApplyForce, RefusesWhatIsNotFiniteByName) {
  Bob b;
  Simulator simulator(b.world);
  const double huge = std::numeric_limits<double>::max();
  simulator.apply_force(b.bob, {Vec3::Zero(), Vec3(huge, 0, 0)});
  for (const std::string& text :
       {refusal([&] {
          simulator.apply_force(b.bob, {Vec3(0, kNaN, 0), Vec3::Zero()});
        }),
        refusal([&] {
          simulator.apply_force(b.bob, {Vec3::Zero(), Vec3(0, 0, 1 / 0.0)});
        }),
        refusal([&] { simulator.apply_force(b.bob, Vec3(kNaN, 0, 0), Vec3::UnitX()); }),
        refusal([&] { simulator.apply_force(b.bob, Vec3::Zero(), Vec3(kNaN, 0, 0)); }), refusal([&] {
          simulator.apply_force(b.bob, {Vec3::Zero(), Vec3(huge, 0, 0)});
        })})
    EXPECT_NE(text.find("bob"), std::string::npos) << text;
  EXPECT_NE(refusal([&] { simulator.apply_force({7}, {}); }), "");
  EXPECT_NE(refusal([&] { simulator.apply_force({7}, Vec3::Zero(), Vec3::Zero()); }), "");
}

TEST(ApplyForce, LeavesFixedBodiesWhereTheyAre) {
  Bob b;
  Simulator simulator(b.world);
  simulator.apply_force(kGround, {Vec3(1, 1, 1), Vec3(1, 1, 1)});
  ASSERT_TRUE(simulator.step(0.01).exact());
  EXPECT_EQ(b.world.pose(kGround).p, Vec3::Zero().eval());
  EXPECT_EQ(b.world.twist(b.bob).v, Vec3::Zero().eval());
}

/// The world holds it until its next step, also before there is a simulator, and a copy has it, too.
TEST(ApplyForce, OfTheWorldIsThatOfItsSimulator) {
  Bob one, two;
  apply_force(one.world, one.bob, {Vec3(1, 2, 3), Vec3(4, 0, 0)});
  apply_force(one.world, one.bob, Vec3(0.1, 0, 0), Vec3(0, 5, 0));
  World copy = one.world;
  Simulator first(one.world), second(two.world), of_copy(copy);
  second.apply_force(two.bob, {Vec3(1, 2, 3), Vec3(4, 0, 0)});
  second.apply_force(two.bob, Vec3(0.1, 0, 0), Vec3(0, 5, 0));
  for (int i = 0; i < 3; ++i) {
    for (Simulator* simulator : {&first, &second, &of_copy}) ASSERT_TRUE(simulator->step(0.01).exact());
    for (const World* world : std::initializer_list<const World*>{&two.world, &copy}) {
      EXPECT_EQ(one.world.twist(one.bob).v, world->twist(one.bob).v) << i;
      EXPECT_EQ(one.world.twist(one.bob).w, world->twist(one.bob).w) << i;
    }
    EXPECT_NEAR(one.world.twist(one.bob).v.x(), 0.02, 1e-14) << i;
  }
}

/// A simulator that is made anew for the same world finds it there.
TEST(ApplyForce, OutlivesTheSimulatorThatWasTold) {
  Bob b;
  Simulator(b.world).apply_force(b.bob, {Vec3::Zero(), Vec3(4, 0, 0)});
  Simulator next(b.world);
  ASSERT_TRUE(next.step(0.01).exact());
  EXPECT_NEAR(b.world.twist(b.bob).v.x(), 0.02, 1e-14);
}

/// A law that asks for one inside a step is refused, and nothing is left.
TEST(ApplyForce, IsRefusedInsideAStep) {
  struct Meddler final : Force {
    World* world = nullptr;
    void accumulate(const State&, std::span<Wrench>) const override {
      apply_force(*world, BodyId{1}, Wrench{Vec3::Zero(), Vec3(1, 0, 0)});
    }
  };
  Bob b;
  auto law = std::make_shared<Meddler>();
  law->world = &b.world;
  b.world.add_force(std::shared_ptr<const Force>(law));
  Simulator simulator(b.world);
  EXPECT_THROW((void)simulator.step(0.01), std::logic_error);
}

}  // namespace
}  // namespace taut::apply_force_test
