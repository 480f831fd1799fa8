#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/joints/joints.h"
#include "scenes/builders/scene.h"
#include "scenes/files/scene_file.h"
#include "solvers/simulator/simulator.h"
#include "tests/source_dir.h"

// A step that fails names who has the largest share in it, and what may help.
namespace taut::robust_messages_test {
namespace {

BodyId add_box(World& world, const std::string& name, const Vec3& p, double mass = 1) {
  return world.add_body(
      {.name = name, .mass = MassProperties::box(Vec3(0.2, 0.1, 0.1), mass), .pose = {.p = p}});
}

/// The message has all of this, and there is one culprit.
void expect_blame(const StepReport& report, Status status, Culprit::Kind kind,
                  std::initializer_list<const char*> parts) {
  EXPECT_EQ(report.status, status) << report.message;
  for (const char* part : parts) EXPECT_NE(report.message.find(part), std::string::npos) << report.message;
  ASSERT_FALSE(report.culprits.empty()) << report.message;
  EXPECT_EQ(report.culprits[0].kind, kind);
}

TEST(RobustMessages, AJointWhoseGapIsNotFiniteIsNamed) {
  World world;
  const BodyId a = add_box(world, "a", Vec3::Zero()), b = add_box(world, "b", Vec3(1, 0, 0));
  world.add("sound", Ball::at(world, kGround, a, Vec3::Zero()));
  world.add("huge", Ball(a, b, Vec3(1e200, 0, 0), Vec3(-1e200, 0, 0)));
  Simulator simulator(world);
  const StepReport& report = simulator.step(0.01);
  expect_blame(report, Status::kNotFinite, Culprit::Kind::kJoint, {"not finite at the start: ball huge"});
  EXPECT_EQ(report.culprits[0].axis.joint, JointId{1});
}

TEST(RobustMessages, AForceLawThatGivesNoNumberIsNamed) {
  for (const Integrator integrator :
       {Integrator::kRattle, Integrator::kForceRungeKutta, Integrator::kMoreauJean}) {
    World world;
    const BodyId a = add_box(world, "a", Vec3::Zero());
    world.add_force(PointForce(a, Vec3::Zero(), Vec3(1, 0, 0)));
    world.add_force(ForceCallback(
        [](const State& state, std::span<Wrench> wrenches) {
          if (state.time > 0.011) wrenches[1].force.x() = std::nan("");
        },
        false));
    Simulator simulator(world, {.integrator = integrator});
    ASSERT_TRUE(simulator.step(0.01).exact());
    const StepReport& report = simulator.step(0.01);
    expect_blame(report, Status::kNotFinite, Culprit::Kind::kForce, {"what force law 1 gives is not finite"});
    EXPECT_EQ(report.culprits[0].force, ForceId{1});
  }
}

TEST(RobustMessages, ABodyThatDoesNotStayFiniteIsNamed) {
  for (const Integrator integrator :
       {Integrator::kRattle, Integrator::kForceEuler, Integrator::kMoreauJean}) {
    World world;
    add_box(world, "calm", Vec3::Zero());
    const BodyId bob = add_box(world, "bob", Vec3(1, 0, 0), 1e-6);
    world.add_force(PointForce(bob, Vec3::Zero(), Vec3(1e307, 0, 0)));
    Simulator simulator(world, {.integrator = integrator});
    const StepReport& report = simulator.step(0.01);
    expect_blame(report, Status::kNotFinite, Culprit::Kind::kBody, {"body bob does not stay finite"});
    EXPECT_EQ(report.culprits[0].a, bob);
  }
}

TEST(RobustMessages, ForcesThatDoNotSettleAreNamedByTheirBody) {
  World world;
  const BodyId light = add_box(world, "light", Vec3::Zero(), 1e-3);
  add_box(world, "calm", Vec3(1, 0, 0));
  world.add_force(ForceCallback(
      [light](const State& state, std::span<Wrench> wrenches) {
        wrenches[light.index].force -= 1e6 * state.twists[light.index].v;
      },
      true));
  world.set_twist(light, {Vec3::Zero(), Vec3(1, 0, 0)});
  Simulator simulator(world);
  const StepReport& report = simulator.step(0.01);
  expect_blame(report, Status::kNotConverged, Culprit::Kind::kBody,
               {"forces that depend on velocities do not settle", "body light", "less damping"});
}

/// Rods that whirl and a step that is far too long for it.
TEST(RobustMessages, PositionsThatAreNotClosedNameTheJoint) {
  World world;
  BodyId last = kGround;
  for (int i = 0; i < 4; ++i) {
    const BodyId rod =
        add_box(world, std::string("rod_").append(std::to_string(i)), Vec3(0.1 + 0.2 * i, 0, 0));
    world.add(std::string("j").append(std::to_string(i)), Ball::at(world, last, rod, Vec3(0.2 * i, 0, 0)));
    world.set_twist(rod, {Vec3(0, 0, i % 2 ? 40 : -40), Vec3::Zero()});
    last = rod;
  }
  Settings settings;
  settings.max_substeps = 1;
  Simulator simulator(world, settings);
  const StepReport& report = simulator.step(0.3);
  expect_blame(report, Status::kNotConverged, Culprit::Kind::kJoint,
               {"positions could not be closed", ": ball j", "stays open by", "a shorter step"});
}

/// Rates that large impulses leave beyond their tolerance, in positions that are closed.
TEST(RobustMessages, WhatIsLeftOfRatesNamesTheJoint) {
  Scene scene = load_scene_file(testing::source_dir() + "/tests/adversary/m626.json");
  Simulator simulator(scene.world, scene.settings);
  StepReport report;
  for (int i = 0; i < 20 && report.exact(); ++i) report = simulator.step(scene.dt);
  expect_blame(report, Status::kNotConverged, Culprit::Kind::kJoint,
               {"joints and laws could not be met together", "slider j1", "round-off of large impulses"});
}

/// The same along directions that dependent rows hold weakly, as halfway through a step: steps go on, and the
/// report says what is left of the rates at their end.
TEST(RobustMessages, WhatDependentRowsLeaveOfRatesIsReported) {
  Scene scene = load_scene_file(testing::source_dir() + "/tests/adversary/m624.json");
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 20; ++i) {
    const StepReport& report = simulator.step(scene.dt);
    ASSERT_TRUE(report.exact()) << report.message;
    EXPECT_LE(std::max(report.gap.metres, report.gap.radians), 1e-9);
    EXPECT_LE(report.velocity_residual, 1e-6);
  }
}

/// Each cell of a grid of rigid bodies on ball joints loses rank again and again as it swings across its
/// plane.
TEST(RobustMessages, RowsThatBecomeDependentAreNamedAndCompliancePassesThem) {
  Scene rigid = build_scene("joint-grid", {{"n", 6}, {"swing", 1}}), soft = rigid;
  Simulator simulator(rigid.world, rigid.settings);
  for (int i = 0; i < 2400 && simulator.report().ok(); ++i) simulator.step(rigid.dt);
  const StepReport& report = simulator.report();
  ASSERT_EQ(report.status, Status::kContradiction) << "it passes now: say so in robustness.md";
  EXPECT_LT(report.contradiction.residual, 1e-8);
  for (const char* part : {"ball ", "singular configuration", "1e-9 m/N"})
    EXPECT_NE(report.message.find(part), std::string::npos) << report.message;

  for (int j = 0; j < soft.world.joint_count(); ++j)
    soft.world.set_compliance({j}, JointCompliance{.translation = 1e-9});
  Simulator passes(soft.world, soft.settings);
  for (int i = 0; i < 2400; ++i) ASSERT_TRUE(passes.step(soft.dt).ok()) << i << passes.report().message;
}

}  // namespace
}  // namespace taut::robust_messages_test
