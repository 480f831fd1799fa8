// What solvers/simulator/FORCES.md says of forces.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"
#include "tests/source_dir.h"
#include "tests/temporary.h"

namespace taut::reading_forces_test {
namespace {

TEST(ReadingForces, TheCraneIsThatOfStatics) {
  const std::string page = testing::read_text(testing::source_dir() + "/solvers/simulator/FORCES.md"),
                    own = testing::read_text(testing::source_dir() +
                                             "/tests/solvers/simulator/reading_forces_test.cpp");
  const std::string begin = "```cpp\n", end = "```\n";
  const std::size_t from = page.find(begin) + begin.size();
  EXPECT_NE(own.find(page.substr(from, page.find(end, from) - from)), std::string::npos)
      << "the example of the page must be the one below, to the letter";

  World world;
  const BodyId jib =
      world.add_body({.mass = MassProperties::box({4, 0.2, 0.2}, 100), .pose = {.p = Vec3(2, 0, 0)}});
  const BodyId load =
      world.add_body({.mass = MassProperties::sphere(0.5, 500), .pose = {.p = Vec3(4, 0, -2)}});
  const JointId foot = world.add("foot", Hinge::at(world, kGround, jib, Vec3::Zero(), Vec3::UnitY()));
  const JointId tie = world.add("tie", Distance::between(world, kGround, jib, Vec3(0, 0, 3), Vec3(3, 0, 0)));
  world.add("hook", Ball::at(world, jib, load, Vec3(4, 0, 0)));
  Simulator simulator(world);
  if (!simulator.step(0.01).ok()) throw std::runtime_error(simulator.report().message);
  const Vec3 at_foot = simulator.reaction(foot).force;  // on the jib: (7194, 0, -1308) N
  const Vec3 of_tie = simulator.reaction(tie).force;    // on the jib: (-7194, 0, 7194) N

  world.detach(tie);  // a motor in the foot holds the jib instead
  world.set_motor({foot, 0}, AxisMotor{});
  if (!simulator.step(0.01).ok()) throw std::runtime_error(simulator.report().message);
  const double torque = simulator.axis_report({foot, 0}).force.motor;  // -21582 N·m

  const double moment = (100 * 2 + 500 * 4) * 9.81, part = moment / 3;
  EXPECT_NEAR(part, 7194, 0.5);
  EXPECT_NEAR((at_foot - Vec3(part, 0, 600 * 9.81 - part)).norm(), 0, 1e-6);  // of 1e4 N
  EXPECT_NEAR((of_tie - Vec3(-part, 0, part)).norm(), 0, 1e-6);
  EXPECT_NEAR(torque, -moment, 1e-5);
}

/// A pendulum of 1 m on its joint, released from the horizontal; what is asked after so many steps.
struct Swing {
  World world;
  BodyId bob;
  JointId joint;
  /// On a rod, or a hinge, which a motor may turn with 2 N·m.
  enum class On { kHinge, kMotor, kRod };
  explicit Swing(On on) {
    bob = world.add_body({.mass = MassProperties(1, Vec3(0.1, 0.1, 0.1)), .pose = {.p = Vec3(1, 0, 0)}});
    joint = on == On::kRod
                ? world.add("rod", Distance::between(world, kGround, bob, Vec3::Zero(), Vec3(1, 0, 0)))
                : world.add("pin", Hinge::at(world, kGround, bob, Vec3::Zero(), Vec3::UnitY()));
    if (on == On::kMotor) world.set_motor({joint, 0}, AxisMotor{.target = -10, .max_force = 2});
  }
};

constexpr double kTime = 0.4;  // of the end of the step that is asked about

/// Error of a force of the step of h before kTime against the exact mean, or end, by steps of h/256.
double error_of(Swing::On on, bool mean, double h) {
  Swing swing(on), fine(on);
  Simulator simulator(swing.world), reference(fine.world);
  const int steps = static_cast<int>(std::lround(kTime / h)), parts = 256;
  for (int i = 0; i < steps; ++i) EXPECT_TRUE(simulator.step(h).exact());
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < steps * parts; ++i) {
    EXPECT_TRUE(reference.step(h / parts).exact());
    if (i >= (steps - 1) * parts) sum += reference.mean_reaction(fine.joint).force / parts;
  }
  const Vec3 is = mean ? simulator.mean_reaction(swing.joint).force : simulator.reaction(swing.joint).force;
  return (is - (mean ? sum : reference.reaction(fine.joint).force)).norm();
}

/// Halving the step divides an error of order p by 2^p.  The mean of a rod's force has the rod's direction at
/// the end of the step, which is of order 1; that of a hinge has world axes.
TEST(ReadingForces, MeansAndInstantsAreOfTheirOrders) {
  using On = Swing::On;
  for (const On on : {On::kHinge, On::kMotor, On::kRod})
    for (const bool mean : {false, true}) {
      const double ratio = error_of(on, mean, 0.02) / error_of(on, mean, 0.01);
      EXPECT_NEAR(ratio, on == (mean ? On::kRod : On::kMotor) ? 2 : 4, 0.3) << static_cast<int>(on) << mean;
    }
}

TEST(ReadingForces, WithoutAStepMeansAreZero) {
  Swing swing(Swing::On::kHinge);
  bool trouble = false;
  swing.world.add_force(ForceCallback([&](const State&, std::span<Wrench> wrenches) {
    if (trouble) wrenches[1].force.x() = std::nan("");
  }));
  Simulator simulator(swing.world);
  EXPECT_EQ(simulator.mean_reaction(swing.joint).force, Vec3::Zero().eval());
  ASSERT_TRUE(simulator.step(0.01).exact());
  EXPECT_GT(simulator.mean_reaction(swing.joint).force.norm(), 0.1);
  ASSERT_TRUE(simulator.assemble().exact());
  EXPECT_EQ(simulator.mean_reaction(swing.joint).force, Vec3::Zero().eval());
  ASSERT_TRUE(simulator.step(0.01).exact());
  trouble = true;
  ASSERT_FALSE(simulator.step(0.01).ok());
  EXPECT_EQ(simulator.mean_reaction(swing.joint).force, Vec3::Zero().eval());
}

/// A door on two hinges: each bears half of its weight, and the report says that this is a choice.
TEST(ReadingForces, RedundantHingesShareAndAreNamed) {
  World world;
  const BodyId door =
      world.add_body({.mass = MassProperties::box({0.8, 0.04, 2}, 20), .pose = {.p = Vec3(0.4, 0, 1)}});
  const JointId low = world.add("low", Hinge::at(world, kGround, door, Vec3(0, 0, 0.2), Vec3::UnitZ()));
  const JointId high = world.add("high", Hinge::at(world, kGround, door, Vec3(0, 0, 1.8), Vec3::UnitZ()));
  Simulator simulator(world);
  const StepReport& report = simulator.step(0.01);
  ASSERT_TRUE(report.exact());
  EXPECT_EQ(report.dependent_rows.size(), 5u);
  EXPECT_EQ(simulator.analyze_rank().not_unique, (std::vector<JointId>{low, high}));
  const Reaction below = simulator.reaction(low), above = simulator.reaction(high);
  EXPECT_NEAR(below.force.z() + above.force.z(), 20 * 9.81, 1e-7);
  EXPECT_NEAR(below.force.z(), above.force.z(), 1e-6);
}

}  // namespace
}  // namespace taut::reading_forces_test
