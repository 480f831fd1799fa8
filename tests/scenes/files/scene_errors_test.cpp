#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "scenes/files/generated_names.h"
#include "scenes/files/scene_file.h"

/// Files with several mistakes: all that can be known is said at once, and nothing that is not so.
namespace taut::scene_errors_test {
namespace {

using Lines = std::set<std::string>;

/// The paths of all problems; those of gaps with their size.
Lines problems_of(const std::string& members) {
  Lines found;
  try {
    parse_scene(R"({"format": "taut-scene/1", )" + members + "}", "test.json");
  } catch (const SceneFileError& error) {
    for (const SceneFileProblem& p : error.problems()) {
      const bool gap = p.message.find("has a gap") != std::string::npos;
      EXPECT_TRUE(found.insert(gap ? p.path + " open by " + p.value : p.path).second) << error.what();
    }
  }
  return found;
}

/// Refers to a rod of the chain "c/", to one that no chain of two rods has, and to what nobody has.
const std::string kReferences = R"(
  "bodies": [{"name": "c/own", "mass": 1, "inertia": [1, 1, 1]}],
  "joints": [
    {"name": "j0", "type": "ball", "a": "c/rod_0", "b": "c/own", "anchor": [0, 0, 0]},
    {"name": "j1", "type": "ball", "a": "c/rod_7", "b": "c/own", "anchor": [0, 0, 0]},
    {"name": "j2", "type": "ball", "a": "d/rod_0", "b": "c/own", "anchor": [0, 0, 0]},
    {"name": "j3", "type": "ball", "a": "ground", "b": "c/own", "frame": "body",
     "anchor_a": [0, 0, 0], "anchor_b": [0, 0, 0.25]}],
  "forces": [{"type": "torque", "body": "c/rod_1", "torque": [0, 0, 1]},
             {"type": "torque", "body": "e/rod_1", "torque": [0, 0, 1]}],
  "pairs": [{"a": "c/rod_0", "b": "c/rod_1", "collide": false}, {"a": "x", "b": "c/rod_1", "collide": false}],
  "probes": [{"name": "p0", "quantity": "gap", "joint": "c/joint_9"}, {"name": "p1", "quantity": "gap", "joint": "x"},
             {"name": "p2", "quantity": "orientation", "body": "c/rod_9"},
             {"name": "p3", "quantity": "orientation", "body": "x"}])";
const Lines kUnknownToAll{"/joints/2/a",     "/forces/1/body", "/pairs/1/a",
                          "/probes/1/joint", "/probes/3/body", "/joints/3 open by 0.25 m"};

Lines with(Lines lines, const Lines& more) {
  lines.insert(more.begin(), more.end());
  return lines;
}

TEST(SceneErrors, OfABlockHideOnlyWhatItMayHaveMade) {
  const auto block = [](const std::string& keys) {
    return R"("generate": [{)" + keys + "}], " + kReferences;
  };
  const std::string chain = R"("builder": "chain", "prefix": "c/")";
  const Lines counted{"/joints/1/a", "/probes/0/joint", "/probes/2/body"};  // a chain of two rods has none
  EXPECT_EQ(problems_of(block(chain + R"(, "parameters": {"n": 2})")), with(kUnknownToAll, counted));
  EXPECT_EQ(problems_of(block(chain + R"(, "parameters": {"n": 2.5})")),
            with(kUnknownToAll, {"/generate/0/parameters/n"}));
  EXPECT_EQ(problems_of(block(chain + R"(, "parameters": {"m": 2})")),
            with(kUnknownToAll, {"/generate/0/parameters/m"}));
  EXPECT_EQ(problems_of(block(R"("builder": "chian", "prefix": "c/")")),
            with(kUnknownToAll, {"/generate/0/builder"}));
  EXPECT_EQ(problems_of(block(chain + R"(, "size": 3)")), with(kUnknownToAll, {"/generate/0/size"}));
  // Its names are known, only not where it is.
  EXPECT_EQ(problems_of(block(chain + R"(, "parameters": {"n": 2}, "position": [0, 0])")),
            with(with(kUnknownToAll, counted), {"/generate/0/position"}));
  // Without a prefix that can be read it may have made anything.
  EXPECT_EQ(problems_of(block(R"("builder": "chain", "prefix": 3)")),
            (Lines{"/generate/0/prefix", "/joints/3 open by 0.25 m"}));
}

/// Names that the builder gives to nothing are wrong whatever its parameters, also without a prefix.
TEST(SceneErrors, OfABlockWithoutAPrefixHideOnlyWhatItsBuilderMakes) {
  const std::string references = R"(
    "bodies": [{"name": "own", "mass": 1, "inertia": [1, 1, 1]}],
    "joints": [
      {"type": "ball", "a": "rod_99", "b": "own", "anchor": [0, 0, 0]},
      {"type": "ball", "a": "rood_0", "b": "own", "anchor": [0, 0, 0]},
      {"type": "ball", "a": "ground", "b": "onw", "anchor": [0, 0, 0]}])";
  const auto block = [&](const std::string& keys) {
    return problems_of(R"("generate": [{)" + keys + "}], " + references);
  };
  EXPECT_EQ(block(R"("builder": "chain", "parameters": {"n": 2.5})"),
            (Lines{"/generate/0/parameters/n", "/joints/1/a", "/joints/2/b"}));
  // Its builder is not known, or the unknown key may be "prefix".
  EXPECT_EQ(block(R"("builder": "chian")"), (Lines{"/generate/0/builder"}));
  EXPECT_EQ(block(R"("builder": "chain", "prefx": "c/")"), (Lines{"/generate/0/prefx"}));
}

TEST(GeneratedNames, LookAsFewSizesShow) {
  EXPECT_EQ(look_of("rod_12 of 3"), "rod_0 of 0");
  for (const SceneInfo& builder : scene_catalogue()) {
    const Lines looks = looks_of(builder);
    for (double part : {0.0, 1.0}) {
      std::map<std::string, double> parameters;
      for (const ParameterInfo& p : builder.parameters) {
        const double most = std::min(p.maximum, p.minimum + 8);
        const double value = p.minimum + part * (most - p.minimum);
        parameters[p.name] = p.integer ? std::round(value) : value;
      }
      const World world = build_scene(builder.name, parameters).world;
      for (int b = 0; b < world.body_count(); ++b)
        ASSERT_TRUE(looks.contains(look_of(world.name(BodyId{b})))) << world.name(BodyId{b});
      for (int j = 0; j < world.joint_count(); ++j)
        ASSERT_TRUE(looks.contains(look_of(world.name(JointId{j})))) << world.name(JointId{j});
      for (int m = 0; m < world.material_count(); ++m)
        ASSERT_TRUE(looks.contains(look_of(world.name(MaterialId{m})))) << world.name(MaterialId{m});
    }
  }
}

TEST(SceneErrors, OfABlockThatIsPlacedNowhereHideItsGapsButNoPart) {
  EXPECT_EQ(problems_of(R"("generate": [{"builder": "chain", "prefix": "c/", "parameters": {"n": 2},
      "orientation": [0, 0, 0, 0]}],
    "joints": [{"type": "ball", "a": "ground", "b": "c/rod_0", "frame": "body", "anchor_a": [7, 7, 7],
                "anchor_b": [0, 0, 0]},
               {"type": "ball", "a": "c/ground", "b": "c/rod_0", "anchor": [0, 0, 0]},
               {"type": "ball", "a": "c/grund", "b": "c/rod_0", "anchor": [0, 0, 0]}])"),
            (Lines{"/generate/0/orientation", "/joints/2/a"}));
}

TEST(SceneErrors, OfAShapeDoNotHideThoseOfTheMass) {
  const std::string shapes = R"("shapes": [{"type": "box", "size": [1, 1, 0]}])";
  EXPECT_EQ(problems_of(R"("bodies": [{"mass": -1, )" + shapes + "}]"),
            (Lines{"/bodies/0/mass", "/bodies/0/shapes/0/size"}));
  EXPECT_EQ(problems_of(R"("bodies": [{"mass": 1, )" + shapes + "}]"), (Lines{"/bodies/0/shapes/0/size"}));
  EXPECT_EQ(problems_of(R"("bodies": [{"density": 0, "rod": {"from": [0, 0, 0], "to": [1, 0, 0],
                        "radius": 0}}])"),
            (Lines{"/bodies/0/density", "/bodies/0/rod/radius"}));
}

/// One body with an error, and joints whose gaps are as large as their names say.
Lines gaps_beside(const std::string& keys) {
  return problems_of(R"("bodies": [
      {"name": "sound", "mass": 1, "inertia": [1, 1, 1], "position": [0, 0, 1]}, {"name": "bad", )" +
                     keys + R"(}],
    "joints": [
      {"name": "1 m", "type": "ball", "a": "ground", "b": "sound", "frame": "body", "anchor_a": [0, 0, 0],
       "anchor_b": [0, 0, 0]},
      {"name": "2 m", "type": "ball", "a": "ground", "b": "bad", "frame": "body", "anchor_a": [0, 0, 0],
       "anchor_b": [0, 0, 0]},
      {"name": "closed", "type": "ball", "a": "sound", "b": "bad", "anchor": [3, 4, 5]}])");
}

TEST(SceneErrors, OfABodyHideGapsOnlyWhereItsPoseIsNotKnown) {
  const std::string mass = R"("mass": 1, "inertia": [1, 1, 1], )", there = R"("position": [0, 2, 0])";
  const Lines gap{"/joints/0 open by 1 m"}, gaps = with(gap, {"/joints/1 open by 2 m"});
  EXPECT_EQ(gaps_beside(mass + there), gaps);
  for (const auto& [keys, path] : std::map<std::string, std::string>{
           {R"("mass": -1, "inertia": [1, 1, 1], )" + there, "/bodies/1/mass"},
           {R"("mass": 1, "inertia": [1, 1, 3], )" + there, "/bodies/1/inertia"},
           {R"("mass": 1, )" + there, "/bodies/1"},
           {mass + R"("fixed": 1, )" + there, "/bodies/1/fixed"},
           {mass + R"("velocity": 1, )" + there, "/bodies/1/velocity"},
           {R"("mass": 1, "shapes": [{"type": "sphere", "radius": 0, "position": [5, 0, 0]}], )" + there,
            "/bodies/1/shapes/0/radius"},
           {mass + R"("colour": 1, "orientation": [1, 0, 0, 0], )" + there, "/bodies/1/colour"}})
    EXPECT_EQ(gaps_beside(keys), with(gaps, {path})) << keys;
  for (const auto& [keys, path] : std::map<std::string, std::string>{
           {mass + R"("position": [0, 2])", "/bodies/1/position"},
           {mass + R"("orientation": [0, 0, 0, 0], )" + there, "/bodies/1/orientation"},
           {mass + R"("positon": [0, 2, 0])", "/bodies/1/positon"}})  // it may be meant
    EXPECT_EQ(gaps_beside(keys), with(gap, {path})) << keys;
}

TEST(SceneErrors, OfABodyWithAKnownPoseKeepItsCentreOfMassOutOfTheGap) {
  // The sphere's centre is 5 m off the body's origin, which the joint closes at.
  EXPECT_EQ(problems_of(R"("bodies": [{"name": "b", "density": 1, "position": [0, 0, 1], "velocity": 0,
      "shapes": [{"type": "sphere", "radius": 1, "position": [5, 0, 0]}]}],
    "joints": [{"type": "ball", "a": "ground", "b": "b", "frame": "body", "anchor_a": [0, 0, 1],
                "anchor_b": [0, 0, 0]}])"),
            (Lines{"/bodies/0/velocity"}));
}

TEST(SceneErrors, NamesThatAreTakenLeaveOpenWhichIsMeant) {
  const std::string twins = R"("bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]},
      {"name": "b", "mass": 1, "inertia": [1, 1, 1], "position": [0, 0, 1]}], )";
  EXPECT_EQ(problems_of(twins + R"("joints": [{"type": "ball", "a": "ground", "b": "b", "frame": "body",
      "anchor_a": [0, 0, 1], "anchor_b": [0, 0, 0]}])"),
            (Lines{"/bodies/1/name"}));
  // A joint whose name is taken is a joint all the same.
  EXPECT_EQ(problems_of(R"("bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}], "joints": [
      {"name": "j", "type": "ball", "a": "ground", "b": "b", "anchor": [0, 0, 0]},
      {"name": "j", "type": "ball", "a": "ground", "b": "b", "frame": "body", "anchor_a": [0, 0, 1],
       "anchor_b": [0, 0, 0]}])"),
            (Lines{"/joints/1/name", "/joints/1 open by 1 m"}));
}

/// The length of a rod is by default the distance at the start, which must not be 0.
TEST(SceneErrors, OfPosesMakeNoFalseErrorsOfJoints) {
  const auto rod = [](const std::string& position) {
    return problems_of(R"("bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1], "position": )" +
                       position +
                       R"(}], "joints": [{"type": "distance", "a": "ground", "b": "b", "frame": "body",
        "anchor_a": [0, 0, 0], "anchor_b": [0, 0, 0]}, {"type": "gear", "ratio": 2, "driving": {"joint": "joint_1",
        "axis": "x"}, "driven": {"joint": "joint_0", "axis": "x"}}])");
  };
  EXPECT_EQ(rod("[0, 0, 0]"), Lines{"/joints/0"});
  EXPECT_EQ(rod("[0, 0]"), Lines{"/bodies/0/position"});
}

TEST(SceneErrors, OfTheStartLeaveGapsOpen) {
  const std::string joint = R"("bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}],
    "joints": [{"type": "ball", "a": "ground", "b": "b", "frame": "body", "anchor_a": [0, 0, 1],
                "anchor_b": [0, 0, 0]}])";
  EXPECT_EQ(problems_of(joint), Lines{"/joints/0 open by 1 m"});
  EXPECT_EQ(problems_of(R"("assemble": 1, )" + joint), Lines{"/assemble"});
  EXPECT_EQ(problems_of(R"("dt": 0, )" + joint), (Lines{"/dt", "/joints/0 open by 1 m"}));
}

}  // namespace
}  // namespace taut::scene_errors_test
