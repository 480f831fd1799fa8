#include "scenes/files/synonyms.h"

#include <gtest/gtest.h>

#include "scenes/files/scene_file.h"

/// Names that other programs have for things of the format: said, and not accepted.
namespace taut::synonyms_test {
namespace {

/// All problems of a scene with these members.
std::string complaints(const std::string& members) {
  try {
    parse_scene(R"({"format": "taut-scene/1", )" + members + "}", "test.json");
  } catch (const SceneFileError& error) {
    return error.what();
  }
  return "accepted";
}

void expect_hint(const std::string& members, const std::string& given, const std::string& here) {
  const std::string text = complaints(members), hint = "\"" + given + "\" is called \"" + here + "\" here";
  EXPECT_NE(text.find(hint), std::string::npos) << hint << "\n" << text;
}

std::string joint(const std::string& keys) {
  return R"("bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}], "joints": [{)" + keys + "}]";
}

TEST(SceneSynonyms, OfTypes) {
  for (const auto& [given, here] :
       std::vector<std::pair<std::string, std::string>>{{"revolute", "hinge"},
                                                        {"pin", "hinge"},
                                                        {"continuous", "hinge"},
                                                        {"prismatic", "slider"},
                                                        {"spherical", "ball"},
                                                        {"ball-and-socket", "ball"},
                                                        {"weld", "fixed"},
                                                        {"cardan", "universal"},
                                                        {"hooke", "universal"},
                                                        {"Revolute", "hinge"},
                                                        {"helical", "screw"},
                                                        {"generic", "six_dof"},
                                                        {"point_to_point", "ball"},
                                                        {"rack pinion", "rack_and_pinion"}})
    expect_hint(joint(R"("type": ")" + given + R"(", "a": "ground", "b": "b", "anchor": [0, 0, 0])"), given,
                here);
  for (const auto& [given, here] :
       std::vector<std::pair<std::string, std::string>>{{"cuboid", "box"},
                                                        {"cube", "box"},
                                                        {"ball", "sphere"},
                                                        {"plane", "half_space"},
                                                        {"mesh", "triangle_mesh"},
                                                        {"heightmap", "height_field"},
                                                        {"pill", "capsule"},
                                                        {"SpheroCylinder", "capsule"},
                                                        {"spheroid", "ellipsoid"},
                                                        {"dem", "height_field"},
                                                        {"polytope", "convex_hull"},
                                                        {"convex", "convex_hull"},
                                                        {"disk", "cylinder"}})
    expect_hint(R"("ground": {"shapes": [{"type": ")" + given + "\"}]}", given, here);
  expect_hint(R"("settings": {"integrator": "RK4"})", "RK4", "force-runge-kutta");
  expect_hint(R"("settings": {"solver": "PGS"})", "PGS", "gauss-seidel");
  expect_hint(R"("forces": [{"type": "spring"}])", "spring", "spring-damper");
}

TEST(SceneSynonyms, OfKeys) {
  const std::string hinge = R"("type": "hinge", "axis": [0, 1, 0], )";
  expect_hint(joint(hinge + R"("parent": "ground", "child": "b", "point": [0, 0, 0])"), "parent", "a");
  expect_hint(joint(hinge + R"("parent": "ground", "child": "b", "point": [0, 0, 0])"), "child", "b");
  expect_hint(joint(hinge + R"("a": "ground", "b": "b", "point": [0, 0, 0])"), "point", "anchor");
  expect_hint(joint(hinge + R"("a": "ground", "b": "b", "anchor": [0, 0, 0], "limits": {"lower": 0})"),
              "limits", "axes");
  expect_hint(joint(hinge + R"("a": "ground", "b": "b", "anchor": [0, 0, 0],
    "axes": {"angle": {"limits": {"min": 0, "upper": 1}, "range": [0, 1]}})"),
              "min", "lower");
  const auto body = [](const std::string& keys) {
    return R"("bodies": [{"mass": 1, "inertia": [1, 1, 1], )" + keys + "}]";
  };
  expect_hint(body(R"("pos": [0, 0, 0])"), "pos", "position");
  expect_hint(body(R"("quaternion": [1, 0, 0, 0])"), "quaternion", "orientation");
  expect_hint(body(R"("geometry": [])"), "geometry", "shapes");
  expect_hint(body(R"("static": true)"), "static", "fixed");
  expect_hint(R"("time_step": 0.1)", "time_step", "dt");
  expect_hint(R"("links": [])", "links", "bodies");
  expect_hint(R"("ground": {"shapes": [{"type": "sphere", "diameter": 1}]})", "diameter", "radius");
  expect_hint(R"("materials": {"ice": {"mu": 0.1}})", "mu", "static_friction");
}

/// "from" is a body by its name, and a point by its numbers.
TEST(SceneSynonyms, OfPointsAndOfBodies) {
  const std::string distance = R"("type": "distance", )";
  const std::string points = joint(distance + R"("a": "ground", "b": "b", "frame": "world",
    "from": [5, 0, 0], "to": [0, 0, 0])");
  expect_hint(points, "from", "anchor_a");
  expect_hint(points, "to", "anchor_b");
  EXPECT_EQ(complaints(points).find("missing"), std::string::npos) << complaints(points);
  const std::string bodies = joint(distance + R"("from": "ground", "to": "b", "frame": "world",
    "anchor_a": [5, 0, 0], "anchor_b": [0, 0, 0])");
  expect_hint(bodies, "from", "a");
  expect_hint(bodies, "to", "b");
  for (const std::string type : {"distance", "rope"}) {
    const std::string text = complaints(joint(R"("type": ")" + type + R"(", "a": "ground", "b": "b")"));
    EXPECT_NE(text.find(R"("anchor_a" is missing)"), std::string::npos) << text;
    EXPECT_NE(text.find(R"("anchor_b" is missing)"), std::string::npos) << text;
    EXPECT_EQ(text.find(R"("anchor" is missing)"), std::string::npos) << text;
  }
}

TEST(SceneSynonyms, OfBodiesByTheirEnds) {
  const auto body = [](const std::string& key) {
    return R"("bodies": [{"mass": 1, ")" + key + R"(": {"from": [0, 0, 0], "to": [1, 0, 0]}}])";
  };
  expect_hint(body("cylinder"), "cylinder", "rod");
  expect_hint(body("box"), "box", "beam");
}

TEST(SceneSynonyms, OfLimitsOneLevelTooHigh) {
  const std::string hinge =
      R"("type": "hinge", "axis": [0, 1, 0], "a": "ground", "b": "b", "anchor": [0, 0, 0], )";
  for (const std::string key : {"lower", "upper", "lower_deg", "upper_deg"}) {
    expect_hint(joint(hinge + "\"" + key + "\": 0"), key, "axes");
    expect_hint(joint(hinge + R"("axes": {"angle": {")" + key + "\": 0}}"), key, "limits");
  }
}

/// What is meant by another name is read on: what else is wrong is said at once.
TEST(SceneSynonyms, OfTypesHideNothing) {
  const std::string text = complaints(
      joint(R"("type": "revolute", "a": "ground", "b": "c", "anchor": [0, 0], "axes": {"angle": {"x": 1}})"));
  for (const char* path : {"/joints/0/type", "/joints/0/b", "/joints/0/anchor", "/joints/0/axes/angle/x",
                           R"("axis" is missing)"})
    EXPECT_NE(text.find(path), std::string::npos) << path << "\n" << text;
}

/// A thing has one name: the others are errors.
TEST(SceneSynonyms, AreNotAccepted) {
  EXPECT_EQ(complaints(
                joint(R"("type": "hinge", "a": "ground", "b": "b", "anchor": [0, 0, 0], "axis": [0, 1, 0])")),
            "accepted");
  EXPECT_NE(
      complaints(joint(R"("type": "pin", "a": "ground", "b": "b", "anchor": [0, 0, 0], "axis": [0, 1, 0])")),
      "accepted");
}

/// Only what is known where the name stands is suggested.
TEST(SceneSynonyms, KnowWhereTheyAre) {
  EXPECT_EQ(called_here("ball", {"box", "sphere"}), R"(; "ball" is called "sphere" here)");
  EXPECT_EQ(called_here("ball", {"hinge", "ball"}), "");
  EXPECT_EQ(called_here("revolute", {"box", "sphere"}), "");
  EXPECT_EQ(called_here("colour", {"a", "b", "anchor"}), "");
  EXPECT_EQ(called_here("half_extents", {"size"}),
            R"(; "half_extents" is called "size" here: whole lengths along x, y and z)");
}

}  // namespace
}  // namespace taut::synonyms_test
