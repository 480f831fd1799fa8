#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "core/joints/joints.h"
#include "core/state/same_state.h"
#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"

// A step that is told to end early, and closing joints likewise, leave the world as it was.
namespace taut::robust_interrupt_test {
namespace {

/// Asked so many times, says yes from then on.
class Patience {
 public:
  void rule(Simulator& simulator, long most) {
    asked_ = 0;
    simulator.set_interrupt([this, most] { return ++asked_ > most; });
  }
  long asked() const { return asked_; }

 private:
  std::atomic<long> asked_{0};
};

/// Balls on a wheel that hangs by its hub: all rows are coupled, in one front of 3 (spokes + 1) rows.
World hub_of(int spokes, double gap = 0) {
  World world;
  const BodyId hub = world.add_body({.name = "hub", .mass = MassProperties::cylinder(5, 0.2, 1000)});
  world.add("hang", Ball::at(world, kGround, hub, Vec3(0, 0, 0.1)));
  for (int i = 0; i < spokes; ++i) {
    const double angle = 2 * M_PI * i / spokes;
    const Vec3 at(5 * std::cos(angle), 5 * std::sin(angle), -0.1);
    const BodyId ball =
        world.add_body({.mass = MassProperties::sphere(0.02, 1), .pose = {.p = at - Vec3(0, 0, 0.25)}});
    world.add("", Ball::at(world, hub, ball, at));
    world.set_pose(ball, {.p = at - Vec3(0, gap, 0.25)});
  }
  return world;
}

/// Interrupts a step everywhere it can be, then takes it.
void expect_unharmed_by_interrupts(World& world, const Settings& settings, double dt, World& undisturbed) {
  const State before = world.state();
  Simulator simulator(world, settings), calm(undisturbed, settings);
  Patience patience;
  long most = 0;
  for (patience.rule(simulator, most); !simulator.step(dt).ok(); patience.rule(simulator, most)) {
    ASSERT_EQ(simulator.report().status, Status::kInterrupted) << simulator.report().message;
    EXPECT_EQ(simulator.report().message, "interrupted");
    ASSERT_TRUE(same(world.state(), before)) << "after " << most << " questions";
    EXPECT_EQ(world.asleep_count(), 0);
    most = most < 50 ? most + 1 : most * 5 / 4;
  }
  EXPECT_GT(most, 2);
  ASSERT_TRUE(calm.step(dt).ok());
  EXPECT_TRUE(same(world.state(), undisturbed.state()));
}

TEST(RobustInterrupt, EndsAStepWithinItsFactorisation) {
  World world = hub_of(250), other = hub_of(250);
  Simulator simulator(world);
  Patience patience;
  patience.rule(simulator, 1'000'000);
  ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_GT(patience.asked(), 100);  // far more often than there are factorisations
  World again = hub_of(250);
  expect_unharmed_by_interrupts(again, {}, 1e-3, other);
}

TEST(RobustInterrupt, EndsAStepOfAnyIntegratorAndSolver) {
  for (const Integrator integrator :
       {Integrator::kRattle, Integrator::kRattle4, Integrator::kForceRungeKutta, Integrator::kMoreauJean}) {
    Settings settings;
    settings.integrator = integrator;
    World world = hub_of(5), other = hub_of(5);
    expect_unharmed_by_interrupts(world, settings, 0.05, other);
  }
  for (const Solver solver : {Solver::kGaussSeidel, Solver::kPairwise, Solver::kPropagation}) {
    Settings settings;
    settings.solver = solver;
    World world = hub_of(5), other = hub_of(5);
    expect_unharmed_by_interrupts(world, settings, 0.01, other);
  }
}

TEST(RobustInterrupt, EndsAStepWithContactsOnAllThreads) {
  for (const int threads : {1, 2}) {
    Scene scene = build_scene("pile", {{"n", 60}}), other = build_scene("pile", {{"n", 60}});
    for (Scene* one : {&scene, &other}) {  // until there are contacts
      Simulator simulator(one->world, one->settings);
      for (int i = 0; i < 60; ++i) ASSERT_TRUE(simulator.step(one->dt).ok());
    }
    scene.settings.threads = other.settings.threads = threads;
    expect_unharmed_by_interrupts(scene.world, scene.settings, scene.dt, other.world);
  }
}

TEST(RobustInterrupt, EndsClosingTheJoints) {
  World world = hub_of(6, 0.05);
  const State before = world.state();
  Simulator simulator(world);
  Patience patience;
  for (long most = 0; most < 3; ++most) {
    patience.rule(simulator, most);
    EXPECT_EQ(simulator.assemble().status, Status::kInterrupted);
    EXPECT_TRUE(same(world.state(), before));
  }
  simulator.set_interrupt({});
  EXPECT_TRUE(simulator.assemble().exact());
  EXPECT_LE(simulator.report().gap.metres, 1e-10);
}

/// Springs of compliant contacts are a part of the state.
TEST(RobustInterrupt, KeepsHowContactsAreStretched) {
  Scene scene = build_scene("pile", {{"n", 30}});
  Simulator simulator(scene.world, scene.settings);
  Patience patience;
  patience.rule(simulator, 1'000'000'000);
  for (int i = 0; i < 120; ++i) ASSERT_TRUE(simulator.step(scene.dt).ok());
  const std::vector<ContactStretch> before = simulator.contact_stretches();
  ASSERT_FALSE(before.empty());
  patience.rule(simulator, 3);
  ASSERT_EQ(simulator.step(scene.dt).status, Status::kInterrupted);
  const std::vector<ContactStretch> after = simulator.contact_stretches();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(after[i].stretch, before[i].stretch);
}

}  // namespace
}  // namespace taut::robust_interrupt_test
