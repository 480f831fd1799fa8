// Contacts whose laws cannot be met to 1e-8: what a step does then, and says.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "core/joints/joints.h"
#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/squeezed_boxes.h"
#include "tests/source_dir.h"

namespace taut::inexact_test {
namespace {

/// A pendulum of two rods that touch nothing, on a body.
void add_pendulum(World& world, BodyId last, const Vec3& at) {
  for (int i = 0; i < 2; ++i) {
    const BodyId rod =
        world.add_body({.mass = MassProperties::rod(1, 0.02, 1), .pose = {.p = at + Vec3(0.5 + i, 0, 0)}});
    world.add("", Ball::at(world, last, rod, at + Vec3(i, 0, 0)));
    last = rod;
  }
}

/// 80 bodies that have fallen between four walls and wedge each other.
Scene wedged_bodies() {
  Scene scene = build_scene("pile", {{"n", 80}, {"compliance", 0}, {"rolling", 0}});
  std::ifstream file(testing::source_dir() + "/tests/solvers/complementarity/hard_pile.txt");
  std::string head;
  std::getline(file, head);
  State state = scene.world.state();
  for (int b = 0; b < scene.world.body_count(); ++b) {
    Pose& pose = state.poses[b];
    Twist& twist = state.twists[b];
    for (int i = 0; i < 4; ++i) file >> pose.q.coeffs()[i];
    for (Vec3* v : {&pose.p, &twist.w, &twist.v})
      for (double& x : *v) file >> x;
  }
  EXPECT_TRUE(file.good());
  scene.world.set_state(state);
  add_pendulum(scene.world, kGround, Vec3(50, 0, 10));
  return scene;
}

Scene squeezed_boxes() {
  Scene scene;
  scene.settings.inexact_tolerance = 0.5;
  scene.dt = 1.0 / 240;
  testing::add_squeezed_boxes(scene.world);
  return scene;
}

/// That bodies wedge each other is no excuse.
TEST(Inexact, AWedgedHeapIsNot) {
  Scene scene = wedged_bodies();
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 4; ++i) {
    const StepReport& report = simulator.step(scene.dt);
    ASSERT_EQ(report.status, Status::kSuccess) << report.message;
    EXPECT_LE(report.complementarity_residual, 1e-8);
    EXPECT_LE(report.gap.metres, 1e-10);
    EXPECT_EQ(report.substeps, 1);
    EXPECT_LE(report.penetration, 1e-3);
  }
}

/// The step is done, says how far off its laws are, and obeys those that do not hang on them: no energy comes
/// from contacts, and bodies do not sink into each other.
TEST(Inexact, AStepGoesOnAndSaysHowFarOffItIs) {
  Scene scene = squeezed_boxes();
  Simulator simulator(scene.world, scene.settings);
  int inexact = 0;
  for (int i = 0; i < 4; ++i) {
    const StepReport& report = simulator.step(scene.dt);
    ASSERT_TRUE(report.ok()) << report.message;
    EXPECT_NEAR(scene.world.time(), (i + 1) * scene.dt, 1e-12);
    EXPECT_LE(report.gap.metres, 1e-9);
    EXPECT_LE(report.velocity_residual, 1e-8);
    if (report.exact()) {
      EXPECT_LE(report.complementarity_residual, 1e-8);
    } else {
      ++inexact;
      EXPECT_EQ(report.status, Status::kInexact);
      EXPECT_FALSE(report.message.empty());
      EXPECT_GT(report.complementarity_residual, 1e-8);
      EXPECT_LE(report.complementarity_residual, scene.settings.inexact_tolerance);
    }
    // What contacts are off by does work: 1e-4 of the largest impulse at the slip of its point, in 3 J.
    EXPECT_LE(report.ledger.contacts + report.ledger.friction, 1e-4);
    EXPECT_LE(report.penetration, 1e-3);
  }
  EXPECT_GT(inexact, 0);
}

/// Inexact or failed, it names contacts with the largest shares.
TEST(RobustMessages, ContactsThatMissTheirLawsMostAreNamed) {
  for (const bool fails : {false, true}) {
    Scene scene = squeezed_boxes();
    if (fails) scene.settings.inexact_tolerance = 0, scene.settings.max_substeps = 2;
    Simulator simulator(scene.world, scene.settings);
    StepReport report;
    for (int i = 0; i < 4 && report.exact(); ++i) report = simulator.step(scene.dt);
    ASSERT_EQ(report.ok(), !fails) << report.message;
    ASSERT_FALSE(report.culprits.empty());
    for (std::size_t i = 0; i < report.culprits.size(); ++i) {
      const Culprit& culprit = report.culprits[i];
      EXPECT_EQ(culprit.kind, Culprit::Kind::kContact);
      EXPECT_EQ(culprit.a, kGround);  // the wall
      EXPECT_GT(culprit.share, 0);    // of all that acts, which is more than their own island has
      EXPECT_NE(report.message.find(name_of(culprit, scene.world)), std::string::npos) << report.message;
      EXPECT_TRUE(i == 0 || culprit.share <= report.culprits[i - 1].share);
    }
    EXPECT_NE(report.message.find("a compliance of their material"), std::string::npos) << report.message;
  }
}

/// With no such tolerance the step fails, and the world stays.
TEST(Inexact, NothingInexactIsTakenIfItIsNotWanted) {
  Scene scene = squeezed_boxes();
  scene.settings.inexact_tolerance = 0;
  scene.settings.max_substeps = 2;  // or it takes long
  Simulator simulator(scene.world, scene.settings);
  const State before = scene.world.state();
  const StepReport& report = simulator.step(scene.dt);
  EXPECT_EQ(report.status, Status::kNotConverged);
  EXPECT_FALSE(report.ok());
  for (std::size_t b = 0; b < before.poses.size(); ++b)
    EXPECT_EQ(before.poses[b].p, scene.world.pose(BodyId{static_cast<int>(b)}).p);
}

}  // namespace
}  // namespace taut::inexact_test
