#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "scenes/files/scene_file.h"
#include "scenes/import/imported_model.h"
#include "solvers/simulator/simulator.h"
#include "tests/scenes/import/corpus_checker.h"
#include "tests/scenes/import/text_checks.h"

// What SDF says, and what the scene has.
namespace taut::sdf_test {
namespace {

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

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what))
    text.replace(at, what.size(), by);
  return text;
}

/// Cassie has ten gearboxes, balls and springs in closed loops.  The inertia of two of its parts is that of
/// no body: here they get one.  Limits are left out: joints start far beyond them, and move fast towards
/// them.
TEST(ImportSdf, Cassie) {
  std::ifstream file(testing::model_folder() / "sdf/cassie.sdf");
  std::stringstream text;
  text << file.rdbuf();
  ImportedModel model =
      import_model_text(replaced(text.str(), "<izz>9.4e-6</izz>", "<izz>9.4e-7</izz>"), "cassie.sdf");
  for (auto& joint : model.document["joints"])
    if (joint.contains("axes") && joint["axes"].contains("angle")) joint["axes"]["angle"].erase("limits");
  Scene scene = scene_of(model);
  int gears = 0;
  for (int j = 0; j < scene.world.joint_count(); ++j) gears += scene.world.joint(JointId{j}).type() == "gear";
  EXPECT_EQ(gears, 10);
  scene.settings.contacts = false;
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
  EXPECT_LT(simulator.report().gap.metres, 1e-9);
  EXPECT_LT(simulator.report().gap.radians, 1e-9);
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
