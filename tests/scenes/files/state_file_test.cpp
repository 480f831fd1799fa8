#include "scenes/files/state_file.h"

#include <gtest/gtest.h>

#include <sstream>

#include "core/state/same_state.h"
#include "scenes/builders/scene.h"
#include "scenes/files/scene_file.h"
#include "scenes/files/state_json.h"
#include "scenes/program/run_record.h"
#include "solvers/simulator/simulator.h"
#include "tests/run_program.h"
#include "tests/temporary.h"

namespace taut::testing::state_file_test {
namespace {

using Json = nlohmann::json;

/// The state of a scene after some steps.
World moved(Scene scene, int steps) {
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < steps; ++i) EXPECT_TRUE(simulator.step(scene.dt).exact());
  return scene.world;
}

std::string problems_of(const std::string& text) {
  Scene scene = build_scene("ragdoll");
  const State before = scene.world.state();
  try {
    apply_state(scene.world, text, "state.json");
  } catch (const SceneFileError& error) {
    EXPECT_EQ(fingerprint(scene.world.state()), fingerprint(before)) << "a part was taken over";
    return error.what();
  }
  return "";
}

TEST(StateFile, IsReadBackBitForBit) {
  for (const char* name : {"ragdoll", "car", "robot-arm", "bridge-hinge", "pile"}) {
    const World world = moved(build_scene(name, {}), 5);
    World other = build_scene(name, {}).world;
    ASSERT_NE(fingerprint(world.state()), fingerprint(other.state()));
    apply_state(other, state_json(world).dump(), "state.json");
    EXPECT_EQ(fingerprint(world.state()), fingerprint(other.state())) << name;
    for (int joint = 0; joint < world.joint_count(); ++joint) {
      if (!world.has_axis_properties(JointId{joint})) continue;
      for (int axis = 0; axis < world.axis_count(JointId{joint}); ++axis)
        EXPECT_EQ(world.axis_value({JointId{joint}, axis}), other.axis_value({JointId{joint}, axis})) << name;
    }
  }
}

TEST(StateFile, KeepsWhatIsDetached) {
  Scene scene = build_scene("n-four-bar");
  const JointId joint{0};
  scene.world.detach(joint);
  World other = build_scene("n-four-bar").world;
  apply_state(other, state_json(scene.world).dump(), "state.json");
  EXPECT_FALSE(other.is_attached(joint));
  EXPECT_EQ(other.detached_count(), scene.world.detached_count());
}

TEST(StateFile, NamesAllThatIsWrong) {
  const std::string body = R"("position": [0, 0, 1], "orientation": [1, 0, 0, 0],
                              "velocity": [0, 0, 0], "angular_velocity": [0, 0, 0]})";
  const std::string text = R"({"format": "taut-state/2", "time": "now", "bodies": [
    {"name": "nobody", )" + body +
                           R"(, {"name": "ground", )" + body + R"(, {"name": "head", )" + body +
                           R"(, {"name": "head", )" + body + R"(,
    {"name": "pelvis", "position": [0, 0], "orientation": [1, 1, 0, 0], "velocity": [0, 0, 0], "tint": 1}],
    "axes": [{"joint": "neck", "axis": "sideways", "value": 0}, {"joint": "gill", "axis": "angle", "value": 0}],
    "detached": ["gill"], "more": 1, "contacts": [
    {"a": {"body": "head", "shape": 7}, "b": {"body": "gill", "shape": 0}, "point": [0, 0, 0], "stretch": [0, 0, 0]},
    {"a": {"body": "head", "shape": 0.5}, "b": {"body": "neck"}, "point": [0, 0], "holds": 1}]})";
  const std::string problems = problems_of(text);
  for (const char* expected : {"/format: must be \"taut-state/1\"",
                               "/time: ",
                               "/bodies/0/name: there is no body",
                               "/bodies/1/name: is fixed",
                               "/bodies/3/name: is given twice",
                               "/bodies/4/position: ",
                               "/bodies/4/orientation: ",
                               "/bodies/4/tint: ",
                               "/bodies/4: ",
                               "/axes/0/axis: ",
                               "/axes/1/joint: there is no joint",
                               "/detached/0: there is no joint",
                               "/more: ",
                               "/contacts/0/a/shape: must be the place of a shape among the ",
                               "/contacts/0/b/body: there is no body",
                               "/contacts/1/a/shape: ",
                               "/contacts/1/b: ",
                               "/contacts/1/point: ",
                               "/contacts/1: ",
                               "/contacts/1/holds: "})
    EXPECT_NE(problems.find(expected), std::string::npos) << expected << "\n" << problems;
  EXPECT_NE(problems_of("{").find("state.json:1:2: "), std::string::npos);
  EXPECT_NE(problems_of("[]").find("/"), std::string::npos);
}

TEST(StateFile, WhatIsRefusedForItsStrangenessChangesNothing) {
  World world = build_scene("n-four-bar").world;
  nlohmann::ordered_json state = state_json(world);
  state["time"] = 7.0;
  state["bodies"][0]["orientation"] = {1, 0, 0, 9};  // a warning in a scene
  state["detached"] = {world.name(JointId{0})};
  const State before = world.state();
  EXPECT_THROW(apply_state(world, state.dump(), "state.json"), SceneFileError);
  EXPECT_TRUE(same(world.state(), before));
  EXPECT_TRUE(world.is_attached(JointId{0}));
}

/// A heap at rest is at rest in the run that goes on, and its state is the one that was read.
TEST(StateFile, AHeapGoesOnStanding) {
  const std::string state = temporary("state.json"), report = temporary("report.json");
  const std::vector<std::string> pile{"run",      "pile", "--set",  "n=12", "--quiet",
                                      "--report", report, "--save", state};
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = pile;
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_status, 0) << outcome.err;
    World world = build_scene("pile", {{"n", 12}}).world;
    const std::string text = read_text(state);
    const SavedMemory memory = apply_state(world, text, state);
    EXPECT_GT(memory.stretches.size(), 20u);
    EXPECT_EQ(state_json(world, memory), nlohmann::ordered_json::parse(text));
    double fastest = 0;
    for (int b = 1; b < world.body_count(); ++b) fastest = std::max(fastest, world.twist(BodyId{b}).v.norm());
    return fastest;
  };
  EXPECT_LT(run({"--time", "4"}), 1e-9);
  EXPECT_LT(run({"--steps", "1", "--from", state}), 1e-9);  // 6e-6 if nothing is known of its contacts
}

/// Half a run and the rest of it from the saved state are the whole run, but for what solvers start from.
TEST(StateFile, ARunGoesOnWhereAnotherEnded) {
  const std::string state = temporary("state.json"), first = temporary("a"), second = temporary("b");
  const std::vector<std::string> scene{"run", "chain", "--set", "n=20", "--dt", "0.005", "--quiet", "--csv"};
  const auto run = [&](const std::string& csv, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = scene;
    arguments.push_back(csv);
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_status, 0) << outcome.err;
    const std::string text = read_text(csv);
    return text.substr(text.rfind('\n', text.size() - 2) + 1);  // the last instant
  };
  run(first, {"--time", "0.25", "--save", state});
  const std::string resumed = run(first, {"--time", "0.25", "--from", state}),
                    whole = run(second, {"--time", "0.5"});
  std::istringstream a(resumed), b(whole);
  for (std::string x, y; std::getline(a, x, ',') && std::getline(b, y, ',');)
    EXPECT_NEAR(std::stod(x), std::stod(y), 1e-7) << resumed << whole;
  EXPECT_NEAR(Json::parse(read_text(state))["time"].get<double>(), 0.25, 1e-12);
}

TEST(StateFile, AStateThatDoesNotFitIsRefused) {
  const std::string state = temporary("state.json");
  EXPECT_EQ(
      run_program({"run", "chain", "--set", "n=3", "--steps", "1", "--quiet", "--save", state}).exit_status,
      0);
  const Outcome refused = run_program({"run", "pendulum-ball", "--from", state, "--quiet"});
  EXPECT_EQ(refused.exit_status, 2);
  EXPECT_NE(refused.err.find(": /bodies/2/name: "), std::string::npos) << refused.err;
  EXPECT_EQ(run_program({"run", "pendulum-ball", "--from", "/nowhere/at.json"}).exit_status, 2);
  EXPECT_EQ(run_program({"run", "pendulum-ball", "--save", "/nowhere/at.json"}).exit_status, 2);
}

}  // namespace
}  // namespace taut::testing::state_file_test
