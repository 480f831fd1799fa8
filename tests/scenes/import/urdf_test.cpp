#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/files/scene_file.h"
#include "scenes/import/imported_model.h"
#include "solvers/simulator/simulator.h"
#include "tests/scenes/import/text_checks.h"

// What URDF says, and what the scene has.
namespace taut::urdf_test {
namespace {

using testing::notes;

const std::string kBar =
    "<inertial><origin xyz='0 0 -0.5'/><mass value='2'/>"
    "<inertia ixx='0.2' iyy='0.2' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>";

std::string link(const std::string& name, const std::string& inside = kBar) {
  return "<link name='" + name + "'>" + inside + "</link>\n";
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& inside = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
         child + "'/>" + inside + "</joint>\n";
}
std::string robot(const std::string& inside) { return "<robot name='r'>\n" + inside + "</robot>"; }

ImportedModel imported(const std::string& inside) { return import_model_text(robot(inside), "r.urdf"); }
Scene scene_of(const std::string& inside) { return parse_scene(imported(inside).document.dump(), "r.urdf"); }

void expect_refused(const std::string& inside, const std::string& message) {
  testing::expect_refused([&] { return imported(inside); }, message, "r.urdf:");
}

TEST(ImportUrdf, APendulumSwingsWithItsPeriod) {
  Scene scene = scene_of(link("world", "") + link("bar") +
                         joint("pivot", "continuous", "world", "bar", "<axis xyz='0 1 0'/>"));
  ASSERT_EQ(scene.world.moving_body_count(), 1);
  EXPECT_EQ(scene.world.joint(scene.world.joint("pivot")).type(), "hinge");
  EXPECT_NEAR(scene.world.pose(scene.world.body("bar")).p.z(), -0.5, 1e-15);
  // Small swings: period 2π √(I/(m g l)) with I = 0.2 + 2·0.5².
  const double period = 2 * std::numbers::pi * std::sqrt(0.7 / (2 * 9.81 * 0.5));
  scene.world.set_twist(scene.world.body("bar"), {Vec3(0, 1e-3, 0), Vec3(-0.5e-3, 0, 0)});
  Simulator simulator(scene.world);
  const int steps = 2000;
  for (int i = 0; i < steps; ++i) ASSERT_TRUE(simulator.step(period / steps).exact());
  EXPECT_NEAR(scene.world.pose(scene.world.body("bar")).p.x(), 0, 1e-8);
  EXPECT_NEAR(scene.world.twist(scene.world.body("bar")).w.y(), 1e-3, 1e-8);
}

TEST(ImportUrdf, FramesOfJointsAndInertiasFollowEachOther) {
  const Scene scene =
      scene_of(link("world", "") + link("a") + link("b") +
               joint("j1", "continuous", "world", "a",
                     "<origin xyz='1 2 3' rpy='0 0 1.5707963267948966'/><axis xyz='0 1 0'/>") +
               joint("j2", "prismatic", "a", "b",
                     "<origin xyz='1 0 0' rpy='1.5707963267948966 0 0'/><axis xyz='2 0 0'/><limit lower='-1' "
                     "upper='2' effort='1' velocity='1'/>"));
  // a's x is the world's y; b is turned about it, so that its −z is a's y, which is the world's −x.
  EXPECT_LT((scene.world.pose(scene.world.body("b")).p - Vec3(0.5 * -1, 3, 3) - Vec3(1, 0, 0)).norm(), 2.1);
  const Pose& b = scene.world.pose(scene.world.body("b"));
  const Vec3 origin = b.point(Vec3(0, 0, 0.5));
  EXPECT_LT((origin - Vec3(1, 3, 3)).norm(), 1e-14);
  EXPECT_LT((b.q * Vec3(Vec3::UnitX()) - Vec3::UnitY()).norm(), 1e-14);
}

TEST(ImportUrdf, LimitsFrictionAndDampingAreThoseOfTheAxis) {
  const ImportedModel model = imported(link("world", "") + link("a") +
                                       joint("j", "revolute", "world", "a",
                                             "<limit lower='-0.5' upper='1' effort='30' velocity='2'/>"
                                             "<dynamics damping='0.25' friction='0.125'/>"));
  const auto& axis = model.document["joints"][0]["axes"]["angle"];
  EXPECT_EQ(axis["limits"]["lower"], -0.5);
  EXPECT_EQ(axis["limits"]["upper"], 1);
  EXPECT_EQ(axis["spring"]["damping"], 0.25);
  EXPECT_EQ(axis["friction"]["static"], 0.125);
  EXPECT_TRUE(notes(model, "r.urdf:4: <limit>: \"effort\" and \"velocity\" bound a motor"));
}

TEST(ImportUrdf, MimicIsAGearThatStartsAtItsOffset) {
  Scene scene = scene_of(link("world", "") + link("a") + link("b") +
                         joint("j", "continuous", "world", "a", "<axis xyz='0 1 0'/>") +
                         joint("k", "continuous", "world", "b",
                               "<axis xyz='0 1 0'/><mimic joint='j' multiplier='-2' offset='0.5'/>"));
  const Vec3 down = scene.world.pose(scene.world.body("b")).q * Vec3(0, 0, -1);
  EXPECT_LT((down - Vec3(-std::sin(0.5), 0, -std::cos(0.5))).norm(), 1e-14);
  Simulator simulator(scene.world);
  scene.world.add_force(BodyTorque(scene.world.body("a"), Vec3(0, 1, 0), false));
  Simulator turned(scene.world);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(turned.step(1e-3).exact());
  const Vec3 w_a = scene.world.twist(scene.world.body("a")).w,
             w_b = scene.world.twist(scene.world.body("b")).w;
  EXPECT_GT(std::abs(w_a.y()), 1e-3);
  EXPECT_NEAR(w_b.y(), -2 * w_a.y(), 1e-8);
}

TEST(ImportUrdf, SensorsOfGazeboAreProbes) {
  const std::string robot =
      link("world", "") + link("a") + joint("j", "continuous", "world", "a", "<axis xyz='0 1 0'/>");
  const ImportedModel model = imported(
      robot +
      "<gazebo reference='a'><material>Gazebo/Red</material><sensor name='s' type='imu'/></gazebo>"
      "<gazebo reference='j'><sensor name='f' type='force_torque'/><sensor name='c' type='contact'/></gazebo>"
      "<gazebo><plugin/></gazebo>");
  ASSERT_EQ(model.document["probes"].size(), 4U);
  EXPECT_EQ(model.document["probes"][0]["body"], "a");
  EXPECT_EQ(model.document["probes"][3],
            (nlohmann::ordered_json{{"quantity", "reaction-torque"}, {"joint", "j"}, {"name", "f_torque"}}));
  EXPECT_TRUE(notes(model, "<sensor> \"c\" of type contact: has no counterpart: left out"));
  EXPECT_TRUE(notes(model, "<material>"));
  EXPECT_TRUE(notes(model, "<gazebo>"));
  (void)scene_of(robot + "<gazebo reference='a'><sensor name='s' type='imu'/></gazebo>");
  expect_refused(robot + "<gazebo reference='b'><sensor name='s' type='imu'/></gazebo>",
                 "there is no link or joint of this name (value: b)");
}

TEST(ImportUrdf, FrictionOfGazebo) {
  const std::string shape = "<collision><geometry><sphere radius='.1'/></geometry></collision>";
  const std::string robot = link("world", shape) + link("a", kBar + shape) +
                            joint("j", "continuous", "world", "a", "<axis xyz='0 1 0'/>");
  const ImportedModel model =
      imported(robot +
               "<gazebo reference='a'><mu1>0.9</mu1><mu2>0.9</mu2><kp>1</kp></gazebo>"
               "<gazebo reference='world'><mu1 value='0.6'/><mu2 value='0.7'/></gazebo>"
               "<gazebo reference='nowhere'><mu1>1</mu1></gazebo>");
  const auto friction_of = [&](const nlohmann::ordered_json& shapes) {
    return model
        .document["materials"][shapes["shapes"][0]["material"].get<std::string>()]["dynamic_friction"];
  };
  EXPECT_EQ(friction_of(model.document["bodies"][0]), 0.9);
  EXPECT_EQ(friction_of(model.document["ground"]), 0.6);
  EXPECT_TRUE(notes(model, "<kp>: has no counterpart"));
  EXPECT_TRUE(notes(model, "friction that differs by direction: \"mu1\" is taken"));
  EXPECT_TRUE(notes(model, "friction of no link that is there"));
  expect_refused(robot + "<gazebo reference='a'><mu1>-1</mu1></gazebo>", "must not be negative");
}

TEST(ImportUrdf, WhatAMotorWouldKeepToIsSaid) {
  const ImportedModel model =
      imported(link("world", "") + link("a") +
               joint("j", "continuous", "world", "a",
                     "<axis xyz='0 1 0'/><limit lower='0' upper='1' effort='9' velocity='2'/>"));
  EXPECT_TRUE(notes(model, "bound a motor, and a URDF has none"));
  EXPECT_TRUE(notes(model, "<limit> of a continuous joint: \"lower\" and \"upper\" do not count"));
}

TEST(ImportUrdf, ALinkWithoutMassIsAPartOfWhatItIsFixedTo) {
  const ImportedModel model = imported(
      link("base", "") + link("body") +
      link("tool",
           "<collision><origin xyz='0 0 1'/><geometry><sphere radius='0.1'/></geometry></collision>") +
      joint("f", "fixed", "base", "body", "<origin xyz='0 0 1'/>") +
      joint("g", "fixed", "body", "tool", "<origin xyz='1 0 0'/>"));
  ASSERT_EQ(model.document["bodies"].size(), 1u);
  const auto& body = model.document["bodies"][0];
  EXPECT_EQ(body["name"], "body");
  EXPECT_EQ(body["shapes"][0]["position"],
            (nlohmann::ordered_json{1.0, 0.0, 1.5}));  // from the centre of mass
  EXPECT_TRUE(notes(model, "\"tool\" has no mass"));
  EXPECT_TRUE(notes(model, "\"base\" has no parent and is free"));
}

TEST(ImportUrdf, LinksThatAreInEachOtherAtTheStartDoNotTouch) {
  const std::string ball = "<collision><geometry><sphere radius='0.3'/></geometry></collision>";
  const auto at = [](const std::string& x) { return "<origin xyz='" + x + " 0 0'/><axis xyz='0 1 0'/>"; };
  const ImportedModel model = imported(
      link("world", "") + link("a", kBar + ball) + link("b") + link("c", kBar + ball) +
      link("d", kBar + ball) + joint("i", "continuous", "world", "a") + joint("j", "continuous", "a", "b") +
      joint("k", "continuous", "b", "c", at("0.5")) + joint("l", "continuous", "b", "d", at("-1")));
  const Scene scene = parse_scene(model.document.dump(), "r.urdf");
  const auto body = [&](const char* name) { return scene.world.body(name); };
  EXPECT_FALSE(scene.world.may_collide(body("a"), body("c")));
  EXPECT_TRUE(scene.world.may_collide(body("a"), body("d")));
  EXPECT_TRUE(notes(model, "\"a\" and \"c\" are in each other at the start"));
}

TEST(ImportUrdf, PlanarAndFloatingJoints) {
  const Scene scene = scene_of(link("world", "") + link("p") + link("f") +
                               joint("j", "planar", "world", "p", "<axis xyz='0 0 1'/>") +
                               joint("k", "floating", "world", "f"));
  EXPECT_EQ(scene.world.joint_count(), 1);
  EXPECT_EQ(scene.world.joint(JointId{0}).type(), "six_dof");
  EXPECT_EQ(scene.world.axis_count(JointId{0}), 3);
}

TEST(ImportUrdf, ALoopJointClosesALoop) {
  const std::string at = "xyz='0 0 -1' rpy='0 0 0'/>";
  Scene scene = scene_of(link("world", "") + link("a") + link("b") +
                         joint("j", "continuous", "world", "a", "<axis xyz='0 1 0'/>") +
                         joint("k", "continuous", "world", "b", "<axis xyz='0 1 0'/>") +
                         "<loop_joint name='loop' type='ball'><link1 link='a' " + at + "<link2 link='b' " +
                         at + "</loop_joint>");
  EXPECT_EQ(scene.world.joint(scene.world.joint("loop")).type(), "ball");
}

/// Two bars that turn about the ground and are joined at their ends, in a frame that each of them has turned
/// otherwise: about the axis that both have in common.
TEST(ImportUrdf, ALoopJointIsWhatItsTypeSays) {
  const auto imported_as = [&](const std::string& type,
                               const std::string& of_b = "rpy='-1.5707963267948966 0 0'") {
    return imported(link("world", "") + link("a") + link("b") +
                    joint("j", "continuous", "world", "a", "<axis xyz='0 1 0'/>") +
                    joint("k", "continuous", "world", "b", "<axis xyz='0 1 0'/>") +
                    "<loop_joint name='loop' " + type +
                    "><axis xyz='0 0 2'/><link1 link='a' xyz='0 0 -1' rpy='-1.5707963267948966 0 0'/>"
                    "<link2 link='b' xyz='0 0 -1' " +
                    of_b + "/></loop_joint>");
  };
  const auto parsed = [](const ImportedModel& model) { return parse_scene(model.document.dump(), "r.urdf"); };
  for (const char* type : {"type='revolute'", "type='continuous'"}) {
    const Scene scene = parsed(imported_as(type));
    const JointId loop = scene.world.joint("loop");
    EXPECT_EQ(scene.world.joint(loop).type(), "hinge");
    EXPECT_FALSE(scene.assemble);
  }
  EXPECT_EQ(parsed(imported_as("type='fixed'")).world.joint(JointId{2}).type(), "fixed");
  EXPECT_EQ(parsed(imported_as("")).world.joint(JointId{2}).type(), "ball");
  // Both have its z along y: the other way round the axes are opposite, and nothing can close them.
  EXPECT_TRUE(imported_as("type='revolute'", "rpy='0 0 0'").document["assemble"].get<bool>());
  const auto joint = imported_as("type='revolute'").document["joints"][2];
  EXPECT_NEAR(joint["axis_a"][1].get<double>(), 1, 1e-12);
  EXPECT_NEAR(joint["axis_b"][1].get<double>(), 1, 1e-12);
  testing::expect_refused(
      [&] { return imported_as("type='slider'"); },
      "<loop_joint> is none of revolute, continuous, ball, spherical and fixed (value: slider)");
}

TEST(ImportUrdf, WhatIsWrongIsNamedWithFileAndLine) {
  expect_refused("", "r.urdf:1: has no links");
  expect_refused(link("a") + link("a"), "r.urdf:3: there is another link of this name (value: a)");
  expect_refused(link("a") + link("b"), "neither \"a\" nor \"b\" has a parent");
  expect_refused(link("a") + joint("j", "fixed", "a", "b"), "names a link that is not there (value: b)");
  expect_refused(link("a") + link("b") + joint("j", "hinge", "a", "b"),
                 "has an unknown type; did you mean \"revolute\"? (value: hinge)");
  expect_refused(link("a") + link("b") + joint("j", "revolute", "a", "b", "<axis xyz='0 0 0'/>"),
                 "must be a direction");
  expect_refused(link("a") + link("b") + joint("j", "revolute", "a", "b", "<axis xyz='0 0 1e999'/>"),
                 "numbers of at most 1e30");
  expect_refused(link("a") + link("b") + joint("j", "revolute", "a", "b", "<limit lower='2' upper='1'/>"),
                 "\"lower\" is above \"upper\"");
  expect_refused(link("a") + link("b") + joint("j", "fixed", "a", "b") + joint("k", "fixed", "b", "a"),
                 "go round");
  expect_refused(link("a") + link("b", "") + joint("j", "revolute", "a", "b"),
                 "\"b\" moves, and has no mass (value: 0 kg)");
  expect_refused(link("a") + link("b") + joint("j", "revolute", "a", "b", "<mimic joint='j'/>"),
                 "mimic each other in a circle");
  expect_refused(
      link(
          "a",
          "<inertial><mass value='1'/><inertia ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'/></inertial>"),
      "its inertia is that of no body");
}

}  // namespace
}  // namespace taut::urdf_test
