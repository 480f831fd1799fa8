#include <gtest/gtest.h>

#include <algorithm>

#include "scenes/import/imported_model.h"
#include "tests/scenes/import/text_checks.h"

// What is wrong with a model is told at once, and what may have been meant.
namespace taut::problems_test {
namespace {

using testing::notes;

/// The lines of the error that importing has.
std::vector<std::string> problems_of(const std::string& text, const std::string& file) {
  try {
    (void)import_model_text(text, file);
  } catch (const ImportError& error) {
    std::vector<std::string> lines;
    for (const ImportNotice& problem : error.problems()) lines.push_back(problem.text());
    std::string all;
    for (const std::string& line : lines) all += (all.empty() ? "" : "\n") + line;
    EXPECT_EQ(error.what(), all);
    EXPECT_EQ(error.place().text(), error.problems()[0].place.text());
    return lines;
  }
  ADD_FAILURE() << "is not refused";
  return {};
}

/// As many lines, each of which begins so.
void expect_problems(const std::string& text, const std::string& file,
                     const std::vector<std::string>& begins) {
  const std::vector<std::string> lines = problems_of(text, file);
  EXPECT_EQ(lines.size(), begins.size());
  for (std::size_t i = 0; i < std::min(lines.size(), begins.size()); ++i)
    EXPECT_EQ(lines[i].substr(0, begins[i].size()), begins[i]);
}

TEST(ImportProblems, AllOfAMjcfAtOnce) {
  expect_problems(
      "<mujoco><worldbody>\n"
      "<body name='a'>\n"
      "<joint name='j' axis='0 0 0'/>\n"
      "<geom size='.1' friction='x'/>\n"
      "<geom type='cubiod' size='.1 .1 .1'/></body>\n"
      "<body name='b'><geom type='box' size='.1'/>\n"
      "<freejoint/></body></worldbody>\n"
      "<contact><exclude body1='a' body2='b'/>\n"
      "<pair geom1='g' geom2='h'/></contact>\n"  // g may be one of those that are wrong
      "<actuator><position name='p' joint='j' kp='1 2'/></actuator></mujoco>",
      "m.xml",
      {"m.xml:3: <joint> \"axis\" must be a direction", "m.xml:4: <geom> \"friction\" must be numbers",
       "m.xml:5: unknown type of geom (value: cubiod)", "m.xml:6: \"size\" must have 3 number(s)"});
}

TEST(ImportProblems, AllOfAUrdfAtOnce) {
  const std::string inertia = "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>";
  expect_problems(
      "<robot name='r'>\n<link nmae='a'/>\n<link name='b'/>\n<link name='b'/>\n"
      "<joint name='j' type='fixed'><parent link='b'/></joint></robot>",
      "r.urdf",
      {"r.urdf:2: <link> needs the attribute \"name\"; is \"nmae\" meant to be it?",
       "r.urdf:4: there is another link of this name", "r.urdf:5: joint \"j\" needs <parent> and <child>"});
  expect_problems(
      "<robot name='r'><link name='base'/>\n<link name='upper_arm'><inertial><mass value='-1'/>" + inertia +
          "</inertial>\n<collision><geometry><sphere radius='big'/></geometry></collision></link>\n"
          "<joint name='j' type='hinge'><parent link='base'/><child link='upper_arm'/></joint></robot>",
      "r.urdf",
      {"r.urdf:2: <mass> \"value\" must not be negative", "r.urdf:3: <sphere> \"radius\" must be numbers",
       "r.urdf:4: joint \"j\" has an unknown type; did you mean \"revolute\"?"});
  expect_problems(
      "<robot name='r'><link name='base'/><link name='upper_arm'/>\n"
      "<joint name='j' type='fixed'><parent link='bse'/><child link='uper_arm'/></joint></robot>",
      "r.urdf",
      {"r.urdf:2: joint \"j\" names a link that is not there; did you mean \"base\"?",
       "r.urdf:2: joint \"j\" names a link that is not there; did you mean \"upper_arm\"?"});
}

TEST(ImportProblems, AllOfAnSdfAtOnce) {
  expect_problems(
      "<sdf version='1.7'><model name='m'>\n<link name='a'><inertial><mass>x</mass></inertial></link>\n"
      "<link name='b'><pose>1 2</pose></link></model>\n"
      "<model name='n'><link name='c'/>\n<joint name='j' "
      "type='revolut'><parent>world</parent><child>c</child>"
      "</joint>\n<joint name='k' type='fixed'><parent>d</parent><child>c</child></joint></model></sdf>",
      "m.sdf",
      {"m.sdf:2: ", "m.sdf:3: ", "m.sdf:5: joint \"j\" has an unknown type; did you mean \"revolute\"?",
       "m.sdf:6: there is no link of this name"});
}

/// Links that move without a mass, too; of very many problems those of the beginning.
TEST(ImportProblems, OfManyTheFirst) {
  std::string robot = "<robot name='r'>\n<link name='world'/>\n", geoms;
  for (int i = 0; i < 30; ++i) {
    const std::string name = "'l" + std::to_string(i) + "'";
    robot += "<link name=" + name + "/><joint name=" + name +
             " type='continuous'><parent link='world'/><child link=" + name + "/></joint>\n";
    geoms += "\n<geom size='-1'/>";
  }
  auto lines = problems_of(robot + "</robot>", "r.urdf");
  ASSERT_EQ(lines.size(), 20U);
  EXPECT_TRUE(lines[0].starts_with("r.urdf:3: \"l0\" moves, and has no mass")) << lines[0];
  EXPECT_TRUE(lines[19].ends_with("(and 10 more)")) << lines[19];
  lines = problems_of("<mujoco><worldbody><body>" + geoms + "</body></worldbody></mujoco>", "m.xml");
  ASSERT_EQ(lines.size(), 20U);
  EXPECT_TRUE(lines[0].starts_with("m.xml:2: <geom> \"size\" must be positive")) << lines[0];
}

TEST(ImportProblems, MisspeltNamesAreSuggested) {
  const ImportedModel model = import_model_text(
      "<mujoco><worldbody>\n<body name='a'><freejoint/><geom size='.1' frction='2'/>\n<goem size='.2'/>"
      "<geom size='.1' solref='.1 1' hardness='3'/></body></worldbody><optoin/></mujoco>",
      "m.xml");
  EXPECT_TRUE(notes(model, "m.xml:2: <geom> \"frction\": has no counterpart; did you mean \"friction\"?"));
  EXPECT_TRUE(notes(model, "m.xml:3: <goem>: has no counterpart; did you mean \"geom\"?"));
  EXPECT_TRUE(notes(model, "<optoin>: has no counterpart; did you mean \"option\"?"));
  EXPECT_TRUE(notes(model, "<geom> \"hardness\": has no counterpart"));
  EXPECT_FALSE(notes(model, "<geom> \"hardness\": has no counterpart;"));
  EXPECT_TRUE(notes(model, "<geom> \"solref\": softness that goes with the mass has no counterpart"));
  const ImportedModel arm = import_model_text(
      "<robot name='r'><link name='world'/><link name='a'><inertial><mass value='1'/><inertia ixx='1' "
      "iyy='1' "
      "izz='1' ixy='0' ixz='0' iyz='0'/></inertial><colision/></link><joint name='j' type='continuous'>"
      "<parent link='world'/><child link='a'/><axes xyz='0 0 1'/></joint></robot>",
      "r.urdf");
  EXPECT_TRUE(notes(arm, "<colision>: has no counterpart; did you mean \"collision\"?"));
  EXPECT_TRUE(notes(arm, "<axes>: has no counterpart; did you mean \"axis\"?"));
}

TEST(ImportProblems, NamesOfOthersAreSuggested) {
  const auto refused = [](const std::string& inside, const std::string& message) {
    testing::expect_refused([&] { return import_model_text("<mujoco>" + inside + "</mujoco>", "m.xml"); },
                            message);
  };
  const std::string body =
      "<worldbody><body name='upper_arm'><joint name='elbow'/><geom size='.1'/></body></worldbody>";
  refused("<worldbody><body><joint type='prismatic'/></body></worldbody>", "did you mean \"slide\"?");
  refused("<worldbody><body><geom type='cube' size='1 1 1'/></body></worldbody>", "did you mean \"box\"?");
  refused(body + "<equality><connect body1='uper_arm' anchor='0 0 0'/></equality>",
          "did you mean \"upper_arm\"?");
  refused(body + "<actuator><motor joint='elbo'/></actuator>", "did you mean \"elbow\"?");
}

}  // namespace
}  // namespace taut::problems_test
