#include "scenes/program/live_controls.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "scenes/files/scene_file.h"

// What messages of browsers do to a run, without a server.
namespace taut::live_controls_test {
namespace {

const char* const kScene = R"({"format": "taut-scene/1", "dt": 0.002, "gravity": [0, 0, 0], "bodies": [
  {"name": "arm", "density": 1000, "shape": {"type": "box", "size": [0.4, 0.1, 0.1]}},
  {"name": "crank", "density": 1000, "shape": {"type": "box", "size": [0.4, 0.1, 0.1]}, "position": [1, 0, 0]}],
 "joints": [
  {"name": "elbow", "type": "hinge", "a": "ground", "b": "arm", "anchor": [0, 0, 0], "axis": [0, 1, 0],
   "axes": {"angle": {"motor": {"position": 0.25}, "limits": {"lower": -1, "upper": 2}}}},
  {"name": "knee", "type": "hinge", "a": "ground", "b": "crank", "anchor": [1, 0, 0], "axis": [0, 1, 0],
   "axes": {"angle": {"motor": {"trajectory": {"linear": {"value": 0, "rate": 0.5}}}}}}]})";

struct LiveControlsTest : ::testing::Test {
  Scene scene = parse_scene(kScene, "live.json");
  Simulator simulator{scene.world, scene.settings};
  LiveControls controls{scene.world, simulator, true};
  AxisId elbow = scene.world.axis(scene.world.joint("elbow"), "angle");
  AxisId knee = scene.world.axis(scene.world.joint("knee"), "angle");

  void run(double time) {
    for (const double end = scene.world.time() + time; scene.world.time() < end - 1e-9;) {
      controls.begin_step(scene.dt);
      ASSERT_TRUE(simulator.step(scene.dt).exact()) << simulator.report().message;
      controls.end_step();
    }
  }
  double value(AxisId axis) const { return scene.world.axis_value(axis); }
  double rate(AxisId axis) const { return scene.world.axis_rate(axis); }
};

TEST_F(LiveControlsTest, AMotorWithoutBoundGoesToItsTargetNoFasterThanThroughItsSliderInASecond) {
  run(0.1);
  ASSERT_NEAR(value(elbow), 0.25, 1e-9);
  controls.obey(1, R"({"do": "motor", "motor": 0, "target": 1.75})");
  EXPECT_TRUE(controls.take_news().state);
  run(0.2);
  EXPECT_NEAR(rate(elbow), 3, 1e-9);  // from -1 to 2 in 1 s
  run(0.4);
  EXPECT_NEAR(value(elbow), 1.75, 1e-9);
}

TEST_F(LiveControlsTest, ATrajectoryIsLeftForATargetAndTakenUpAgain) {
  run(0.2);
  EXPECT_NEAR(value(knee), 0.1, 1e-9);
  EXPECT_NEAR(controls.state()["targets"][1], 0.1, 1e-12);
  EXPECT_EQ(controls.state()["follows"], (nlohmann::json{false, true}));
  EXPECT_EQ(controls.motors()[1]["has_trajectory"], true);
  EXPECT_EQ(controls.motors()[1]["unit"], "rad");
  controls.obey(1, R"({"do": "motor", "motor": 1, "target": -1})");
  EXPECT_EQ(controls.state()["follows"], (nlohmann::json{false, false}));
  run(0.5);
  EXPECT_NEAR(value(knee), -1, 1e-9);
  controls.obey(1, R"({"do": "follow", "motor": 1})");
  run(0.5);
  EXPECT_NEAR(value(knee), 0.5 * scene.world.time(), 1e-9);
  EXPECT_NEAR(rate(knee), 0.5, 1e-6);  // a step behind, it is what it was, without a bound of its speed
  EXPECT_EQ(scene.world.axis_properties(knee).motor->max_speed, kUnlimited);
}

TEST_F(LiveControlsTest, BackAtTheStartMotorsAndStateAreWhatTheyWere) {
  const Pose start = scene.world.pose(scene.world.body("crank"));
  run(0.1);
  controls.obey(1, R"({"do": "motor", "motor": 1, "target": 1})");
  controls.obey(2, R"({"do": "pull", "body": 1, "point": [0.2, 0, 0], "to": [0, 0, 1], "strength": 10})");
  run(0.1);
  controls.obey(1, R"({"do": "reset"})");
  EXPECT_EQ(scene.world.time(), 0);
  EXPECT_EQ(scene.world.pose(scene.world.body("crank")).q.coeffs(), start.q.coeffs());
  EXPECT_EQ(controls.state()["follows"], (nlohmann::json{false, true}));
  EXPECT_EQ(controls.state()["steps"], 0);
  EXPECT_EQ(controls.state()["resets"], 1);
  run(0.2);
  EXPECT_NEAR(value(knee), 0.1, 1e-9);
  EXPECT_NEAR(value(elbow), 0.25, 1e-9);  // not pulled any more
}

TEST_F(LiveControlsTest, PausedItTakesAsManyStepsAsWereAskedFor) {
  controls.obey(1, R"({"do": "step"})");
  EXPECT_TRUE(controls.is_paused() && !controls.is_waiting());
  controls.obey(1, R"({"do": "step"})");
  for (int i = 0; i < 2; ++i) {
    ASSERT_FALSE(controls.is_waiting());
    controls.begin_step(scene.dt);
  }
  EXPECT_TRUE(controls.is_waiting());
  controls.obey(1, R"({"do": "play"})");
  EXPECT_FALSE(controls.is_paused() || controls.is_waiting());
}

TEST_F(LiveControlsTest, WhatIsNoMessageIsRefusedAndChangesNothing) {
  const nlohmann::json before = controls.state();
  for (const char* text :
       {"", "{", "null", "[]", "\"pause\"", R"({"do": 1})", R"({"do": "fly"})", R"({"do": "follow"})",
        R"({"do": "follow", "motor": 0})", R"({"do": "follow", "motor": 2})",
        R"({"do": "motor", "motor": 1, "target": 1e300})", R"({"do": "motor", "motor": 1, "target": null})",
        R"({"do": "speed", "value": 0})", R"({"do": "speed", "value": 1e4})",
        R"({"do": "pull", "body": 0, "point": [0, 0, 0], "to": [0, 0, 0], "strength": 1})",
        R"({"do": "pull", "body": 1, "point": [0, 0], "to": [0, 0, 0], "strength": 1})"})
    EXPECT_THROW(controls.obey(1, text), std::exception) << text;
  EXPECT_EQ(controls.state(), before);
  EXPECT_FALSE(controls.take_news().state);
  LiveControls without(scene.world, simulator, false);
  EXPECT_THROW(without.obey(1, R"({"do": "reset"})"), std::invalid_argument);
}

}  // namespace
}  // namespace taut::live_controls_test
