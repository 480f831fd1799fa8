#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <pugixml.hpp>
#include <regex>
#include <sstream>

#include "scenes/files/scene_file.h"
#include "scenes/import/imported_model.h"
#include "solvers/simulator/simulator.h"
#include "tests/scenes/import/corpus_checker.h"
#include "tests/scenes/import/text_checks.h"

// What SDF says, and what the scene has.
namespace taut::sdf_test {
namespace {

using testing::notes;

const std::string kBar =
    "<inertial><pose>0 0 -0.5 0 0 0</pose><mass>2</mass><inertia><ixx>0.2</ixx><iyy>0.2</iyy><izz>0.01</izz>"
    "</inertia></inertial>";

std::string link(const std::string& name, const std::string& pose = "0 0 0 0 0 0",
                 const std::string& inside = kBar) {
  return "<link name='" + name + "'><pose>" + pose + "</pose>" + inside + "</link>\n";
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& inside = "<axis><xyz>0 1 0</xyz></axis>") {
  return "<joint name='" + name + "' type='" + type + "'><parent>" + parent + "</parent><child>" + child +
         "</child>" + inside + "</joint>\n";
}
ImportedModel imported(const std::string& inside) {
  return import_model_text("<sdf version='1.7'><model name='m'>\n" + inside + "</model></sdf>", "m.sdf");
}
Scene scene_of(const ImportedModel& model) { return parse_scene(model.document.dump(), "m.sdf"); }

void expect_refused(const std::string& inside, const std::string& message) {
  testing::expect_refused([&] { return imported(inside); }, message);
}

TEST(ImportSdf, PosesAreRelativeToWhatTheyName) {
  const ImportedModel model = imported("<frame name='f'><pose>1 0 0 0 0 1.5707963267948966</pose></frame>" +
                                       link("a") + "<link name='b'><pose relative_to='f'>0 2 0 0 0 0</pose>" +
                                       kBar + "</link>" + joint("j", "fixed", "world", "a", ""));
  const Scene scene = scene_of(model);
  EXPECT_LT((scene.world.pose(scene.world.body("b")).p - Vec3(-1, 0, -0.5)).norm(), 1e-14);
  EXPECT_TRUE(scene.world.is_fixed(scene.world.body("a")));
}

TEST(ImportSdf, AGraphOfJointsIsAClosedLoop) {
  Scene scene =
      scene_of(imported(link("a") + link("b", "1 0 0 0 0 0") + link("c", "0 0 -1 0 0 0") +
                        joint("j", "revolute", "world", "a") + joint("k", "revolute", "world", "b") +
                        joint("l", "revolute", "a", "c") +
                        joint("m", "revolute", "c", "b",
                              "<pose relative_to='b'>0 0 -1 0 0 0</pose><axis><xyz>0 1 0</xyz></axis>")));
  EXPECT_EQ(scene.world.joint_count(), 4);
  EXPECT_FALSE(scene.assemble);
  Simulator simulator(scene.world, scene.settings);
  EXPECT_EQ(simulator.analyze_rank().freedoms, 1);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_LT(simulator.report().gap.metres, 1e-9);
}

TEST(ImportSdf, LawsOfAxes) {
  const ImportedModel model =
      imported(link("a") + joint("j", "revolute", "world", "a",
                                 "<axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>1e16</upper></limit>"
                                 "<dynamics><damping>0.5</damping><friction>0.25</friction>"
                                 "<spring_stiffness>3</spring_stiffness><spring_reference>0.1</"
                                 "spring_reference></dynamics></axis>"));
  const auto& axis = model.document["joints"][0]["axes"]["angle"];
  EXPECT_EQ(axis["limits"], (nlohmann::ordered_json{{"lower", -1}}));
  EXPECT_EQ(axis["spring"]["stiffness"], 3);
  EXPECT_EQ(axis["spring"]["rest"], 0.1);
  EXPECT_EQ(axis["friction"]["static"], 0.25);
}

TEST(ImportSdf, MimicIsAGear) {
  const auto mimicking = [](const std::string& mimic, const std::string& type = "revolute") {
    return imported(link("a") + link("b") + joint("j", "revolute", "world", "a") +
                    joint("k", type, "world", "b", "<axis><xyz>0 1 0</xyz>" + mimic + "</axis>"));
  };
  const ImportedModel model = mimicking("<mimic joint='j'><multiplier>-2</multiplier></mimic>");
  EXPECT_FALSE(notes(model, "mimic"));
  const auto& gear = model.document["joints"][2];
  EXPECT_EQ(gear["type"], "gear");
  EXPECT_EQ(gear["driving"]["joint"], "j");
  EXPECT_EQ(gear["driven"]["joint"], "k");
  Scene scene = scene_of(model);
  const World& w = scene.world;
  scene.world.add_force(BodyTorque(w.body("a"), Vec3(0, 1, 0), false));
  Simulator simulator(scene.world);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_GT(std::abs(w.twist(w.body("a")).w.y()), 1e-3);
  EXPECT_NEAR(w.twist(w.body("b")).w.y(), -2 * w.twist(w.body("a")).w.y(), 1e-8);
  // It starts where the file puts it, whatever the constant.
  EXPECT_TRUE(notes(mimicking("<mimic joint='j'><multiplier>2</multiplier><offset>1</offset></mimic>"),
                    "the relation holds as at the start, without its constant"));
  EXPECT_FALSE(notes(mimicking("<mimic joint='j'><multiplier>2</multiplier><offset>1</offset>"
                               "<reference>.5</reference></mimic>"),
                     "mimic"));
  EXPECT_TRUE(notes(mimicking("<mimic joint='j'><multiplier>0</multiplier></mimic>"), "left out"));
  EXPECT_TRUE(notes(mimicking("<mimic joint='j' axis='axis2'/>"), "left out"));
  expect_refused(link("a") + joint("j", "revolute", "world", "a",
                                   "<axis><xyz>0 1 0</xyz><mimic joint='no such'/></axis>"),
                 "there is no joint of this name (value: no such)");
}

/// Collision happens if a category and the mask of the other share a bit, and links of one model do not
/// touch.
TEST(ImportSdf, BitmasksSayWhoTouches) {
  const auto model = [](const std::string& name, const std::string& contact, const std::string& self = "") {
    const std::string ball =
        "<collision name='c'><geometry><sphere><radius>.1</radius></sphere></geometry><surface><contact>" +
        contact + "</contact></surface></collision>";
    return "<model name='" + name + "'>" + self + link(name, "0 0 0 0 0 0", kBar + ball) +
           link(name + "2", "0 0 0 0 0 0", kBar + ball) + "</model>";
  };
  const auto collide = [](int bits) {
    return "<collide_bitmask>" + std::to_string(bits) + "</collide_bitmask>";
  };
  const Scene scene = scene_of(import_model_text(
      "<sdf version='1.11'><world name='w'>" + model("a", "<collide_bitmask>0x01</collide_bitmask>") +
          model("b", collide(3)) + model("c", collide(2)) + model("d", collide(0)) + model("e", "") +
          model("f", collide(0) + "<category_bitmask>2</category_bitmask>") +
          model("g", collide(4), "<self_collide>true</self_collide>") + "</world></sdf>",
      "m.sdf"));
  const World& w = scene.world;
  const auto touch = [&](const char* a, const char* b) {
    const auto filter = [&](const char* name) {
      for (int s = 0; s < w.shape_count(); ++s)
        if (w.shape(ShapeId{s}).body == w.body(name)) return w.shape(ShapeId{s}).filter;
      return CollisionFilter{};
    };
    const CollisionFilter x = filter(a), y = filter(b);
    return (x.groups & y.mask) != 0 && (y.groups & x.mask) != 0;
  };
  EXPECT_TRUE(touch("a", "b"));
  EXPECT_TRUE(touch("b", "c"));
  EXPECT_FALSE(touch("a", "c"));
  EXPECT_FALSE(touch("a", "d"));
  EXPECT_FALSE(touch("d", "e"));
  EXPECT_TRUE(touch("a", "e"));
  EXPECT_TRUE(touch("c", "f"));
  EXPECT_FALSE(touch("a", "f"));
  EXPECT_FALSE(touch("a", "a2"));
  EXPECT_FALSE(touch("e", "e2"));
  EXPECT_TRUE(touch("g", "g2"));
  EXPECT_FALSE(touch("g", "a"));
  for (const std::string wrong : {"-1", "65536", "0x", "three", ""})
    testing::expect_refused(
        [&] {
          return import_model_text("<sdf version='1.7'>" +
                                       model("a", "<collide_bitmask>" + wrong + "</collide_bitmask>") +
                                       "</sdf>",
                                   "m.sdf");
        },
        "must be a number of 16 bits");
}

TEST(ImportSdf, SensorsAreProbes) {
  const auto sensor = [](const std::string& name, const std::string& type) {
    return "<sensor name='" + name + "' type='" + type + "'/>";
  };
  const ImportedModel model = imported(
      link("a", "0 0 0 0 0 0", kBar + sensor("imu", "imu") + sensor("eye", "camera")) + link("b") +
      joint("j", "revolute", "world", "a", "<axis><xyz>0 1 0</xyz></axis>" + sensor("load", "force_torque")) +
      joint("k", "revolute", "a", "b") + joint("l", "ball", "world", "b", sensor("closing", "force_torque")));
  std::string probes;
  for (const auto& probe : model.document["probes"])
    probes += probe["name"].get<std::string>() + ": " + probe["quantity"].get<std::string>() + " of " +
              probe[probe.contains("body") ? "body" : "joint"].get<std::string>() + "\n";
  EXPECT_EQ(probes,
            "imu: angular-velocity of a\nimu_orientation: orientation of a\nload_force: reaction-force of j\n"
            "load_torque: reaction-torque of j\n");
  EXPECT_TRUE(notes(model, "<sensor> \"imu\" of type imu: probes of the angular velocity and orientation"));
  EXPECT_TRUE(notes(model, "<sensor> \"eye\" of type camera: has no counterpart: left out"));
  EXPECT_TRUE(notes(model, "a sensor of an axis or joint that the scene does not have: left out"));
  (void)scene_of(model);
}

std::vector<double> numbers_of(const pugi::xml_node& parent, const char* name) {
  std::istringstream text(parent.child_value(name));
  return {std::istream_iterator<double>(text), {}};
}
Pose pose_of(const pugi::xml_node& parent) {
  const std::vector<double> v = numbers_of(parent, "pose");
  const auto turn = [](const Vec3& axis, double angle) { return Quat(Eigen::AngleAxisd(angle, axis)); };
  return {turn(Vec3::UnitZ(), v[5]) * turn(Vec3::UnitY(), v[4]) * turn(Vec3::UnitX(), v[3]),
          {v[0], v[1], v[2]}};
}

/// Mass, its first moment and inertia about the origin of the world, of all links of a file.
struct Sum {
  double mass = 0;
  Vec3 moment = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
  void add(double m, const Vec3& p, const Mat3& I) {
    mass += m, moment += m * p, inertia += I + m * (p.squaredNorm() * Mat3::Identity() - p * p.transpose());
  }
};
/// By itself, from the elements; the moments of the two parts that are no body are their mean.
Sum sum_over(const std::string& text) {
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(text.c_str()));
  const pugi::xml_node model = document.child("sdf").child("model");
  const Pose X_WM = model.child("pose") ? pose_of(model) : Pose{};
  Sum sum;
  int means = 0;
  for (const pugi::xml_node& link : model.children("link")) {
    const pugi::xml_node inertial = link.child("inertial"), tensor = inertial.child("inertia");
    const auto I = [&](const char* key) { return tensor.child(key) ? numbers_of(tensor, key)[0] : 0.0; };
    Mat3 inertia;
    inertia << I("ixx"), I("ixy"), I("ixz"), I("ixy"), I("iyy"), I("iyz"), I("ixz"), I("iyz"), I("izz");
    if (inertia(2, 2) > 2 * (inertia(0, 0) + inertia(1, 1)))
      inertia = inertia.trace() / 3 * Mat3::Identity(), ++means;
    const Pose X = X_WM * pose_of(link) * (inertial.child("pose") ? pose_of(inertial) : Pose{});
    const Mat3 R = X.q.toRotationMatrix();
    sum.add(numbers_of(inertial, "mass")[0], X.p, R * inertia * R.transpose());
  }
  EXPECT_EQ(means, 2);
  return sum;
}

std::string cassie() {
  std::ifstream file(testing::model_folder() / "sdf/cassie.sdf");
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Where the file puts it, which is beyond limits: here they are not there.
TEST(ImportSdf, CassieWeighsWhatItsLinksWeigh) {
  const std::string text =
      std::regex_replace(cassie(), std::regex("<(lower|upper)>[^<]*</(lower|upper)>"), "");
  const Scene scene = scene_of(import_model_text(text, "cassie.sdf"));
  const Sum wanted = sum_over(text);
  Sum sum;
  for (int b = 1; b < scene.world.body_count(); ++b) {
    const MassProperties& mass = scene.world.mass_properties(BodyId{b});
    const Pose& X = scene.world.pose(BodyId{b});
    const Mat3 R = X.q.toRotationMatrix();
    sum.add(mass.mass(), X.p, R * mass.inertia_B() * R.transpose());
  }
  EXPECT_NEAR(sum.mass, wanted.mass, 1e-12 * wanted.mass);
  EXPECT_LT((sum.moment - wanted.moment).norm(), 1e-12 * wanted.moment.norm());
  EXPECT_LT((sum.inertia - wanted.inertia).norm(), 1e-12 * wanted.inertia.norm());
}

/// Ten gearboxes, balls and springs in closed loops.  The inertia of two of its parts is that of no body, and
/// four hinges start 35° beyond their limits, in loops.
TEST(ImportSdf, CassieRunsAsItIs) {
  const ImportedModel model = import_model(testing::model_folder() / "sdf/cassie.sdf");
  EXPECT_TRUE(testing::notes(model,
                             "cassie.sdf:758: the principal moments of inertia of \"left-foot-reference\" "
                             "are those of no body (value: 9.306e-07 9.49379e-07 9.40002e-06 kg m²): each "
                             "becomes their mean, 3.76e-06 kg m²"));
  EXPECT_TRUE(
      testing::notes(model,
                     "cassie.sdf:664: \"left-tarsus-crank-joint\" starts at 0, beyond its limits "
                     "(value: -2.4435 to -0.6109): it starts at -0.6109 now, which is 0 in the scene, and"));
  Scene scene = scene_of(model);
  World& world = scene.world;
  int gears = 0;
  for (int j = 0; j < world.joint_count(); ++j) gears += world.joint(JointId{j}).type() == "gear";
  EXPECT_EQ(gears, 10);
  EXPECT_FALSE(scene.assemble);
  for (int j = 0; j < world.joint_count(); ++j)
    for (int k = 0; k < world.axis_count({j}); ++k)
      if (const auto& limits = world.axis_properties({{j}, k}).limits) {
        EXPECT_LT(std::abs(beyond(*limits, world.axis_value({{j}, k}))), 1e-12) << world.name(JointId{j});
      }
  Simulator simulator(world, scene.settings);
  for (int i = 0; i < 240; ++i) {
    ASSERT_TRUE(simulator.step(scene.dt).exact()) << simulator.report().message;
    ASSERT_LT(simulator.report().gap.metres, 1e-9);
    ASSERT_LT(simulator.report().gap.radians, 1e-9);
  }
}

TEST(ImportSdf, WhatIsWrongIsNamedWithFileAndLine) {
  expect_refused(link("a") + joint("j", "revolute", "world", "b"),
                 "m.sdf:3: there is no link of this name (value: b)");
  expect_refused(link("a") + joint("j", "revolute", "a", "a"), "joins a link to itself");
  expect_refused(link("a", "0 0 0"), "must have 6 number(s)");
  expect_refused(
      "<link name='a'><pose relative_to='f'/></link><frame name='f'><pose relative_to='a'/></frame>",
      "in a circle");
  expect_refused(link("a") + joint("j", "spiral", "world", "a"), "has an unknown type (value: spiral)");
}

}  // namespace
}  // namespace taut::sdf_test
