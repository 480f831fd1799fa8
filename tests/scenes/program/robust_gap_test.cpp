#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "scenes/files/scene_file.h"
#include "solvers/simulator/simulator.h"
#include "tests/source_dir.h"

// The gap of a report is that of all that should hold, whoever solves it.
namespace taut::robust_gap_test {
namespace {

Scene load(const std::string& name) {
  return load_scene_file(testing::source_dir() + "/tests/adversary/" + name);
}

/// How far ropes are too long, from the points alone.
double slackless_excess(const World& world) {
  double worst = 0;
  for (int j = 0; j < world.joint_count(); ++j) {
    const Joint& joint = world.joint(JointId{j});
    if (joint.type() != "rope") continue;
    const std::vector<WirePoint> points = joint.course();
    double length = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
      length += (world.pose(points[i].body).point(points[i].p_BP) -
                 world.pose(points[i - 1].body).point(points[i - 1].p_BP))
                    .norm();
    worst = std::max(worst, length - world.axis_properties({JointId{j}, 0}).limits->upper);
  }
  return worst;
}

TEST(RobustGap, MoreauJeanClosesRopes) {
  Scene scene = load("mj_rope_m200332.json");
  scene.settings.integrator = Integrator::kMoreauJean;
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 100; ++i) {
    const StepReport& report = simulator.step(0.01);
    ASSERT_TRUE(report.exact()) << i << ": " << report.message;
    EXPECT_LE(slackless_excess(scene.world), 1e-9) << i;
    EXPECT_LE(report.gap.metres, 1e-9) << i;
  }
}

/// What is not closed is said.
TEST(RobustGap, OfRopesThatNothingClosesIsReported) {
  Settings settings[2];
  settings[0].integrator = Integrator::kMoreauJean;
  settings[0].drift_cure = DriftCure::kNone;
  settings[1].solver = Solver::kGaussSeidel;
  settings[1].iterations = 2;
  for (const Settings& s : settings) {
    World world;
    const BodyId bob = world.add_body({.mass = MassProperties::sphere(0.1, 1), .pose = {.p = {1, 0, 0}}});
    const BodyId heavy = world.add_body({.mass = MassProperties::sphere(0.1, 50), .pose = {.p = {2, 0, 0}}});
    world.add("", Rope::between(world, kGround, bob, Vec3::Zero(), Vec3(1, 0, 0)));
    world.add("", Rope::between(world, bob, heavy, Vec3(1, 0, 0), Vec3(2, 0, 0)));
    Simulator simulator(world, s);
    double widest = 0;
    for (int i = 0; i < 60; ++i) {
      const StepReport& report = simulator.step(0.01);
      ASSERT_TRUE(report.ok()) << report.message;
      const double excess = slackless_excess(world);
      EXPECT_NEAR(report.gap.metres, std::max(excess, 0.0), 1e-12) << i;
      widest = std::max(widest, excess);
    }
    EXPECT_GT(widest, 1e-6);
  }
}

TEST(RobustGap, OfAnAngleBeyondItsLimitIsInRadians) {
  World world;
  const BodyId arm =
      world.add_body({.mass = MassProperties::box(Vec3(1, 0.1, 0.1), 1), .pose = {.p = {0.5, 0, 0}}});
  const AxisId angle{world.add("", Hinge::at(world, kGround, arm, Vec3::Zero(), Vec3::UnitY())), 0};
  world.set_limits(angle, AxisLimits{.lower = 0.25});
  Simulator simulator(world);
  const StepReport& report = simulator.step(1e-3);  // it comes back by 1 rad/s
  ASSERT_TRUE(report.exact()) << report.message;
  EXPECT_NEAR(report.gap.radians, 0.249, 1e-6);
}

TEST(RobustGap, WeldsWithArmsBeyondRoundOffAreNotMerged) {
  Scene scene = load("merged_gap_4e9m_arm.json");
  Simulator simulator(scene.world, scene.settings);
  EXPECT_TRUE(simulator.merged_joints().empty());
  const StepReport& report = simulator.step(0.01);
  EXPECT_EQ(report.status, Status::kNotConverged);
  EXPECT_NE(report.message.find("fixed j0 stays open by"), std::string::npos) << report.message;
  EXPECT_NE(report.message.find("; round-off at 4.29497e+09 m"), std::string::npos) << report.message;
}

/// Of two boxes that are welded and far away.
StepReport step_far_away(double distance) {
  World world;
  world.set_gravity(Vec3::Zero());
  BodyId boxes[2];
  for (int i = 0; i < 2; ++i)
    boxes[i] = world.add_body({.mass = MassProperties::box(Vec3(0.3, 0.2, 0.1), 1),
                               .pose = {.p = Vec3(distance, distance + 0.3 * i, 0)},
                               .twist = {Vec3(1, 2, 3), Vec3::Zero()}});
  world.add("seam", Fixed::at(world, boxes[0], boxes[1], Vec3(distance, distance + 0.1, 0)));
  Simulator simulator(world, {.merge_fixed_joints = true});
  return simulator.step(0.01);
}

TEST(RobustGap, OfMergedJointsIsThatOfTheBodiesThatTheUserGets) {
  const StepReport near = step_far_away(1);
  EXPECT_TRUE(near.exact()) << near.message;
  EXPECT_GT(near.gap.metres, 0);
  EXPECT_LE(near.gap.metres, 1e-14);
  const StepReport far = step_far_away(1e9);
  EXPECT_EQ(far.status, Status::kNotConverged);
  EXPECT_NE(far.message.find("fixed seam"), std::string::npos) << far.message;
}

}  // namespace
}  // namespace taut::robust_gap_test
