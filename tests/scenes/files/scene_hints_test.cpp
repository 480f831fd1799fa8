#include <gtest/gtest.h>

#include <filesystem>

#include "scenes/files/scene_file.h"
#include "scenes/import/import.h"
#include "tests/source_dir.h"

/// What a scene file may say, and its author probably did not mean.
namespace taut::scene_hints_test {
namespace {

std::vector<std::string> warnings_of(const std::string& members) {
  return parse_scene(R"({"format": "taut-scene/1", )" + members + "}", "a.json").warnings;
}

void expect_only(const std::string& members, const std::string& warning) {
  const std::vector<std::string> found = warnings_of(members);
  if (warning.empty()) {
    EXPECT_TRUE(found.empty()) << members << "\n" << found.front();
    return;
  }
  ASSERT_EQ(found.size(), 1U) << members;
  EXPECT_NE(found[0].find(warning), std::string::npos) << found[0];
  EXPECT_TRUE(found[0].starts_with("a.json:")) << found[0];
}

std::string joint_with(const std::string& type, const std::string& axes) {
  return R"("bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}], "joints": [{"name": "knee", "type": ")" +
         type + R"(", "a": "ground", "b": "b", "anchor": [0, 0, 0], "axis": [0, 0, 1], "axes": )" + axes +
         "}]";
}

TEST(SceneHints, LimitsOfManyTurnsLookLikeDegrees) {
  const std::string at = "/joints/0/axes/angle/limits";
  expect_only(joint_with("hinge", R"({"angle": {"limits": {"lower": -90, "upper": 1.5}}})"),
              at + "/lower of \"knee\": is 14.3 turns, since it is in radians; if degrees are meant, write "
                   "\"lower_deg\" (value: -90)");
  expect_only(joint_with("hinge", R"({"angle": {"limits": {"upper": 45}}})"),
              at + "/upper of \"knee\": is 7.16 turns");
  expect_only(joint_with("hinge", R"({"angle": {"spring": {"stiffness": 1, "rest": 30}}})"),
              "write \"rest_deg\"");
  expect_only(joint_with("hinge", R"({"angle": {"limits": {"lower_deg": -90, "upper_deg": 900}}})"), "");
  expect_only(joint_with("hinge", R"({"angle": {"limits": {"lower": -6.3, "upper": 12.5}}})"), "");
  expect_only(joint_with("cylindrical", R"({"displacement": {"limits": {"upper": 45}}})"), "");
  EXPECT_TRUE(
      warnings_of(R"("bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}], "joints": [{"type": "screw",
    "a": "ground", "b": "b", "anchor": [0, 0, 0], "axis": [0, 0, 1], "pitch": 0.01,
    "axes": {"angle": {"limits": {"upper": 45}}}}])")
          .empty());  // a screw is there to be turned
}

TEST(SceneHints, CablesWithoutSlack) {
  const auto cable = [](const std::string& keys) {
    return R"("cables": [{"name": "line", "a": "ground", "radius": 0.01, "mass": 1, "from": [0, 0, 0], )" +
           keys + "}]";
  };
  expect_only(
      cable(R"("to": [2, 0, 1], "links": 10, "b": "ground")"),
      "/cables/0 of \"line\": has no slack between its ends, so that no tension can carry its weight; "
      "give \"length\" more than 2.23607");
  expect_only(cable(R"("to": [2, 0, 0], "links": 10, "b": "ground", "length": 2)"), "/cables/0/length of");
  expect_only(cable(R"("to": [2, 0, 0], "links": 10, "b": "ground", "length": 2.0002)"), "");
  expect_only(cable(R"("to": [2, 0, 0], "links": 10)"), "");
  expect_only(cable(R"("to": [2, 0, 0], "links": 1, "b": "ground")"), "");
  expect_only(cable(R"("to": [0, 0, -2], "links": 10, "b": "ground")"), "");
}

TEST(SceneHints, QuaternionsWithWAtTheEnd) {
  const auto body = [](const std::string& q) {
    return R"("bodies": [{"name": "arm", "mass": 1, "inertia": [1, 1, 1], "orientation": )" + q + "}]";
  };
  expect_only(body("[0, 0, 0, 1]"),
              "/bodies/0/orientation of \"arm\": turns by 180 degrees, as quaternions are w, x, y, z here; "
              "if x, y, z, w is meant, write [1,0,0,0], and else an axis");
  expect_only(body("[0, 0, 0.7071, 0.7071]"), "write [0.7071,0,0,0.7071]");
  expect_only(body("[0, 0, 0.3826834, 0.9238795]"), "write [0.9238795,0,0,0.3826834]");
  expect_only(body("[0.05, 0, 0, 0.99875]"), "write [0.99875,0.05,0,0]");
  expect_only(body("[0.3, 0.2, 0.1, 0.9273618]"), "turns by 145 degrees");
  expect_only(body("[0.35, 0.5, 0.5, 0.61441029]"), "write [0.61441029,0.35,0.5,0.5]");
  expect_only(body("[0.5, 0.5, 0.5, 0.5]"), "");
  expect_only(body("[0.3, 0.2, 0.9273618, 0.1]"), "");
  expect_only(body("[0.45, 0.2, 0.2, 0.8470537]"), "");
  expect_only(body("[1, 0, 0, 0]"), "");
  expect_only(body("[0.70710678, 0, 0, 0.70710678]"), "");
  expect_only(body("[0, 1, 0, 0]"), "");
  expect_only(body(R"({"axis": [0, 0, 1], "angle_deg": 180})"), "");
}

/// A file that has w in front elsewhere has it in front.
TEST(SceneHints, QuaternionsBesideOthersWithWInFront) {
  const auto bodies = [](const std::string& p, const std::string& q) {
    return R"("bodies": [{"mass": 1, "inertia": [1, 1, 1], "orientation": )" + p +
           R"(}, {"mass": 1, "inertia": [1, 1, 1], "orientation": )" + q + "}]";
  };
  EXPECT_EQ(warnings_of(bodies("[0, 0, 0, 1]", "[0, 0.1, 0, 0.99499]")).size(), 2U);
  EXPECT_EQ(warnings_of(bodies("[0, 0, 0, 1]", "[0.99499, 0, 0.1, 0]")).size(), 0U);
}

std::string two_rods(const std::string& joint) {
  return R"("assemble": true, "bodies": [
    {"name": "upper", "density": 100, "shape": {"type": "rod", "length": 1, "radius": 0.05}, "shapes": [],
     "position": [5.5, 0, 0]},
    {"name": "lower", "density": 100, "shapes": [{"type": "capsule", "length": 1, "radius": 0.05}],
     "position": [6, 0, -0.5]}, {"name": "weightless", "mass": 1, "inertia": [1, 1, 1]}],
    "joints": [{"name": "elbow", "type": "ball", )" +
         joint + "}]";
}

TEST(SceneHints, AnchorsFarOutsideBothBodies) {
  expect_only(two_rods(R"("a": "upper", "b": "lower", "anchor": [6, 0, 0])"), "");
  expect_only(two_rods(R"("a": "upper", "b": "lower", "anchor": [6.5, 0, 0.5])"), "");  // not by much
  expect_only(two_rods(R"("a": "upper", "b": "lower", "anchor": [0.5, 0, 0])"),
              "/joints/0 of \"elbow\": has its anchor 4.5 m outside \"upper\" and 4.97 m outside \"lower\"; "
              "points are "
              "in the world, unless \"frame\" is \"body\"");
  expect_only(
      two_rods(
          R"("a": "upper", "b": "lower", "frame": "body", "anchor_a": [0.5, 0, 0], "anchor_b": [0, 0, 0.5])"),
      "");
  expect_only(
      two_rods(
          R"("a": "upper", "b": "lower", "frame": "body", "anchor_a": [6, 0, 0], "anchor_b": [6, 0, 0])"),
      "has its anchor");
  // The ground, and what has no shape, reach as far as they like; what they hold does not.
  expect_only(two_rods(R"("a": "ground", "b": "lower", "anchor": [0.5, 0, 0])"),
              "has its anchor 4.97 m outside \"lower\"; points are");
  expect_only(two_rods(R"("a": "weightless", "b": "lower", "anchor": [0.5, 0, 0])"),
              "has its anchor 4.97 m outside \"lower\"; points are");
  expect_only(two_rods(R"("a": "ground", "b": "weightless", "anchor": [0.5, 0, 0])"), "");
}

std::string hinged_cubes(const std::string& members, const std::string& joint) {
  return R"("assemble": true, )" + members + R"("bodies": [
    {"name": "left", "mass": 1, "shapes": [{"type": "box", "size": [1, 1, 1]}]},
    {"name": "right", "mass": 1, "shapes": [{"type": "box", "size": [1, 1, 1]}], "position": [1, 0, 0]},
    {"name": "bob", "mass": 1, "shapes": [{"type": "sphere", "radius": 0.1}], "position": [3, 0, 0]}],
    "joints": [{"name": "pin", "type": "hinge", "axis": [0, 1, 0], )" +
         joint + "}]";
}

TEST(SceneHints, AnchorsFarOutsideTheOneBodyWithShapes) {
  const std::string grounds[] = {"", R"("ground": {"shapes": [{"type": "half_space"}]}, )"};
  for (const std::string& ground : grounds) {
    expect_only(hinged_cubes(ground, R"("a": "ground", "b": "left", "anchor": [9, 0, 0])"),
                "/joints/0 of \"pin\": has its anchor 8.13 m outside \"left\"; points are");
    expect_only(hinged_cubes(ground, R"("a": "ground", "b": "left", "anchor": [0.5, 0, 0.5])"), "");
    expect_only(hinged_cubes(ground, R"("a": "ground", "b": "left", "anchor": [0, 0, 1.5])"), "");
    // The rod of a pendulum's bob has no mass and is not drawn.
    expect_only(hinged_cubes(ground, R"("a": "ground", "b": "bob", "anchor": [3, 0, 5])"), "");
  }
  // Two metres above the faces of both.
  expect_only(hinged_cubes("", R"("a": "left", "b": "right", "anchor": [0.5, 0, 2.5])"),
              "has its anchor 1.68 m outside \"left\" and 1.68 m outside \"right\"");
  expect_only(hinged_cubes("", R"("a": "left", "b": "right", "anchor": [0.5, 0, 1])"), "");
  expect_only(hinged_cubes("", R"("a": "left", "b": "bob", "anchor": [0, 0, 4])"),
              "has its anchor 3.13 m outside \"left\" and 4.9 m outside \"bob\"");
}

std::string beside_a_ball(const std::string& body, const std::string& members = "") {
  return members + R"("bodies": [{"name": "arm", "mass": 1, )" + body + R"(},
    {"name": "ball", "mass": 1, "shapes": [{"type": "sphere", "radius": 0.1}], "position": [3, 0, 0]}])";
}

TEST(SceneHints, AShapeForTheMassAloneWhereOthersCollide) {
  const std::string shape = R"("shape": {"type": "box", "size": [1, 1, 1]})";
  expect_only(beside_a_ball(shape),
              "/bodies/0 of \"arm\": has a shape for its mass alone and touches nothing: \"shapes\" collide, "
              "and \"shapes\": [] says that it is meant");
  expect_only(beside_a_ball(shape + R"(}, {"mass": 1, "position": [0, 0, 5], )" + shape),
              "; 1 more body does so");
  expect_only(beside_a_ball(shape + R"(, "shapes": [])"), "");
  expect_only(beside_a_ball(shape + R"(, "fixed": true)"), "");
  expect_only(beside_a_ball(shape, R"("settings": {"contacts": false}, )"), "");
  expect_only(beside_a_ball(R"("inertia": [1, 1, 1])"), "");
  expect_only(beside_a_ball(R"("shapes": [{"type": "box", "size": [1, 1, 1]}])"), "");
  expect_only(R"("bodies": [{"mass": 1, )" + shape + "}]", "");  // nothing collides
  expect_only(R"("ground": {"shapes": [{"type": "half_space"}]}, "bodies": [{"mass": 1, )" + shape + "}]",
              "touches nothing");
}

TEST(SceneHints, NoneInTheExamples) {
  const std::filesystem::path folder = testing::source_dir() + "/scenes/examples";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".json") || name.ends_with(".schema.json")) continue;
    const std::vector<std::string> warnings = load_scene_file(entry.path()).warnings;
    EXPECT_TRUE(warnings.empty()) << warnings.front();
  }
}

/// What a program writes is no slip of the hand, and has no lines.
TEST(SceneHints, NoneOfWhatAProgramHasWritten) {
  const std::string text = R"({"format": "taut-scene/1", "bodies": [{"mass": 1, "inertia": [1, 1, 1],
    "orientation": [0, 0, 0, 1]}]})";
  EXPECT_EQ(parse_scene(text, "a.json").warnings.size(), 1U);
  EXPECT_TRUE(parse_scene(text, "a.json", false).warnings.empty());
}

}  // namespace
}  // namespace taut::scene_hints_test
