#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "scenes/files/scene_file.h"
#include "scenes/import/imported_model.h"
#include "solvers/simulator/simulator.h"
#include "tests/scenes/import/text_checks.h"

// Models that start beyond their limits, or with an inertia that no body has.
namespace taut::start_test {
namespace {

using testing::notes;

std::string link(const std::string& name, const std::string& moments = "0.1 0.1 0.1") {
  double x = 0, y = 0, z = 0;
  std::istringstream(moments) >> x >> y >> z;
  std::ostringstream text;
  text << "<link name='" << name << "'><inertial><origin xyz='0.5 0 0'/><mass value='1'/><inertia ixx='" << x
       << "' iyy='" << y << "' izz='" << z << "' ixy='0' ixz='0' iyz='0'/></inertial></link>\n";
  return text.str();
}
/// At 1 m along x of its parent, about y.
std::string hinge(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& limits = "-3 3", const std::string& inside = "<origin xyz='1 0 0'/>") {
  std::string lower = limits.substr(0, limits.find(' ')), upper = limits.substr(limits.find(' ') + 1);
  return "<joint name='" + name + "' type='revolute'><parent link='" + parent + "'/><child link='" + child +
         "'/><axis xyz='0 1 0'/><limit lower='" + lower + "' upper='" + upper +
         "' effort='1' velocity='1'/>" + inside + "</joint>\n";
}
ImportedModel imported(const std::string& inside) {
  return import_model_text("<robot name='r'>\n<link name='world'/>\n" + inside + "</robot>", "r.urdf");
}
Scene scene_of(const ImportedModel& model) { return parse_scene(model.document.dump(), "r.urdf"); }
Vec3 position(const Scene& scene, const std::string& body) {
  return scene.world.pose(scene.world.body(body)).p;
}

/// The arm behind the axis turns by itself; the one in front stays.
TEST(ImportStart, AnAxisBeyondItsLimitStartsThere) {
  const ImportedModel model = imported(link("a") + link("b") + link("c") + hinge("i", "world", "a") +
                                       hinge("j", "a", "b", "0.5 1") + hinge("k", "b", "c"));
  EXPECT_TRUE(notes(model,
                    "r.urdf:7: \"j\" starts at 0, beyond its limits (value: 0.5 to 1): it starts at "
                    "0.5 now, which is 0 in the scene"));
  Scene scene = scene_of(model);
  const Vec3 along(std::cos(0.5), 0, -std::sin(0.5));
  EXPECT_LT((position(scene, "a") - Vec3(1.5, 0, 0)).norm(), 1e-15);
  EXPECT_LT((position(scene, "b") - Vec3(2, 0, 0) - 0.5 * along).norm(), 1e-15);
  EXPECT_LT((position(scene, "c") - Vec3(2, 0, 0) - 1.5 * along).norm(), 1e-15);
  EXPECT_EQ(model.document["joints"][1]["axes"]["angle"]["limits"],
            (nlohmann::ordered_json{{"lower", 0.0}, {"upper", 0.5}}));
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
}

/// What mimics it has its own share of the motion, and the other way round.
TEST(ImportStart, WhatMimicsAnAxisGoesAlong) {
  for (const bool driven : {false, true}) {
    const ImportedModel model =
        imported(link("a") + link("b") + hinge("j", "world", "a", driven ? "-3 3" : "0.5 1") +
                 hinge("k", "world", "b", driven ? "1 2" : "-3 3",
                       "<origin xyz='0 5 0'/><mimic joint='j' multiplier='2'/>"));
    const Scene scene = scene_of(model);
    const auto angle = [&](const std::string& body, const Vec3& pivot) {
      const Vec3 r = position(scene, body) - pivot;
      return std::atan2(-r.z(), r.x());
    };
    EXPECT_NEAR(angle("a", Vec3(1, 0, 0)), 0.5, 1e-12);
    EXPECT_NEAR(angle("b", Vec3(0, 5, 0)), 1, 1e-12);
  }
}

/// a and b hang side by side on the ground, c is the bar between their ends.
std::string four_bar(const std::string& limits_of_a, const std::string& limits_of_b) {
  return link("a") + link("b") + link("c") + hinge("i", "world", "a", limits_of_a, "<origin xyz='0 0 0'/>") +
         hinge("j", "world", "b", limits_of_b, "<origin xyz='1 0 0'/>") +
         hinge("k", "a", "c", "-3 3", "<origin xyz='0 0 -1'/>") +
         "<loop_joint name='l'><link1 link='c' xyz='1 0 0'/><link2 link='b' xyz='0 0 -1'/></loop_joint>";
}

/// A parallelogram: the bar stays level, and closed, while both sides turn.
TEST(ImportStart, ALoopMovesAlongAndStaysClosed) {
  const ImportedModel model = imported(four_bar("-1 -0.7", "-3 3"));
  EXPECT_TRUE(
      notes(model,
            "it starts at -0.7 now, which is 0 in the scene, and axes that depend on it move along with it"));
  Scene scene = scene_of(model);
  EXPECT_FALSE(scene.assemble);
  EXPECT_LT((position(scene, "c") - Vec3(std::sin(0.7) + 0.5, 0, -std::cos(0.7))).norm(), 1e-11);
  Simulator simulator(scene.world, scene.settings);
  EXPECT_LT(simulator.analyze_rank().freedoms, 3);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
  EXPECT_LT(simulator.report().gap.metres, 1e-9);
}

/// Numbers of files are rounded: what that leaves open across the plane of the mechanism no axis can close.
TEST(ImportStart, ALoopThatIsRoundedMovesAlong) {
  for (const char* error : {"1e-6", "1e-8", "1e-10"}) {
    std::string text = four_bar("-1 -0.7", "-3 3");
    const std::string place = "xyz='0 0 -1'/></loop_joint>";
    text.replace(text.find(place), place.size(), "xyz='0 " + std::string(error) + " -1'/></loop_joint>");
    const ImportedModel model = imported(text);
    EXPECT_TRUE(notes(model, "it starts at -0.7 now")) << error;
  }
}

/// A loop of more axes than are sought together says so.
TEST(ImportStart, LargeLoopsHaveTheirReason) {
  std::string ring;
  for (int i = 0; i < 130; ++i)
    ring += link("l" + std::to_string(i)) +
            hinge("h" + std::to_string(i), i == 0 ? "world" : "l" + std::to_string(i - 1),
                  "l" + std::to_string(i), i == 0 ? "0.2 1" : "-3 3", "<origin xyz='0 0 0'/>");
  const ImportedModel model = imported(
      ring +
      "<loop_joint name='l'><link1 link='world' xyz='0 0 0'/><link2 link='l129' xyz='0 0 0'/></loop_joint>");
  EXPECT_TRUE(
      notes(model, "more than 100 axes depend on it, for which no start is sought: the limit is given up"));
}

/// One side may only be to the left, and the other to the right.
TEST(ImportStart, ALimitThatNothingMeetsIsGivenUp) {
  const ImportedModel model = imported(four_bar("-1 -0.7", "0.2 3"));
  EXPECT_TRUE(notes(model,
                    "r.urdf:6: \"i\" starts at 0, beyond its limits (value: -1 to -0.7): no start is "
                    "found where loops are closed and limits kept: the limit is given up"));
  EXPECT_TRUE(notes(model, "\"j\" starts at 0, beyond its limits (value: 0.2 to 3): no start"));
  Scene scene = scene_of(model);
  EXPECT_LT((position(scene, "c") - Vec3(0.5, 0, -1)).norm(), 1e-15);
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
}

/// Axes of one link: the first stays across the second, which has turned; the third moves with the link.
TEST(ImportStart, SeveralAxesOfOneLink) {
  const std::string text =
      "<mujoco><compiler angle='radian'/><worldbody><body name='b'>"
      "<joint name='x' type='hinge' axis='1 0 0' range='-1 1'/>"
      "<joint name='y' type='hinge' axis='0 1 0' range='0.3 1'/>"
      "<joint name='z' type='slide' axis='0 0 1' range='0.2 1'/>"
      "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/></body></worldbody></mujoco>";
  const Scene scene = parse_scene(import_model_text(text, "m.xml").document.dump(), "m.xml");
  EXPECT_LT((position(scene, "b") - 0.2 * Vec3(std::sin(0.3), 0, std::cos(0.3))).norm(), 1e-15);
  const World& world = scene.world;
  const JointId cardan = world.joint("x+y");
  EXPECT_NEAR(world.axis_value(world.axis(cardan, "angle_1")), 0, 1e-15);
  const auto& limits = world.axis_properties(world.axis(cardan, "angle_2")).limits;
  ASSERT_TRUE(limits.has_value());
  EXPECT_NEAR(limits->upper, 0.7, 1e-15);
}

TEST(ImportStart, AnInertiaOfNoBodyBecomesTheMeanOfItsMoments) {
  const ImportedModel model = imported(link("a", "1 1 10") + hinge("j", "world", "a"));
  EXPECT_TRUE(notes(model,
                    "r.urdf:3: the principal moments of inertia of \"a\" are those of no body (value: 1 1 10 "
                    "kg m²): each becomes their mean, 4 kg m²"));
  const Scene scene = scene_of(model);
  EXPECT_LT((scene.world.mass_properties(scene.world.body("a")).inertia_B() - 4 * Mat3::Identity()).norm(),
            1e-14);
  for (const char* none : {"0 0 0", "-1 5 5"})
    testing::expect_refused([&] { return imported(link("a", none) + hinge("j", "world", "a")); },
                            "its inertia is that of no body");
}

/// Where it is fixed to what makes a body of both, nothing is changed.
TEST(ImportStart, AnInertiaOfNoBodyIsPartOfWhatItIsFixedTo) {
  const ImportedModel model =
      imported(link("a", "1 1 10") + link("b", "10 10 10") + hinge("j", "world", "a") +
               "<joint name='f' type='fixed'><parent link='a'/><child link='b'/></joint>");
  EXPECT_FALSE(notes(model, "each becomes their mean"));
  const Scene scene = scene_of(model);
  const Mat3 I = scene.world.mass_properties(BodyId{1}).inertia_B();
  EXPECT_LT((I - Mat3(Vec3(11, 11, 20).asDiagonal())).norm(), 1e-13);
}

/// (distance/gyration)² is 2.5e7 of the first, and 2.5e3 of the second.
TEST(ImportStart, APointOnALeverIsNamed) {
  EXPECT_TRUE(notes(imported(link("a", "1e-8 1e-8 1e-8") + hinge("j", "world", "a")),
                    "\"a\" is nearly a point (value: 0.0001 m across, 0.5 m from its axis \"j\")"));
  EXPECT_FALSE(notes(imported(link("a", "1e-4 1e-4 1e-4") + hinge("j", "world", "a")), "nearly a point"));
}

/// Nobody meant that, and nothing is there.
TEST(ImportStart, ALimitOutOfSightIsGivenUp) {
  const ImportedModel model = imported(link("a") + hinge("j", "world", "a", "1e29 1e30"));
  EXPECT_TRUE(notes(model, "the limit is given up"));
  (void)scene_of(model);
}

/// MuJoCo's compiler refuses it, and MJCF has a word for the same rule.
TEST(ImportStart, InMjcfTheFileSaysSo) {
  const auto text = [](const std::string& compiler) {
    return "<mujoco>" + compiler +
           "<worldbody><body name='a'><joint axis='1 0 0'/><inertial pos='0 0 0' mass='1' "
           "diaginertia='1 1 10'/></body></worldbody></mujoco>";
  };
  testing::expect_refused([&] { return import_model_text(text(""), "m.xml"); },
                          "balanceinertia=\"true\" of <compiler> makes it one");
  EXPECT_NO_THROW(import_model_text(text("<compiler balanceinertia='true'/>"), "m.xml"));
}

/// An arm that is folded onto its base: a link and the one behind the next.
std::string folded_arm(const std::string& more = "") {
  return "<mujoco><worldbody><geom type='plane' size='1 1 1' pos='0 0 -0.18'/>"
         "<body name='base'><geom type='box' size='0.2 0.2 0.2'/>"
         "<body name='upper' pos='0.5 0 0'><joint axis='0 1 0'/><geom type='box' size='0.4 0.1 0.1'/>"
         "<body name='lower'><joint axis='0 1 0'/><geom type='box' size='0.4 0.1 "
         "0.1'/></body></body></body>" +
         more + "</worldbody></mujoco>";
}

/// They would not part where joints hold them.  A crate that stands in the arm is another matter, as is the
/// base that stands in the floor.
TEST(ImportStart, LinksOfARobotThatAreInEachOtherDoNotTouch) {
  const std::string crate =
      "<body name='crate' pos='1.1 0 0'><freejoint/><geom type='box' size='0.3 0.1 0.1'/></body>";
  const ImportedModel model = import_model_text(folded_arm(crate), "m.xml");
  EXPECT_TRUE(
      notes(model, "\"base\" and \"lower\" are in each other at the start, by 0.1 m: they do not touch"));
  const Scene scene = parse_scene(model.document.dump(), "m.xml");
  const World& world = scene.world;
  const auto touch = [&](const char* a, const char* b) {
    return world.may_collide(world.body(a), world.body(b));
  };
  EXPECT_FALSE(touch("base", "lower"));
  EXPECT_FALSE(touch("base", "upper")) << "neighbours never do";
  EXPECT_TRUE(touch("crate", "lower"));
  EXPECT_TRUE(touch("crate", "upper"));
  EXPECT_TRUE(world.may_collide(world.body("crate"), kGround));
}

TEST(ImportStart, AFoldedArmRunsWithContacts) {
  Scene scene = parse_scene(import_model_text(folded_arm(), "m.xml").document.dump(), "m.xml");
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
}

/// Round-off, and feet that are drawn a little into what they stand on, are no reason.
TEST(ImportStart, WhatIsHardlyInEachOtherTouches) {
  const std::string text =
      "<mujoco><worldbody><body name='a'><freejoint/><geom type='box' size='0.1 0.1 0.1'/>"
      "<body name='b' pos='0 0 0.5'><joint axis='0 1 0'/><geom type='box' size='0.1 0.1 0.1'/>"
      "<body name='c' pos='0 0 -0.3001'><joint axis='0 1 0'/><geom type='box' size='0.1 0.1 0.1'/></body>"
      "</body></body></worldbody></mujoco>";
  const Scene scene = parse_scene(import_model_text(text, "m.xml").document.dump(), "m.xml");
  EXPECT_TRUE(scene.world.may_collide(scene.world.body("a"), scene.world.body("c")));
}

}  // namespace
}  // namespace taut::start_test
