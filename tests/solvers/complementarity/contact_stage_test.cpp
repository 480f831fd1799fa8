#include "solvers/complementarity/contact_stage.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "scenes/builders/scene.h"
#include "solvers/friction/friction_problem.h"
#include "solvers/simulator/simulator.h"

// Stages of a step as matrices: what the step has found must be a solution of them, which the measure of
// solvers/friction judges without anything of a step.
namespace taut::contact_stage_test {
namespace {

/// The largest error of what was found in all stages that were met, and how many there were.
struct Seen {
  int positions = 0, velocities = 0, contacts = 0, equalities = 0;
  double off = 0, off_alone = 0;

  void add(const ContactStage& stage) {
    ASSERT_EQ(stage.found.size(), stage.problem.rows());
    ASSERT_GT(stage.problem.contacts(), 0);
    if (!stage.met) return;
    ++(stage.kind == ContactStage::Kind::kPositions ? positions : velocities);
    contacts = std::max(contacts, stage.problem.contacts());
    equalities = std::max(equalities, stage.problem.equalities);
    off = std::max(off, friction_errors(stage.problem, stage.found).impulses);
    const FrictionProblem alone = stage.problem.without_equalities();
    off_alone =
        std::max(off_alone, friction_errors(alone, stage.found.tail(3 * stage.problem.contacts())).impulses);
  }
};

Seen seen_in(const std::string& name, const std::map<std::string, double>& parameters, int steps) {
  Scene scene = build_scene(name, parameters);
  Simulator simulator(scene.world, scene.settings);
  Seen seen;
  simulator.set_stage_watch([&](const ContactStage& stage) { seen.add(stage); });
  for (int i = 0; i < steps; ++i) EXPECT_TRUE(simulator.step(scene.dt).ok()) << name << ' ' << i;
  return seen;
}

class ContactStages : public ::testing::TestWithParam<std::tuple<const char*, double, int, bool>> {};

/// Laws count as met at 1e-8 of the largest impulse of all rows, and contacts alone may have smaller ones;
/// rolling friction and compliance are among these scenes.
TEST_P(ContactStages, AreSolvedByWhatTheStepHasFound) {
  const auto& [scene, n, steps, joints] = GetParam();
  const Seen seen = seen_in(scene, {{"n", n}}, steps);
  EXPECT_GT(seen.positions, 0);
  EXPECT_GT(seen.velocities, 0);
  EXPECT_GT(seen.contacts, 2);
  EXPECT_EQ(seen.equalities > 0, joints);
  EXPECT_LE(seen.off, 1e-6);
  EXPECT_LE(seen.off_alone, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ContactStages,
                         ::testing::Values(std::tuple{"stack", 4.0, 40, false},
                                           std::tuple{"wall", 2.0, 20, false},
                                           std::tuple{"pile", 6.0, 240, false},
                                           std::tuple{"card-house", 2.0, 20, false},
                                           std::tuple{"chain-over-cylinder", 10.0, 120, true},
                                           std::tuple{"net-catch", 6.0, 345, true}),
                         [](const auto& scene) {
                           std::string name = std::get<0>(scene.param);
                           std::erase(name, '-');
                           return name;
                         });

/// A sphere of 2 kg that rests: W is 1/m along the normal and 1/m + r²/I across, and it is told nothing once
/// there is no watch.
TEST(ContactStage, OfARestingSphereIsThatOfItsMass) {
  World world;
  world.add_shape(kGround, HalfSpace{});
  const BodyId ball =
      world.add_body({.mass = MassProperties::sphere(0.1, 2), .pose = {Quat::Identity(), Vec3(0, 0, 0.1)}});
  world.add_shape(ball, Sphere{0.1});
  world.set_gravity(Vec3(0, 0, -10));
  Simulator simulator(world);
  ContactStage last;
  int told = 0;
  simulator.set_stage_watch([&](const ContactStage& stage) { last = stage, ++told; });
  const double h = 1e-3;
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(simulator.step(h).exact());
  ASSERT_EQ(last.problem.contacts(), 1);
  EXPECT_EQ(last.problem.equalities, 0);
  EXPECT_EQ(last.kind, ContactStage::Kind::kVelocities);
  EXPECT_TRUE(last.met);
  const Eigen::Matrix3d W = Eigen::MatrixXd(last.problem.W);
  EXPECT_LE((W - Eigen::Vector3d(0.5, 0.5 * 3.5, 0.5 * 3.5).asDiagonal().toDenseMatrix()).norm(), 1e-12);
  EXPECT_NEAR(last.found[0], 2 * 10 * h, 1e-12);   // both kicks
  EXPECT_NEAR(last.problem.q[0], -10 * h, 1e-12);  // gravity of the step
  const int before = told;
  simulator.set_stage_watch({});
  ASSERT_TRUE(simulator.step(h).exact());
  EXPECT_EQ(told, before);
}

TEST(ContactStage, IsToldToTheSameWatchAfterRestore) {
  Scene scene = build_scene("stack", {{"n", 2}});
  Simulator simulator(scene.world, scene.settings);
  int told = 0;
  simulator.set_stage_watch([&](const ContactStage&) { ++told; });
  ASSERT_TRUE(simulator.step(scene.dt).exact());
  simulator.restore(simulator.checkpoint());
  told = 0;
  ASSERT_TRUE(simulator.step(scene.dt).exact());
  EXPECT_GT(told, 0);
}

TEST(ContactStage, LetsThroughWhatItsWatchThrows) {
  Scene scene = build_scene("stack", {{"n", 2}});
  Simulator simulator(scene.world, scene.settings);
  simulator.set_stage_watch([](const ContactStage&) { throw std::runtime_error("enough"); });
  EXPECT_THROW(simulator.step(scene.dt), std::runtime_error);
  EXPECT_EQ(scene.world.time(), 0);
  simulator.set_stage_watch({});
  EXPECT_TRUE(simulator.step(scene.dt).exact());
}

}  // namespace
}  // namespace taut::contact_stage_test
