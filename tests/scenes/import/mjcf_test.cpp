#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/files/scene_file.h"
#include "scenes/import/imported_model.h"
#include "solvers/diagnosis/start_checks.h"
#include "solvers/simulator/simulator.h"
#include "tests/scenes/import/text_checks.h"

// What MJCF says, and what the scene has.
namespace taut::mjcf_test {
namespace {

using testing::notes;

ImportedModel imported(const std::string& inside) {
  return import_model_text("<mujoco>\n" + inside + "\n</mujoco>", "m.xml");
}
ImportedModel world(const std::string& bodies) { return imported("<worldbody>" + bodies + "</worldbody>"); }
Scene scene_of(const ImportedModel& model) { return parse_scene(model.document.dump(), "m.xml"); }

void expect_refused(const std::string& inside, const std::string& message) {
  testing::expect_refused([&] { return imported(inside); }, message, "m.xml:");
}

const std::string kBall = "<geom size='.1' mass='2'/>";

TEST(ImportMjcf, OrientationsInAllWays) {
  const auto turned = [](const std::string& how, const std::string& compiler = "") {
    const ImportedModel model =
        imported(compiler + "<worldbody><body " + how + "><freejoint/>" + kBall + "</body></worldbody>");
    const Scene scene = scene_of(model);
    return scene.world.pose(BodyId{1}).q.toRotationMatrix();
  };
  Mat3 quarter;  // about z
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_LT((turned("quat='1 0 0 1'") - quarter).norm(), 1e-15);
  EXPECT_LT((turned("axisangle='0 0 2 90'") - quarter).norm(), 1e-15);
  EXPECT_LT((turned("euler='0 0 90'") - quarter).norm(), 1e-15);
  EXPECT_LT((turned("xyaxes='0 1 0 -1 1 0'") - quarter).norm(), 1e-15);
  EXPECT_LT((turned("euler='0 0 1.5707963267948966'", "<compiler angle='radian'/>") - quarter).norm(), 1e-15);
  Mat3 z_is_x;
  z_is_x << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  EXPECT_LT((turned("zaxis='3 0 0'") - z_is_x).norm(), 1e-15);
  const Mat3 moving = turned("euler='90 90 0'"),
             fixed = turned("euler='90 90 0'", "<compiler eulerseq='XYZ'/>");
  EXPECT_LT((moving * Vec3(Vec3::UnitZ()) - Vec3(1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((fixed * Vec3(Vec3::UnitZ()) - Vec3(0, -1, 0)).norm(), 1e-15);
}

TEST(ImportMjcf, ClassesGiveAttributesDownTheTree) {
  const ImportedModel model = imported(
      "<default><geom density='500'/><default class='heavy'><geom density='4000'/><default "
      "class='small'><geom size='.05'/>"
      "</default></default></default><worldbody>"
      "<body name='a'><freejoint/><geom size='.1'/></body>"
      "<body name='b' childclass='small'><freejoint/><geom/></body>"
      "<body name='c' childclass='small'><freejoint/><geom class='heavy' size='.1'/></body></worldbody>");
  const Scene scene = scene_of(model);
  const double volume = 4 * std::numbers::pi / 3e3;
  const auto mass = [&](const char* name) {
    return scene.world.mass_properties(scene.world.body(name)).mass();
  };
  EXPECT_NEAR(mass("a"), 500 * volume, 1e-12);
  EXPECT_NEAR(mass("b"), 4000 * volume / 8, 1e-12);
  EXPECT_NEAR(mass("c"), 4000 * volume, 1e-12);
}

TEST(ImportMjcf, JointsOfOneBodyAreAsFewAsPossible) {
  const auto types = [](const std::string& joints) {
    const ImportedModel model = world("<body name='b'>" + joints + kBall + "</body>");
    std::string text;
    for (const auto& joint : model.document["joints"]) text += joint["type"].get<std::string>() + " ";
    (void)scene_of(model);
    return text + std::to_string(model.document["bodies"].size());
  };
  const std::string x = "axis='1 0 0'/>", y = "axis='0 1 0'/>", z = "axis='0 0 1'/>", hinge = "<joint ",
                    slide = "<joint type='slide' ";
  EXPECT_EQ(types(hinge + x), "hinge 1");
  EXPECT_EQ(types(slide + x), "slider 1");
  EXPECT_EQ(types("<joint type='ball'/>"), "ball 1");
  EXPECT_EQ(types(hinge + x + hinge + y), "universal 1");
  EXPECT_EQ(types(hinge + x + slide + x), "cylindrical 1");
  EXPECT_EQ(types(slide + x + slide + y), "six_dof 1");
  EXPECT_EQ(types(slide + y + slide + x + hinge + z), "six_dof 1");
  EXPECT_EQ(types(slide + x + slide + y + slide + z + hinge + y + hinge + x), "six_dof universal 2");
  EXPECT_EQ(types(hinge + x + hinge + y + hinge + z), "universal hinge 2");
  EXPECT_EQ(types(hinge + x + "<joint axis='1 1 0'/>"), "hinge hinge 2");
  EXPECT_EQ(types(hinge + x + "<joint pos='0 0 .1' axis='0 1 0'/>"), "hinge hinge 2");
  EXPECT_EQ(types(hinge + y + slide + x), "six_dof 1");
  EXPECT_EQ(types(hinge + y + slide + y + slide + x), "six_dof 1");
  EXPECT_EQ(types(hinge + x + hinge + y + slide + z), "six_dof 1");
  EXPECT_EQ(types(slide + x + hinge + y + slide + x), "six_dof slider 2");
  EXPECT_EQ(types("<freejoint/>"), "1");
}

/// A link that slides on what turns with it: the joint goes from the link to its parent, and yet all values
/// and rates are as in the file.
TEST(ImportMjcf, ASlideBehindAHingeIsAJointFromTheLink) {
  const ImportedModel model = imported(
      "<option gravity='0 0 0'/><compiler angle='radian'/>"
      "<worldbody><body name='b'><joint name='turn' axis='0 1 0' range='-1 2'/>"
      "<joint name='out' type='slide' axis='1 0 0' stiffness='100' springref='.5' range='-3 4'/>"
      "<inertial pos='.3 0 0' mass='1' diaginertia='.01 .01 .01'/><site name='s'/></body></worldbody>"
      "<sensor><force site='s'/></sensor><keyframe><key qvel='2 .25'/></keyframe>");
  EXPECT_FALSE(notes(model, "a body between them"));
  EXPECT_TRUE(notes(model, "its probe is of what acts on the parent"));
  Scene scene = scene_of(model);
  World& world = scene.world;
  const JointId joint = world.joint("turn+out");
  ASSERT_EQ(world.joint(joint).a(), world.body("b"));
  const AxisId turn{joint, 1}, out{joint, 0};
  EXPECT_NEAR(world.axis_rate(turn), 2, 1e-14);
  EXPECT_NEAR(world.axis_rate(out), 0.25, 1e-14);
  EXPECT_LT((world.twist(world.body("b")).v - Vec3(0.25, 0, -0.6)).norm(), 1e-14);
  EXPECT_EQ(world.axis_properties(turn).limits->upper, 2);
  EXPECT_EQ(world.axis_properties(out).limits->lower, -3);
}

/// cos ωt with all of the mass, or where another slide keeps a body between both joints, with 1e-4 less.
TEST(ImportMjcf, AllOfALinkSlides) {
  const auto error = [](const std::string& more) {
    Scene scene = scene_of(imported("<option gravity='0 0 0'/><worldbody><body name='b'>" + more +
                                    "<joint axis='0 1 0'/><joint name='out' type='slide' axis='1 0 0' "
                                    "stiffness='100' springref='.5'/><inertial pos='.3 0 0' mass='1' "
                                    "diaginertia='.01 .01 .01'/></body></worldbody>"));
    const Pose& pose = scene.world.pose(scene.world.body("b"));
    const double start = pose.p.x();
    Simulator simulator(scene.world, scene.settings);
    for (int i = 0; i < 1000; ++i) EXPECT_TRUE(simulator.step(1e-4).exact());
    return std::abs(pose.p.x() - start - 0.5 * (1 - std::cos(1.0)));
  };
  EXPECT_LT(error(""), 1e-7);
  EXPECT_LT(error("<joint type='slide' axis='0 0 1'/>"), 5e-5);
}

TEST(ImportMjcf, ValuesOfAxesAreThoseOfTheFileLessTheReference) {
  const ImportedModel model = world(
      "<body><joint name='j' range='-30 60' ref='15' stiffness='3' springref='45' damping='.5' "
      "frictionloss='.25'/>" +
      kBall + "</body>");
  const auto& axis = model.document["joints"][0]["axes"]["angle"];
  const double degree = std::numbers::pi / 180;
  EXPECT_NEAR(axis["limits"]["lower"].get<double>(), -45 * degree, 1e-15);
  EXPECT_NEAR(axis["limits"]["upper"].get<double>(), 45 * degree, 1e-15);
  EXPECT_NEAR(axis["spring"]["rest"].get<double>(), 30 * degree, 1e-15);
  EXPECT_EQ(axis["spring"]["stiffness"], 3);
  EXPECT_EQ(axis["spring"]["damping"], 0.5);
  EXPECT_EQ(axis["friction"]["static"], 0.25);
}

TEST(ImportMjcf, ContactTypesAndAffinitiesDecideWhoTouches) {
  Scene scene = scene_of(world(
      "<geom type='plane' size='1 1 1' contype='1' conaffinity='0'/>"
      "<body name='on' pos='0 0 .2'><freejoint/><geom size='.1' contype='0' conaffinity='1'/></body>"
      "<body name='through' pos='1 0 .2'><freejoint/><geom size='.1' contype='1' conaffinity='0'/></body>"));
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_NEAR(scene.world.pose(scene.world.body("on")).p.z(), 0.1, 1e-3);
  EXPECT_LT(scene.world.pose(scene.world.body("through")).p.z(), -0.5);
}

/// The usual form: no geom touches another but those of pairs.
TEST(ImportMjcf, NamedPairsTouchWhateverTheirMasks) {
  Scene scene = scene_of(
      imported("<default><geom contype='0' conaffinity='0'/></default><worldbody>"
               "<geom name='floor' type='plane' size='1 1 1'/>"
               "<body name='on' pos='0 0 .2'><freejoint/><geom name='g' size='.1'/></body>"
               "<body name='too' pos='1 0 .2'><freejoint/><geom name='h' size='.1'/></body>"
               "<body name='through' pos='2 0 .2'><freejoint/><geom name='i' size='.1'/></body>"
               "<body name='above' pos='0 0 .6'><freejoint/><geom name='j' size='.1'/></body></worldbody>"
               "<contact><pair geom1='floor' geom2='g'/><pair geom1='h' geom2='floor'/>"
               "<pair geom1='floor' geom2='j'/></contact>"));
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(simulator.step(1e-3).ok());
  const auto height = [&](const char* name) { return scene.world.pose(scene.world.body(name)).p.z(); };
  for (const char* name : {"on", "too", "above"}) EXPECT_NEAR(height(name), 0.1, 1e-3) << name;
  EXPECT_LT(height("through"), -0.5);
}

TEST(ImportMjcf, FrictionIsTheLargerOfBoth) {
  const ImportedModel model = world(
      "<geom type='plane' size='1 1 1' friction='.2'/>"
      "<body><freejoint/><geom size='.1' friction='.7 .01 .001' condim='6'/></body>");
  const auto& between = model.document["material_pairs"][0]["material"];
  EXPECT_EQ(between["dynamic_friction"], 0.7);
  EXPECT_EQ(between["spinning_friction"], 0.01);
  EXPECT_EQ(between["rolling_friction"], 0.001);
}

/// That of the geom with priority, were it the smaller one.
TEST(ImportMjcf, FrictionIsThatOfPriority) {
  const ImportedModel model = world(
      "<geom type='plane' size='1 1 1' friction='.2' priority='1'/>"
      "<body><freejoint/><geom size='.1' friction='.7 .01 .001' condim='6'/></body>");
  const auto& between = model.document["material_pairs"][0]["material"];
  EXPECT_EQ(between["dynamic_friction"], 0.2);
  EXPECT_FALSE(between.contains("rolling_friction"));
  EXPECT_FALSE(notes(model, "priority"));
}

/// What acts on c q acts on q: c times the force, c² times stiffness and damping.
TEST(ImportMjcf, ATendonOfOneJointActsOnIt) {
  const auto axis_of = [](const std::string& joint, const std::string& tendon) {
    const ImportedModel model = imported(
        "<compiler angle='radian'/><worldbody><body><joint name='j' axis='0 1 0' " + joint + "/>" + kBall +
        "</body></worldbody><tendon>\n<fixed " + tendon + "<joint joint='j' coef='-2'/></fixed></tendon>");
    (void)scene_of(model);
    const auto& json = model.document["joints"][0];
    return json.contains("axes") ? json["axes"]["angle"] : nlohmann::ordered_json::object();
  };
  auto axis = axis_of("range='-1 3'", "range='-4 1'>");
  EXPECT_EQ(axis["limits"]["lower"], -0.5);
  EXPECT_EQ(axis["limits"]["upper"], 2);
  axis = axis_of("", "limited='false' range='-4 1'>");
  EXPECT_FALSE(axis.contains("limits"));
  axis = axis_of("stiffness='4' springref='1' damping='1' frictionloss='3'",
                 "stiffness='3' springlength='.8' damping='2' frictionloss='5'>");
  EXPECT_EQ(axis["spring"]["stiffness"], 16);
  EXPECT_NEAR(axis["spring"]["rest"].get<double>(), (4 * 1 + 12 * -0.4) / 16, 1e-15);
  EXPECT_EQ(axis["spring"]["damping"], 9);
  EXPECT_EQ(axis["friction"]["static"], 13);
  expect_refused(
      "<compiler angle='radian'/><worldbody><body><joint name='j' range='0 1'/>" + kBall +
          "</body></worldbody><tendon><fixed range='2 3'><joint joint='j' coef='1'/></fixed></tendon>",
      "\"range\" and that of the joint exclude each other");
  const ImportedModel two =
      imported("<worldbody><body><joint name='j'/>" + kBall + "</body><body><joint name='k'/>" + kBall +
               "</body></worldbody><tendon>\n<fixed range='0 1'><joint joint='j' coef='1'/><joint joint='k' "
               "coef='1'/></fixed>"
               "</tendon>");
  EXPECT_TRUE(notes(two, "m.xml:3: <fixed> of several joints: range, stiffness"));
}

TEST(ImportMjcf, ConnectWeldAndJointEqualities) {
  const ImportedModel model = imported(
      "<worldbody><body name='a'><joint name='i' axis='0 1 0'/><geom size='.1' pos='0 0 -1'/></body>"
      "<body name='b' pos='1 0 0'><joint name='j' axis='0 1 0'/><geom size='.1' pos='0 0 -1'/></body>"
      "<body name='c' pos='2 0 0'><freejoint/><geom size='.1'/></body></worldbody><equality>"
      "<connect name='u' body1='a' body2='b' anchor='0 0 -1'/><weld name='v' body1='b' body2='c' "
      "active='false'/>"
      "<joint name='w' joint1='j' joint2='i' polycoef='0 -3 0 0 0'/></equality>");
  const Scene scene = scene_of(model);
  EXPECT_EQ(scene.world.joint(scene.world.joint("u")).type(), "ball");
  EXPECT_EQ(scene.world.joint(scene.world.joint("v")).type(), "fixed");
  EXPECT_FALSE(scene.world.is_attached(scene.world.joint("v")));
  EXPECT_EQ(scene.world.joint(scene.world.joint("w")).type(), "gear");
  EXPECT_EQ(model.document["joints"][4]["ratio"], -3);
  EXPECT_FALSE(scene.assemble);
}

TEST(ImportMjcf, SitesThatAreApartAreBroughtTogether) {
  const ImportedModel model = imported(
      "<worldbody><site name='s' pos='0 0 1'/><body name='a' pos='.2 0 0'><freejoint/><geom size='.1'/><site "
      "name='t' pos='0 0 1'/>"
      "</body></worldbody><equality><weld site1='s' site2='t'/></equality>");
  Scene scene = scene_of(model);
  ASSERT_TRUE(scene.assemble);
  Simulator simulator(scene.world, scene.settings);
  ASSERT_TRUE(simulator.assemble().exact());
  EXPECT_LT(scene.world.pose(scene.world.body("a")).p.norm(), 1e-9);
}

/// Of these two geoms, and not of others of their bodies.
TEST(ImportMjcf, APairHasItsOwnFriction) {
  const ImportedModel model = imported(
      "<worldbody><geom name='floor' type='plane' size='1 1 1' friction='0.9'/><body pos='0 0 1'><freejoint/>"
      "<geom name='g' size='.1'/><geom name='h' size='.1' pos='1 0 0'/></body></worldbody>"
      "<contact><pair geom1='floor' geom2='g' condim='6' friction='.2 .3 .01 .002 .002'/></contact>");
  EXPECT_TRUE(notes(model, "\"friction\" of <pair> that differs by direction: the first number is taken"));
  const Scene scene = scene_of(model);
  const World& w = scene.world;
  ASSERT_EQ(w.shape_count(), 3);
  const auto between = [&](int a, int b) { return w.contact_material(ShapeId{a}, ShapeId{b}); };
  EXPECT_EQ(between(0, 1).dynamic_friction, 0.2);
  EXPECT_EQ(between(0, 1).static_friction, 0.2);
  EXPECT_EQ(between(0, 1).spinning_friction, 0.01);
  EXPECT_EQ(between(0, 1).rolling_friction, 0.002);
  EXPECT_EQ(between(0, 2).dynamic_friction, 1);  // the larger one
}

/// MuJoCo does not ask the geoms of a pair for their friction: what the pair does not say is 1, 0.005,
/// 0.0001.
TEST(ImportMjcf, WhatAPairDoesNotSayIsMuJoCosOwn) {
  const auto material = [](const std::string& pair) {
    const Scene scene = scene_of(imported(
        "<worldbody><geom name='floor' type='plane' size='1 1 1'/><body pos='0 0 1'><freejoint/><geom "
        "name='g' size='.1' condim='6' friction='.7 .02 .003'/></body></worldbody><contact><pair "
        "geom1='floor' geom2='g' " +
        pair + "/></contact>"));
    return scene.world.contact_material(ShapeId{0}, ShapeId{1});
  };
  EXPECT_EQ(material("").dynamic_friction, 1);
  EXPECT_EQ(material("").spinning_friction, 0);
  EXPECT_EQ(material("friction='0.9'").dynamic_friction, 0.9);
  EXPECT_EQ(material("friction='0.9'").rolling_friction, 0);
  EXPECT_EQ(material("condim='6'").spinning_friction, 0.005);
  EXPECT_EQ(material("condim='6'").rolling_friction, 0.0001);
}

/// Surfaces with the same numbers need no entry for each two of them.
TEST(ImportMjcf, ManyPairsAreNotWrittenTwoByTwo) {
  std::string bodies, pairs;
  for (int i = 0; i < 40; ++i) {
    const std::string number = std::to_string(i);
    bodies += "<body pos='" + number + " 0 1'><freejoint/><geom size='.1' name='g" + number + "'/></body>";
    pairs += "<pair geom1='floor' geom2='g" + number + "' friction='.3'/>";
  }
  const ImportedModel model = imported("<worldbody><geom name='floor' type='plane' size='1 1 1'/>" + bodies +
                                       "</worldbody><contact>" + pairs + "</contact>");
  EXPECT_EQ(model.document["material_pairs"].size(), 40u);
  const Scene scene = scene_of(model);
  EXPECT_EQ(scene.world.contact_material(ShapeId{0}, ShapeId{1}).dynamic_friction, 0.3);
  EXPECT_EQ(scene.world.contact_material(ShapeId{1}, ShapeId{2}).dynamic_friction, 1);
}

/// A weld holds what its bodies' contact would push apart.
TEST(ImportMjcf, WeldedBodiesDoNotTouch) {
  const ImportedModel model = imported(
      "<worldbody><body name='a'><freejoint/><geom size='1'/></body><body name='b' pos='1.5 0 0'><freejoint/>"
      "<geom size='1'/></body></worldbody><equality><weld body1='a' body2='b'/></equality>");
  EXPECT_TRUE(notes(model, "\"a\" and \"b\" are welded: they do not touch each other"));
  Scene scene = scene_of(model);
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
}

const std::string kDriven = "<worldbody><body><joint name='j' axis='0 1 0' ref='0.5'/>" + kBall +
                            "</body><body pos='1 0 0'><joint name='k' axis='0 1 0'/>" + kBall +
                            "</body></worldbody>";
nlohmann::ordered_json motor_of(const ImportedModel& model, int joint) {
  return model.document["joints"][joint]["axes"]["angle"]["motor"];
}

/// The unit of angles is none of controls'.
TEST(ImportMjcf, ActuatorsAreMotors) {
  const std::string actuators =
      "<compiler angle='radian'/><actuator><position name='p' joint='j' kp='4' kv='.5' gear='2' "
      "forcerange='-3 3'/>"
      "<general name='g' joint='k' gainprm='6' biastype='affine' biasprm='1 0 -2 0 0 0 0 0 0 0'/></actuator>";
  const ImportedModel still = imported(kDriven + actuators);
  EXPECT_EQ(motor_of(still, 0),
            (nlohmann::ordered_json{
                {"position", -0.5}, {"stiffness", 16.0}, {"damping", 2.0}, {"max_force", 6.0}}));
  EXPECT_EQ(motor_of(still, 1), (nlohmann::ordered_json{{"velocity", 0.5}, {"damping", 2.0}}));
  EXPECT_TRUE(notes(still, "<position> \"p\": a motor of its joint, with a control of 0"));
  (void)scene_of(still);
  const ImportedModel driven = imported(kDriven + actuators + "<keyframe><key ctrl='3 0.5'/></keyframe>");
  EXPECT_EQ(motor_of(driven, 0)["position"], 3.0 / 2 - 0.5);
  EXPECT_EQ(motor_of(driven, 1)["velocity"], (6 * 0.5 + 1) / 2);
  EXPECT_TRUE(notes(driven, "<position> \"p\": a motor of its joint, with a control of 3"));
}

/// A key that starts elsewhere is none of the start's; controls keep to their range.
TEST(ImportMjcf, ControlsAreThoseOfTheStart) {
  const auto with = [](const std::string& keys) {
    return imported(kDriven +
                    "<actuator><motor name='m' joint='j' ctrlrange='-2 2' gear='5'/><damper name='d' "
                    "joint='k' kv='3'/></actuator><keyframe>" +
                    keys + "</keyframe>");
  };
  const ImportedModel still = with("<key qpos='1 1' ctrl='1 1'/>");
  EXPECT_TRUE(notes(still, "<motor> \"m\": without a control it does nothing"));
  EXPECT_TRUE(notes(still, "<key>: the model starts as without it"));
  // One that says where it starts anyhow, at the reference of the first joint, is one of the start.
  EXPECT_EQ(motor_of(with("<key qpos='0.00872664625997165 0' qvel='0 0' ctrl='1 1'/>"), 0)["max_force"], 5);
  // At rest rather than in motion.
  const ImportedModel moving = with("<key qvel='0 1' ctrl='2 1'/>");
  EXPECT_EQ(motor_of(moving, 0)["max_force"], 10);
  EXPECT_TRUE(notes(moving, "<key>: the model starts with its velocities"));
  const ImportedModel both = with("<key qvel='0 1' ctrl='2 1'/><key ctrl='1 1'/>");
  EXPECT_EQ(motor_of(both, 0)["max_force"], 5);
  EXPECT_TRUE(notes(both, "<key>: the model starts as without it"));
  EXPECT_FALSE(both.document["bodies"][0].contains("velocity"));
  EXPECT_TRUE(notes(with("<key qvel='1'/>"), "has not as many numbers as the joints have"));
  const ImportedModel pushed = with("<key qpos='1 1' ctrl='1 1'/><key ctrl='-7 0.5'/>");
  EXPECT_EQ(motor_of(pushed, 0), (nlohmann::ordered_json{{"velocity", -1e6}, {"max_force", 10.0}}));
  EXPECT_EQ(motor_of(pushed, 1), (nlohmann::ordered_json{{"velocity", 0.0}, {"damping", 1.5}}));
  // A force of 10 N m on the ball about its diameter, at rest: α = M/I.
  Scene scene = scene_of(pushed);
  scene.world.set_gravity(Vec3::Zero());
  Simulator simulator(scene.world, scene.settings);
  ASSERT_TRUE(simulator.step(1e-3).exact());
  const double inertia = scene.world.mass_properties(BodyId{1}).inertia_B()(1, 1);
  EXPECT_NEAR(scene.world.twist(BodyId{1}).w.y(), -10 / inertia * 1e-3, 1e-9 / inertia);
  EXPECT_TRUE(notes(with("<key ctrl='1'/>"), "has not as many numbers as there are actuators"));
}

TEST(ImportMjcf, TendonsOfOneOrTwoJoints) {
  const auto with = [](const std::string& rest) {
    return imported(kDriven +
                    "<compiler angle='radian'/><tendon><fixed name='one'><joint joint='j' coef='3'/></fixed>"
                    "<fixed name='two'><joint joint='j' coef='2'/><joint joint='k' coef='.5'/></fixed>"
                    "</tendon>" +
                    rest);
  };
  // 2 j + ½ k stays as it is.
  const ImportedModel geared = with("<equality><tendon name='g' tendon1='two'/></equality>");
  const auto& gear = geared.document["joints"][2];
  EXPECT_EQ(gear["type"], "gear");
  EXPECT_EQ(gear["driven"]["joint"], "j");
  EXPECT_EQ(gear["driving"]["joint"], "k");
  EXPECT_EQ(gear["ratio"], -0.25);
  (void)scene_of(geared);
  const ImportedModel held = with("<equality><tendon tendon1='one' polycoef='.3 1 0 0 0'/></equality>");
  EXPECT_EQ(held.document["joints"][2]["type"], "driver");
  EXPECT_NEAR(held.document["joints"][2]["motion"]["linear"]["value"].get<double>(), 0.1, 1e-15);
  (void)scene_of(held);
  // 3 j = 2 (2 j + ½ k) + const: j = −k + const.
  const ImportedModel both =
      with("<equality><tendon tendon1='one' tendon2='two' polycoef='0 2 0 0 0'/></equality>");
  const auto& relation = both.document["joints"][2];
  EXPECT_EQ(relation["type"], "gear");
  EXPECT_EQ(relation["driven"]["joint"], "j");
  EXPECT_EQ(relation["driving"]["joint"], "k");
  EXPECT_EQ(relation["ratio"], -1);
  (void)scene_of(both);
  EXPECT_TRUE(notes(with("<equality><tendon tendon1='one' tendon2='two' polycoef='0 1 .5 0 0'/></equality>"),
                    "a relation of tendons that is not linear"));
  EXPECT_TRUE(notes(with("<equality><tendon tendon1='one' tendon2='one'/></equality>"),
                    "a relation of 0 joints that is no gear and no differential"));
  // A force along 3 j is three times that on j, by which its stiffness is nine times that of j.
  const ImportedModel driven = with(
      "<actuator><position name='p' tendon='one' kp='4' gear='2' forcerange='-3 3'/></actuator>"
      "<sensor><actuatorfrc name='f' actuator='p'/></sensor>");
  EXPECT_EQ(motor_of(driven, 0)["stiffness"], 4.0 * 36);
  EXPECT_EQ(motor_of(driven, 0)["max_force"], 3.0 * 6);
  ASSERT_EQ(driven.document["probes"].size(), 1U);
  EXPECT_EQ(driven.document["probes"][0]["quantity"], "axis-force");
  EXPECT_EQ(driven.document["probes"][0]["axis"]["joint"], "j");
  (void)scene_of(driven);
  EXPECT_TRUE(notes(with("<actuator><motor name='m' tendon='two'/></actuator>"),
                    "has no counterpart: it does nothing"));
  EXPECT_TRUE(
      notes(with("<sensor><actuatorfrc actuator='m'/></sensor>"), "names \"m\", which has no counterpart"));
}

/// Three hinges turn as those of a differential if a tendon of one of them is the mean of the others, or else
/// are named with file and line.
TEST(ImportMjcf, TendonsOfThreeJoints) {
  const auto with = [](const std::string& mean) {
    std::string bodies;
    for (const char* name : {"c", "l", "r"})
      bodies += std::string("<body><joint name='") + name + "'/>" + kBall + "</body>";
    return imported("<worldbody>" + bodies +
                    "</worldbody><tendon><fixed name='case'><joint joint='c' coef='1'/></fixed>\n"
                    "<fixed name='shafts'><joint joint='l' coef='.5'/><joint joint='r' coef='.5'/></fixed>"
                    "</tendon><equality><tendon tendon1='case' tendon2='shafts' polycoef='" +
                    mean + "'/></equality>");
  };
  const ImportedModel model = with("0 1 0 0 0");
  EXPECT_EQ(model.document["joints"][3]["type"], "differential");
  EXPECT_EQ(model.document["joints"][3]["input"]["joint"], "c");
  (void)scene_of(model);
  EXPECT_TRUE(
      notes(with("0 2 0 0 0"),
            "m.xml:3: a relation of 3 joints that is no gear and no differential: has no counterpart"));
}

/// A wire between two sites that keeps its length is a bar.
TEST(ImportMjcf, AWireOfConstantLengthIsABar) {
  const auto with = [](const std::string& sites, const std::string& rest) {
    return imported("<worldbody><site name='a' pos='0 0 2'/><body name='b'><freejoint/><site name='c'/>" +
                    kBall + "</body></worldbody><tendon><spatial name='w'>" + sites + "</spatial></tendon>" +
                    rest);
  };
  const std::string two = "<site site='a'/><site site='c'/>",
                    equality = "<equality><tendon name='e' tendon1='w'/></equality>";
  const ImportedModel model = with(two, equality);
  ASSERT_EQ(model.document["joints"].size(), 1U);
  EXPECT_EQ(model.document["joints"][0]["type"], "distance");
  EXPECT_EQ(model.document["joints"][0]["length"], 2);
  EXPECT_FALSE(notes(model, "neither limits nor pulls"));
  Scene scene = scene_of(model);
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(simulator.step(1e-2).exact());
  EXPECT_NEAR(scene.world.pose(BodyId{1}).p.z(), 0, 1e-9);
  EXPECT_TRUE(notes(with(two, ""), "neither limits nor pulls"));
  EXPECT_TRUE(notes(with(two + "<site site='a'/>", equality), "over several sites"));
}

/// A tackle: 2 kg on one side balance 4 kg on the other, which counts twice; 5 kg there fall by half of what
/// the other side rises: (5 − 4) g = (5 + 2² 2) times their acceleration.
TEST(ImportMjcf, AWireOverAPulley) {
  const auto with = [](const std::string& branches, const std::string& equality, double mass) {
    const auto weight = [](const char* name, const char* at, double m) {
      return std::string("<body name='") + name + "' pos='" + at +
             "'><joint type='slide' axis='0 0 1'/><site name='" + name + "'/><geom size='.1' mass='" +
             std::to_string(m) + "' contype='0'/></body>";
    };
    return imported(
        "<option gravity='0 0 -10'/><worldbody><site name='c1' pos='0 0 2'/><site name='c2' pos='1 0 2'/>" +
        weight("a", "0 0 0", 2) + weight("b", "1 0 1", mass) + "</worldbody><tendon>\n<spatial name='w'>" +
        branches + "</spatial></tendon>" + equality);
  };
  const std::string
      wire = "<site site='a'/><site site='c1'/><pulley divisor='0.5'/><site site='c2'/><site site='b'/>",
      other_way =
          "<pulley divisor='2'/><site site='c1'/><site site='a'/><pulley divisor='1'/>"
          "<site site='b'/><site site='c2'/>",
      equality = "<equality><tendon tendon1='w'/></equality>";
  for (const std::string& branches : {wire, other_way}) {
    const ImportedModel model = with(branches, equality, 4);
    ASSERT_EQ(model.document["joints"].size(), 3U);
    EXPECT_EQ(model.document["joints"][2]["type"], "pulley");
    EXPECT_EQ(model.document["joints"][2]["ratio"], 2);
    EXPECT_EQ(model.document["joints"][2]["length"], 4);
    for (const double mass : {4.0, 5.0}) {
      Scene scene = scene_of(with(branches, equality, mass));
      Simulator simulator(scene.world, scene.settings);
      for (int i = 0; i < 50; ++i) ASSERT_TRUE(simulator.step(1e-2).exact());
      const double a = (mass - 4) * 10 / (mass + 8), fall = 0.5 * a * 0.25;
      EXPECT_NEAR(scene.world.pose(scene.world.body("b")).p.z(), 1 - fall, 1e-9);
      EXPECT_NEAR(scene.world.pose(scene.world.body("a")).p.z(), 2 * fall, 1e-9);
    }
  }
  EXPECT_TRUE(notes(with(wire, "", 4), "m.xml:3: a tendon that neither limits nor pulls"));
  EXPECT_TRUE(notes(with(wire + "<pulley divisor='2'/><site site='a'/><site site='c1'/>", equality, 4),
                    "m.xml:3: a tendon with <pulley> that is not two branches of two sites each"));
  EXPECT_TRUE(
      notes(with("<site site='a'/><site site='c1'/><pulley/><site site='a'/><site site='c2'/>", equality, 4),
            "m.xml:3: a tendon with <pulley> whose branches do not meet at one body"));
  expect_refused("<tendon><spatial><pulley divisor='0'/></spatial></tendon>", "\"divisor\" must be positive");
}

/// Rates of all kinds of joints, of a body between two of them, and of an armature.
TEST(ImportMjcf, VelocitiesAreThoseOfTheKey) {
  const ImportedModel model = imported(
      "<compiler angle='radian'/><worldbody>"
      "<body name='free' pos='0 5 0' euler='0 0 1.5707963267948966'><freejoint/>" +
      kBall +
      "</body><body name='arm' pos='1 0 0'><joint name='hip' pos='-1 0 0' axis='0 0 1' armature='.3'/>" +
      kBall +
      "<body name='hand' pos='1 0 0'><joint name='x' type='slide' axis='1 0 0'/>"
      "<joint name='knee' axis='0 0 1'/><joint name='bend' axis='0 1 0' pos='-.5 0 0'/>" +
      kBall + "</body></body><body name='globe' pos='0 0 3'><joint type='ball' pos='0 0 1'/>" + kBall +
      "</body></worldbody><keyframe><key qvel='1 2 3 4 5 6  2 .5 3 7  .1 .2 .3'/></keyframe>");
  const Scene scene = scene_of(model);
  const World& w = scene.world;
  const auto twist = [&](const char* name) { return w.twist(w.body(name)); };
  EXPECT_LT((twist("free").v - Vec3(1, 2, 3)).norm(), 1e-15);
  EXPECT_LT((twist("free").w - Vec3(-5, 4, 6)).norm(), 1e-14);
  EXPECT_LT((twist("arm").v - Vec3(0, 2, 0)).norm(), 1e-15);
  EXPECT_LT((twist("arm").w - Vec3(0, 0, 2)).norm(), 1e-15);
  // 2 m from the hip, sliding by .5, turning by 3 about itself, and by 7 about y half a metre behind it.
  EXPECT_LT((twist("hand").w - Vec3(0, 7, 5)).norm(), 1e-14);
  EXPECT_LT((twist("hand").v - Vec3(.5, 4, -3.5)).norm(), 1e-14);
  EXPECT_LT((twist("globe").w - Vec3(.1, .2, .3)).norm(), 1e-15);
  EXPECT_LT((twist("globe").v - Vec3(.1, .2, .3).cross(Vec3(0, 0, -1))).norm(), 1e-15);
  EXPECT_NEAR(twist("hip_armature").v.norm(), 2, 1e-14);
  EXPECT_TRUE(forbidden_velocity(w).empty());
}

/// A position's damping as a part of what is critical for what its joint moves, with a gear and an armature.
TEST(ImportMjcf, DampingRatioIsThatOfTheJoint) {
  const auto damping = [](const std::string& joint, const std::string& actuator) {
    const ImportedModel model =
        imported("<worldbody><body><joint name='j' " + joint + "/>" + kBall + "<body pos='0 0 -2'>" + kBall +
                 "</body></body></worldbody><actuator><position name='p' joint='j' kp='8' " + actuator +
                 "/></actuator>");
    const auto axes = model.document["joints"][0]["axes"];
    return axes.begin().value()["motor"]["damping"].get<double>();
  };
  const double sphere = 0.4 * 2 * 0.01, turned = sphere + sphere + 2 * 4;  // both are 2 kg, one 2 m away
  EXPECT_NEAR(damping("axis='0 1 0'", "dampratio='1'"), 2 * std::sqrt(8 * turned), 1e-12 * turned);
  EXPECT_NEAR(damping("axis='0 1 0' armature='3'", "dampratio='.5'"), std::sqrt(8 * (turned + 3)), 1e-11);
  EXPECT_NEAR(damping("axis='0 0 1'", "dampratio='2'"), 4 * std::sqrt(8 * 2 * sphere), 1e-12);
  EXPECT_NEAR(damping("axis='0 0 1' type='slide'", "dampratio='1'"), 2 * std::sqrt(8 * 4.0), 1e-12);
  // A gear g makes the stiffness g² kp at the joint, and the damping critical for that.
  EXPECT_NEAR(damping("axis='0 1 0'", "dampratio='1' gear='-3'"), 2 * std::sqrt(9 * 8 * turned), 1e-11);
  EXPECT_EQ(damping("axis='0 1 0'", "kv='5'"), 5);
  EXPECT_THROW((void)damping("axis='0 1 0'", "kv='5' dampratio='1'"), ImportError);
}

/// T and ζ of a mass on a spring and damper: k = m/(T ζ)², c = 2 m/T, in place of what is given.
TEST(ImportMjcf, SpringDamperIsThatOfTheMass) {
  const auto spring = [](const std::string& joint) {
    const ImportedModel model = imported("<worldbody><body><joint name='j' stiffness='7' damping='8' " +
                                         joint + "/>" + kBall + "</body></worldbody>");
    return model.document["joints"][0]["axes"].begin().value()["spring"];
  };
  const auto slide = spring("type='slide' axis='0 0 1' springdamper='.1 2'");
  EXPECT_NEAR(slide["stiffness"].get<double>(), 2 / 0.04, 1e-12);
  EXPECT_NEAR(slide["damping"].get<double>(), 2 * 2 / 0.1, 1e-12);
  const auto hinge = spring("axis='0 1 0' armature='1' springdamper='.5 1'");
  EXPECT_NEAR(hinge["stiffness"].get<double>(), (0.4 * 2 * 0.01 + 1) / 0.25, 1e-12);
  EXPECT_EQ(spring("axis='0 1 0'")["stiffness"], 7);
  EXPECT_THROW((void)spring("axis='0 1 0' springdamper='.5 0'"), ImportError);
}

/// Controls keep to the range of the joint, where they inherit it, unless nothing keeps them.
TEST(ImportMjcf, ControlsInheritTheRangeOfTheJoint) {
  const auto position = [](const std::string& actuator, const std::string& option = "") {
    const ImportedModel model = imported("<compiler angle='radian'/>" + option +
                                         "<worldbody><body><joint name='j' axis='0 1 0' range='-1 3'/>" +
                                         kBall + "</body></worldbody><actuator><position joint='j' kp='8' " +
                                         actuator + "/></actuator><keyframe><key ctrl='9'/></keyframe>");
    return motor_of(model, 0)["position"].get<double>();
  };
  EXPECT_EQ(position(""), 9);
  EXPECT_EQ(position("inheritrange='1'"), 3);
  EXPECT_EQ(position("inheritrange='.5'"), 2);
  EXPECT_EQ(position("ctrlrange='-4 5'"), 5);
  const std::string unclamped = "<option><flag clampctrl='disable'/></option>";
  EXPECT_EQ(position("inheritrange='1'", unclamped), 9);
  EXPECT_EQ(position("ctrlrange='-4 5'", unclamped), 9);
  EXPECT_THROW((void)position("ctrlrange='-4 5' inheritrange='1'"), ImportError);
  EXPECT_THROW((void)imported(kDriven + "<actuator><position joint='j' inheritrange='1'/></actuator>"),
               ImportError);
}

TEST(ImportMjcf, ActuatorsOfDisabledGroupsDoNothing) {
  const ImportedModel model =
      imported("<option actuatorgroupdisable='1 4'/>" + kDriven +
               "<actuator><position name='p' joint='j' group='4'/><position name='q' joint='k' group='2'/>"
               "</actuator>");
  EXPECT_FALSE(model.document["joints"][0].contains("axes"));
  EXPECT_TRUE(model.document["joints"][1].contains("axes"));
  EXPECT_TRUE(notes(model, "<position> \"p\": its group is disabled: it does nothing"));
}

/// A constant force keeps to its range, whose ends need not be opposite.
TEST(ImportMjcf, ConstantForcesKeepToTheirRange) {
  const auto force = [](const std::string& motor, const std::string& control) {
    const auto json = motor_of(imported(kDriven + "<actuator><motor joint='j' " + motor +
                                        "/></actuator><keyframe><key ctrl='" + control + "'/></keyframe>"),
                               0);
    return json.is_null() ? 0.0 : json["max_force"].get<double>() * (json["velocity"] > 0 ? 1 : -1);
  };
  EXPECT_EQ(force("forcerange='-1 100'", "-50"), -1);
  EXPECT_EQ(force("forcerange='-1 100'", "50"), 50);
  EXPECT_EQ(force("forcerange='5 100'", "0"), 5);
  EXPECT_EQ(force("forcerange='-1 100' gear='-2'", "-50"), 2);
}

/// What a joint lets its actuators give.
TEST(ImportMjcf, JointsBoundTheirActuators) {
  const auto motor = [](const std::string& actuator) {
    return motor_of(imported("<worldbody><body><joint name='j' axis='0 1 0' actuatorfrcrange='-1 1'/>" +
                             kBall + "</body></worldbody><actuator>" + actuator +
                             "</actuator><keyframe><key ctrl='2'/></keyframe>"),
                    0);
  };
  EXPECT_EQ(motor("<position joint='j' kp='50'/>")["max_force"], 1);
  EXPECT_EQ(motor("<position joint='j' kp='50' forcerange='-.5 .5'/>")["max_force"], 0.5);
  EXPECT_EQ(motor("<motor joint='j'/>")["max_force"], 1);
}

/// Forces that follow their control later, and those that the file has switched off.
TEST(ImportMjcf, ActuatorsThatDoNotActAtOnceAreLeftOut) {
  const std::string key = "<keyframe><key ctrl='1'/></keyframe>";
  for (const std::string actuator :
       {"<general name='a' joint='j' gainprm='5' dyntype='integrator'/>",
        "<general name='a' joint='j' gainprm='5' dyntype='filter' dynprm='0.1'/>",
        "<position name='a' joint='j' kp='5' timeconst='0.1'/>"}) {
    const ImportedModel model = imported(kDriven + "<actuator>" + actuator + "</actuator>" + key);
    EXPECT_FALSE(model.document["joints"][0].contains("axes")) << actuator;
    EXPECT_TRUE(notes(model, "\"a\": has no counterpart: it does nothing")) << actuator;
  }
  const ImportedModel off = imported("<option><flag actuation='disable'/></option>" + kDriven +
                                     "<actuator><motor name='a' joint='j'/></actuator>" + key);
  EXPECT_FALSE(off.document["joints"][0].contains("axes"));
}

TEST(ImportMjcf, WhatIsNoMotorIsNamed) {
  const ImportedModel model =
      imported(kDriven +
               "<actuator><position name='p' joint='j' kp='4' forcerange='-1 3'/>"
               "<position name='q' joint='j' kp='4'/>"
               "<general name='g' joint='k' biastype='affine' biasprm='0 1 0'/></actuator>");
  EXPECT_TRUE(notes(model, "\"forcerange\" that is not symmetric: its larger end is taken both ways"));
  EXPECT_TRUE(notes(model, "<position> \"q\": acts on a joint that another one drives"));
  EXPECT_TRUE(notes(model, "<general> \"g\": a bias that is no spring: has no counterpart"));
}

TEST(ImportMjcf, TendonsOfSitesAreRopesAndSprings) {
  const ImportedModel model =
      imported("<worldbody><site name='s'/><body pos='0 0 -1' name='b'><freejoint/>" + kBall +
               "<site name='t'/></body></worldbody><tendon>"
               "<spatial name='rope' range='0 2'><site site='s'/><site site='t'/></spatial>"
               "<spatial name='spring' stiffness='10' damping='1' springlength='.5'><site site='s'/><site "
               "site='t'/></spatial></tendon>");
  EXPECT_EQ(model.document["joints"][0]["type"], "rope");
  EXPECT_EQ(model.document["joints"][0]["length"], 2);
  EXPECT_EQ(model.document["forces"][0]["rest_length"], 0.5);
  (void)scene_of(model);
}

TEST(ImportMjcf, SensorsAreProbes) {
  const ImportedModel model = imported(
      "<worldbody><body name='b'><joint name='j'/><geom size='.1' pos='1 0 0'/><site name='s' pos='0 0 "
      "1'/></body></worldbody><sensor>"
      "<jointpos name='angle' joint='j'/><framepos name='tip' objtype='site' objname='s'/><force "
      "site='s'/><magnetometer site='s'/></sensor>");
  const Scene scene = scene_of(model);
  ASSERT_EQ(scene.probes.size(), 3u);
  EXPECT_EQ(scene.probes[0].name, "angle");
  EXPECT_LT((scene.probes[1].point_B - Vec3(-1, 0, 1)).norm(), 1e-15);
  EXPECT_TRUE(notes(model, "<magnetometer>: this sensor has no counterpart"));
}

TEST(ImportMjcf, CompilerSettlesMasses) {
  const auto mass = [](const std::string& compiler, const std::string& body) {
    const ImportedModel model =
        imported("<compiler " + compiler + "/><worldbody><body><freejoint/>" + body + "</body></worldbody>");
    const Scene scene = scene_of(model);
    return scene.world.mass_properties(BodyId{1});
  };
  EXPECT_NEAR(mass("settotalmass='5'", kBall).mass(), 5, 1e-14);
  EXPECT_NEAR(mass("boundmass='3'", kBall).mass(), 3, 1e-14);
  const std::string skew = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 4'/>";
  EXPECT_NEAR(mass("balanceinertia='true'", skew).principal_moments()[0], 2, 1e-14);
  EXPECT_NEAR(mass("inertiafromgeom='true'", skew + kBall).mass(), 2, 1e-14);
  EXPECT_NEAR(mass("inertiagrouprange='1 2'", kBall + "<geom size='.1' mass='7' group='1'/>").mass(), 7,
              1e-14);
}

/// An L of four unit cubes; MuJoCo 4.0 counts its hollow twice unless told otherwise.
TEST(ImportMjcf, MeshesWeighAsTheyAreToldTo) {
  const auto mass = [](const std::string& kind) {
    const ImportedModel model =
        imported("<asset><mesh name='L' " + kind +
                 " vertex='0 0 0 2 0 0 2 1 0 1 1 0 1 3 0 0 3 0 0 0 1 2 0 1 2 1 1 1 1 1 1 3 1 0 3 1' face='0 "
                 "2 1 6 7 8 0 3 2 6 8 9 0 4 3 "
                 "6 9 10 0 5 4 6 10 11 0 1 7 0 7 6 1 2 8 1 8 7 2 3 9 2 9 8 3 4 10 3 10 9 4 5 11 4 11 10 5 0 "
                 "6 5 6 11'/></asset>"
                 "<worldbody><body><freejoint/><geom type='mesh' mesh='L' density='1'/></body></worldbody>");
    const Scene scene = scene_of(model);
    return std::pair(scene.world.mass_properties(BodyId{1}), scene.world.pose(BodyId{1}).p);
  };
  Mat3 exact, legacy;
  exact << 3 + 5.0 / 12, 0.75, 0, 0.75, 1 + 5.0 / 12, 0, 0, 0, 4 + 1.0 / 6;
  legacy << 3.43066, 0.76779, 0, 0.76779, 1.4862, 0, 0, 0, 4.23405;
  EXPECT_NEAR(mass("inertia='exact'").first.mass(), 4, 1e-14);
  EXPECT_LT((mass("inertia='exact'").second - Vec3(0.75, 1.25, 0.5)).norm(), 1e-14);
  EXPECT_LT((mass("inertia='exact'").first.inertia_B() - exact).norm(), 1e-14);
  EXPECT_NEAR(mass("inertia='convex'").first.mass(), 5, 1e-14);
  EXPECT_NEAR(mass("").first.mass(), 4.161340544083907, 1e-6);  // in single precision there
  EXPECT_LT((mass("").second - Vec3(0.77519666, 1.24201082, 0.5)).norm(), 1e-6);
  EXPECT_LT((mass("").first.inertia_B() - legacy).norm(), 2e-5);
}

TEST(ImportMjcf, WhatIsWrongIsNamedWithFileAndLine) {
  const auto body = [](const std::string& inside) {
    return "<worldbody><body>" + inside + "</body></worldbody>";
  };
  expect_refused(body("<joint/>"), "m.xml:2: \"\" moves, and has no mass (value: 0 kg)");
  expect_refused(body("<joint/><geom/>"), "\"size\" must have 1 number(s)");
  expect_refused(body("<joint/><geom size='-1'/>"), "\"size\" must be positive (value: -1)");
  expect_refused(body("<joint type='screw'/>" + kBall), "unknown type of joint (value: screw)");
  expect_refused(body("<joint range='1 0'/>" + kBall), "\"range\" must be two numbers that increase");
  expect_refused(body("<joint/><geom class='no' size='.1'/>"),
                 "there is no default class of this name (value: no)");
  expect_refused(body("<joint/><geom type='mesh' mesh='no'/>"), "there is none of this name (value: no)");
  expect_refused("<equality><connect body1='no' anchor='0 0 0'/></equality>",
                 "names nothing that is there (value: no)");
  expect_refused("<include file='no.xml'/>", "the included file cannot be read");
  expect_refused("<compiler eulerseq='xy'/>", "must be three of x, y, z (value: xy)");
  expect_refused("<worldbody><replicate count='1e9'><geom size='.1'/></replicate></worldbody>",
                 "from 1 to 200000");
}

}  // namespace
}  // namespace taut::mjcf_test
