#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "core/joints/joints.h"
#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/squeezed_boxes.h"

// Many steps in one call.
namespace taut::run_until_test {
namespace {

Scene chain() { return build_scene("chain", {{"n", 3}}); }

TEST(RunUntil, EndsAtTheTime) {
  struct Case {
    double from, to, h;
    std::int64_t steps;
  };
  // Multiples of h in round-off, a shorter last step, one that would be tiny, one that is all, and over zero.
  for (const auto& [from, to, h, steps] :
       {Case{0, 1, 0.1, 10}, Case{0, 0.1 * 3, 0.1, 3}, Case{0, 1, 0.3, 4}, Case{0, 0.3 + 1e-9, 0.1, 3},
        Case{0.1, 0.3, 0.5, 1}, Case{-1, 1e-20, 0.25, 4}, Case{1e3, 1e3 + 1e-3, 1e-4, 10}}) {
    Scene scene = chain();
    scene.world.set_time(from);
    Simulator simulator(scene.world);
    const RunReport run = simulator.run_until(to, h);
    EXPECT_TRUE(run.exact()) << run.last.message;
    EXPECT_EQ(run.steps, steps) << to;
    EXPECT_EQ(scene.world.time(), to);
    EXPECT_EQ(run.last.time, to);
    EXPECT_LE(run.last.dt, h * (1 + 2e-6));
    EXPECT_GT(run.last.dt, h * 1e-6);
    EXPECT_GE(run.gap.metres, run.last.gap.metres);
    EXPECT_LE(run.gap.metres, 1e-9);
    EXPECT_EQ(simulator.run_until(to, h).steps, 0);
    EXPECT_TRUE(simulator.run_until(to, h).ok());
  }
}

/// Ten thousand intervals leave no more round-off than one.
TEST(RunUntil, TimeDoesNotDrift) {
  World world;
  (void)world.add_body({.mass = MassProperties(1, Vec3(1, 1, 1))});
  Simulator simulator(world);
  for (int k = 1; k <= 10000; ++k) {
    ASSERT_EQ(simulator.run_until(k * 0.1, 0.05).steps, 2);
    ASSERT_EQ(world.time(), k * 0.1);
  }
}

TEST(RunUntil, ItsStepsAreSingleOnes) {
  Scene one = chain(), other = chain();
  Simulator together(one.world), single(other.world);
  ASSERT_TRUE(together.run_until(0.25, 0.01).ok());
  for (int i = 0; i < 24; ++i) ASSERT_TRUE(single.step(0.01).ok());
  ASSERT_TRUE(single.step(0.25 - other.world.time()).ok());
  for (int b = 0; b < one.world.body_count(); ++b) {
    EXPECT_EQ(one.world.pose({b}).p, other.world.pose({b}).p);
    EXPECT_EQ(one.world.twist({b}).v, other.world.twist({b}).v);
  }
}

/// Laws that nothing meets.
TEST(RunUntil, GoesOnThroughInexactStepsAndCountsThem) {
  World world;
  testing::add_squeezed_boxes(world);
  Simulator simulator(world, {.inexact_tolerance = 0.5});
  const RunReport run = simulator.run_until(4.0 / 240, 1.0 / 240);
  EXPECT_TRUE(run.ok()) << run.last.message;
  EXPECT_FALSE(run.exact());
  EXPECT_EQ(run.steps, 4);
  EXPECT_GT(run.inexact_steps, 0);
  EXPECT_GT(run.natural_residual, 1e-8);
  EXPECT_GE(run.penetration, 2.9e-5);
}

TEST(RunUntil, EndsWithTheFirstStepThatFails) {
  Scene scene = chain();
  scene.world.add_force(ForceCallback([](const State& state, std::span<Wrench> wrenches) {
    if (state.time > 0.0451) wrenches[1].force.x() = std::numeric_limits<double>::quiet_NaN();
  }));
  Simulator simulator(scene.world);
  const RunReport run = simulator.run_until(0.1, 0.01);
  EXPECT_FALSE(run.ok());
  EXPECT_EQ(run.last.status, Status::kNotFinite);
  EXPECT_EQ(run.steps, 4);
  EXPECT_NEAR(scene.world.time(), 0.04, 1e-15);
}

TEST(RunUntil, EndsWhenItIsAskedTo) {
  Scene scene = chain();
  Simulator simulator(scene.world);
  simulator.set_interrupt([&] { return scene.world.time() > 0.0351; });
  const RunReport run = simulator.run_until(0.1, 0.01);
  EXPECT_EQ(run.last.status, Status::kInterrupted);
  EXPECT_EQ(run.steps, 4);
}

TEST(RunUntil, RefusesWhatIsNoInterval) {
  Scene scene = chain();
  scene.world.set_time(1);
  Simulator simulator(scene.world);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)simulator.run_until(0.5, 0.01), std::invalid_argument);
  EXPECT_THROW((void)simulator.run_until(nan, 0.01), std::invalid_argument);
  EXPECT_THROW((void)simulator.run_until(1 / 0.0, 0.01), std::invalid_argument);
  for (const double h : {0.0, -0.01, nan, 1 / 0.0, 1e-13})
    EXPECT_THROW((void)simulator.run_until(2, h), std::invalid_argument) << h;
  EXPECT_EQ(scene.world.time(), 1);
}

}  // namespace
}  // namespace taut::run_until_test
