#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "scenes/accuracy/reference_probes.h"
#include "scenes/accuracy/reference_run.h"
#include "tests/run_program.h"
#include "tests/temporary.h"

/// `taut accuracy` on folders of cases that it has not seen, made up here from closed forms.
namespace taut::reference::accuracy_test {
namespace {

using Json = nlohmann::json;
using testing::read_text;
using testing::run_program;
using testing::temporary;
using testing::write_text;

constexpr double kG = 9.81;

Json body(const std::string& name, double mass, Json inertia, Json position) {
  return {{"name", name},
          {"mass", mass},
          {"inertia", inertia},
          {"position", position},
          {"velocity", {0, 0, 0}},
          {"angular_velocity", {0, 0, 0}},
          {"orientation", {1, 0, 0, 0}}};
}

Json quantity(const std::string& name, Json time, Json value, double tolerance, Json probe) {
  Json json{{"name", name},         {"time", time},         {"value", value},
            {"ref_uncertainty", 0}, {"abs_tol", tolerance}, {"abs_tol_limit", tolerance}};
  if (!probe.is_null()) json["probe"] = probe;
  return json;
}

/// A list of quantities is no Json: compilers differ in what Json{one} is, a list of one or that one itself.
Json make_case(const std::string& level, Json setup, const std::vector<Json>& quantities) {
  setup["gravity"] = {0, 0, -kG};
  if (!setup.contains("joints")) setup["joints"] = Json::array();
  return {
      {"id", "made_up"}, {"level", level}, {"tol_dt", 1e-3}, {"setup", setup}, {"quantities", quantities}};
}

/// A point probe of the centre of mass.
Json point(const std::string& name, const std::string& what) {
  return {{"kind", "point"}, {"body", name}, {"what", what}};
}

/// Free fall from rest: x(0.5 s) = −g/8.
Json falling(double expected = -kG / 8) {
  return make_case("smooth", {{"bodies", {body("stone", 2, {1, 1, 1}, {0, 0, 0})}}, {"duration", 0.5}},
                   {quantity("z", 0.5, expected, 1e-9, [] {
                     Json probe = point("stone", "position");
                     probe["components"] = {2};
                     return probe;
                   }())});
}

std::string folder_with(const std::string& name, const std::map<std::string, std::string>& files) {
  const std::string folder = temporary(name);
  std::filesystem::create_directories(folder);
  for (const auto& [file, text] : files) write_text(folder + "/" + file, text);
  return folder;
}

CaseRun run_made_up(const Json& json) {
  const std::string file = folder_with("made_up", {{"case.json", json.dump()}}) + "/case.json";
  return run_case(file);
}

void expect_all_pass(const CaseRun& run, int count) {
  EXPECT_EQ(run.failed, "");
  EXPECT_EQ(run.count(Verdict::kPass), count);
  for (const Measurement& m : run.quantities)
    EXPECT_EQ(m.verdict, Verdict::kPass) << m.name << ": " << m.error << " " << m.reason;
}

TEST(Accuracy, SucceedsIfAllIsMetAndSaysSoInJson) {
  const std::string folder = folder_with("good", {{"a.json", falling().dump()}, {"index.json", "{}"}});
  const auto outcome = run_program({"accuracy", "--references", folder, "--json"});
  EXPECT_EQ(outcome.exit_status, 0) << outcome.err;
  const Json report = Json::parse(outcome.out);
  EXPECT_EQ(report.at("summary").at("pass"), 1);
  const Json& q = report.at("cases").at(0).at("quantities").at(0);
  EXPECT_EQ(q.at("verdict"), "pass");
  ASSERT_EQ(q.at("results").size(), 2u);
  EXPECT_EQ(q.at("results").at(0).at("dt"), 1e-3);
  EXPECT_EQ(q.at("results").at(1).at("dt"), 5e-4);
}

TEST(Accuracy, FailsIfOneValueIsMissed) {
  const std::string folder =
      folder_with("bad", {{"a.json", falling().dump()}, {"b.json", falling(-1.2).dump()}});
  const auto outcome = run_program({"accuracy", "--references", folder});
  EXPECT_EQ(outcome.exit_status, 1);
  EXPECT_NE(outcome.out.find("FAIL"), std::string::npos);
  EXPECT_NE(outcome.out.find("1 quantities pass, 1 fail"), std::string::npos) << outcome.out;
}

TEST(Accuracy, AFileThatIsNoCaseIsSaidAndFails) {
  const std::string folder = folder_with("broken", {{"a.json", falling().dump()}, {"b.json", "{\"id\": 1"}});
  const auto outcome = run_program({"accuracy", "--references", folder});
  EXPECT_EQ(outcome.exit_status, 1);
  EXPECT_NE(outcome.out.find("b.json: cannot be read"), std::string::npos) << outcome.out;
  EXPECT_EQ(run_program({"accuracy", "--references", folder + "/nowhere"}).exit_status, 2);
}

TEST(Accuracy, OptionsWithoutEffectAreRefusedByName) {
  const std::string folder = folder_with("options", {{"a.json", falling().dump()}}),
                    study = folder + "/study";
  const auto refusal = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"accuracy", "--references", folder});
    const auto outcome = run_program(options);
    EXPECT_EQ(outcome.exit_status, 2);
    return outcome.err;
  };
  EXPECT_NE(refusal({"--only", "nosuch"}).find("--only"), std::string::npos);
  EXPECT_NE(refusal({"--jobs", "-3"}).find("--jobs"), std::string::npos);
  EXPECT_NE(refusal({"--json", study, "--csv", study}).find("--csv: must not be the file of --json"),
            std::string::npos);
  for (const std::vector<std::string>& option :
       {std::vector<std::string>{"--only", "a"}, {"--integrator", "rattle"}, {"--summary"}, {"--json"}}) {
    std::vector<std::string> words{"--study", study};
    words.insert(words.end(), option.begin(), option.end());
    EXPECT_NE(refusal(words).find(option.front()), std::string::npos);
  }
  EXPECT_FALSE(std::filesystem::exists(study));
}

TEST(Accuracy, WhatCannotBeMeasuredIsNamedAndDoesNotFail) {
  Json json = falling();
  json["quantities"].push_back(quantity("colour", 0.5, 1, 1e-3, {{"kind", "colour"}, {"body", "stone"}}));
  json["quantities"].push_back(quantity("mood", 0.5, 1, 1e-3, nullptr));
  const std::string folder = folder_with("unknown", {{"a.json", json.dump()}});
  const auto outcome = run_program({"accuracy", "--references", folder, "--csv"});
  EXPECT_EQ(outcome.exit_status, 0);
  EXPECT_NE(outcome.out.find("not measured,\"probe of unknown kind"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("not measured,the file does not say how"), std::string::npos);
}

TEST(Accuracy, WhatNoRunOfTheCaseCanMeasureIsForOrientationAndSaysWhy) {
  Json json = falling(), limit = quantity("terminal_speed", nullptr, 9, 1e-3, nullptr);
  limit["for_orientation"] = "the limit of long falls in air";
  json["quantities"].push_back(limit);
  const CaseRun run = run_made_up(json);
  EXPECT_EQ(run.count(Verdict::kOrientation), 1);
  EXPECT_EQ(run.count(Verdict::kNotMeasured), 0);
  EXPECT_EQ(run.quantities.back().reason, "the limit of long falls in air");
}

/// z(t) = −g t²/2 passes −0.5 m downwards at √(1/g); the chord through a step h misses that by g h²/8 at
/// most.
Json passing(const std::string& direction) {
  Json z = point("stone", "position");
  z["components"] = {2};
  return {{"of", z}, {"level", -0.5}, {"direction", direction}};
}

TEST(Accuracy, APassageThroughALevelIsWithinItsStepToSecondOrder) {
  Json json = falling(), time = passing("down"), velocity = point("stone", "velocity");
  time["kind"] = "crossing_time";
  time["index"] = 1;
  velocity["components"] = {2};
  const double at = std::sqrt(1 / kG), h = 1e-3, chord = h * h / 8 / at;
  json["quantities"].push_back(quantity("time", nullptr, at, chord, time));
  for (const char* side : {"before", "both", "after"})
    json["quantities"].push_back(quantity(side, nullptr, -kG * at, 1.01 * kG * chord,
                                          {{"kind", "at_crossing"},
                                           {"crossing", passing("any")},
                                           {"index", 1},
                                           {"of", velocity},
                                           {"side", side}}));
  expect_all_pass(run_made_up(json), 5);
}

TEST(Accuracy, APassageThatTheRunDoesNotShowFailsAndAWrongDirectionIsNamed) {
  const auto run_with = [](const std::string& direction) {
    Json json = falling(), time = passing(direction);
    time["kind"] = "crossing_time";
    time["index"] = 1;
    json["quantities"].push_back(quantity("time", nullptr, 0.3, 1, time));
    return run_made_up(json);
  };
  const CaseRun run = run_with("up");
  EXPECT_EQ(run.quantities.back().verdict, Verdict::kFail);
  EXPECT_NE(run.quantities.back().reason.find("not seen in the run"), std::string::npos);
  EXPECT_THROW(run_with("sideways"), std::invalid_argument);
}

/// The rod of 3 kg hangs by its upper end: its middle bears half of its weight.
TEST(Accuracy, TheAxialForceOfAHangingRodIsHalfItsWeight) {
  const double m = 3;
  Json rod = body("rod", m, {0.25, 0.25, 0.01}, {0, 0, -0.5});
  const Json setup{
      {"bodies", {rod}},
      {"joints", {{{"name", "pin"}, {"type", "ball"}, {"a", "world"}, {"b", "rod"}, {"anchor", {0, 0, 0}}}}}};
  expect_all_pass(
      run_made_up(make_case("static", setup,
                            {quantity("middle", nullptr, 0.5 * m * kG, 1e-9,
                                      {{"kind", "axial_force"}, {"body", "rod"}, {"axis", {0, 0, 1}}})})),
      1);
}

/// An event that the run does not show is a failure, not a gap in the table.
TEST(Accuracy, AnEventThatDoesNotHappenFails) {
  Json json = falling();
  json["quantities"].push_back(quantity("rest", nullptr, 0.1, 1, {{"kind", "rest_time"}, {"body", "stone"}}));
  const CaseRun run = run_made_up(json);
  EXPECT_EQ(run.count(Verdict::kFail), 1);
}

/// A rod on a hinge that starts horizontal hangs straight down at last, with its weight on the hinge.
TEST(Accuracy, StaticCasesThatDoNotStartInEquilibriumAreRelaxed) {
  const double m = 3;
  Json setup{{"bodies", {body("rod", m, {0.01, 0.25, 0.25}, {0.5, 0, 0})}},
             {"joints",
              {{{"name", "pin"},
                {"type", "hinge"},
                {"a", "world"},
                {"b", "rod"},
                {"anchor", {0, 0, 0}},
                {"axis", {0, 1, 0}}}}}};
  const Json position = point("rod", "position");
  const CaseRun run =
      run_made_up(make_case("static", setup,
                            {quantity("centre", nullptr, {0, 0, -0.5}, 1e-6, position),
                             quantity("force", nullptr, {0, 0, m * kG}, 1e-4,
                                      {{"kind", "joint_force"}, {"joint", "pin"}, {"on", "rod"}})}));
  expect_all_pass(run, 2);
}

/// Three wheels with Σ coef ω = 0 and a torque on the first: ω̇ᵢ = (Tᵢ + coefᵢ m)/Iᵢ, which gives m.
TEST(Accuracy, GearsTakeAnyNumberOfWheelsAndAxesOfEitherSense) {
  const double I[3] = {0.2, 0.3, 0.5}, coef[3] = {2, 3, -5}, torque = 0.7;
  Json bodies = Json::array(), joints = Json::array(), terms = Json::array();
  for (int i = 0; i < 3; ++i) {
    const std::string name = std::string("wheel").append(std::to_string(i));
    bodies.push_back(body(name, 1, {1, 1, I[i]}, {i, 0, 0}));
    // The second hinge is given from the wheel to the world, the third points down.
    const bool swapped = i == 1;
    joints.push_back({{"name", std::string("hinge").append(std::to_string(i))},
                      {"type", "hinge"},
                      {"a", swapped ? name : "world"},
                      {"b", swapped ? "world" : name},
                      {"anchor", {i, 0, 0}},
                      {"axis", {0, 0, i == 2 ? -1 : 1}}});
    terms.push_back({{"body", name}, {"axis", {0, 0, 1}}, {"coef", coef[i]}});
  }
  joints.push_back({{"name", "gear"}, {"type", "gear"}, {"terms", terms}});
  double weight = 0;
  for (int i = 0; i < 3; ++i) weight += coef[i] * coef[i] / I[i];
  const double multiplier = -coef[0] * torque / I[0] / weight;
  std::vector<Json> quantities = {
      quantity("m", 0.2, multiplier, 1e-9, {{"kind", "multiplier"}, {"joint", "gear"}})};
  for (int i = 0; i < 3; ++i)
    quantities.push_back(quantity(std::string("w").append(std::to_string(i)), 0.2,
                                  0.2 * ((i == 0 ? torque : 0) + coef[i] * multiplier) / I[i], 1e-9,
                                  {{"kind", "angular_velocity"},
                                   {"body", std::string("wheel").append(std::to_string(i))},
                                   {"frame", "world"},
                                   {"components", {2}}}));
  const Json setup{
      {"bodies", bodies},
      {"joints", joints},
      {"duration", 0.2},
      {"forces", {{{"type", "constant_torque"}, {"body", "wheel0"}, {"torque", {0, 0, torque}}}}}};
  expect_all_pass(run_made_up(make_case("smooth", setup, quantities)), 4);
}

/// A bead on a vertical cylindrical joint falls and spins freely, with a limit of its angle out of reach.
TEST(Accuracy, CylindricalJointsWithLimits) {
  Json bead = body("bead", 1, {0.1, 0.1, 0.1}, {0, 0, 0});
  bead["angular_velocity"] = {0, 0, 2};
  const Json setup{{"bodies", {bead}},
                   {"duration", 0.5},
                   {"joints",
                    {{{"name", "pole"},
                      {"type", "cylindrical"},
                      {"a", "world"},
                      {"b", "bead"},
                      {"anchor", {0, 0, 0}},
                      {"axis", {0, 0, 1}},
                      {"limits", {{"upper_relative_to_start", 5.0}}}}}}};
  const Json turn{{"kind", "angle"}, {"body", "bead"}, {"axis", {0, 0, 1}}, {"offset", 0}};
  expect_all_pass(run_made_up(make_case("nonsmooth", setup,
                                        {quantity("z", 0.5, {0, 0, -kG / 8}, 1e-9, point("bead", "position")),
                                         quantity("turn", 0.5, 1.0, 1e-9, turn)})),
                  2);
}

Json contact(const char* a, const char* b) {
  return {{"a", a}, {"b", b}, {"mu_static", 0.4}, {"mu_kinetic", 0.3}, {"restitution", 0.5}};
}

/// Shapes of every type stand where the file puts them, and only listed pairs may touch.
TEST(Accuracy, WorldsOfContactCasesHaveTheirShapes) {
  Json box = body("box", 1, {1, 1, 1}, {0, 0, 1}), rod = body("rod", 1, {1, 1, 1}, {2, 0, 1}),
       feet = body("feet", 1, {1, 1, 1}, {4, 0, 1});
  box["shape"] = {{"type", "box"}, {"size", {1, 2, 3}}};
  rod["shape"] = {{"type", "capsule"}, {"axis", "x"}, {"radius", 0.1}, {"segment_length", 2}};
  feet["shape"] = {{"type", "compound"},
                   {"children",
                    {{{"type", "sphere"}, {"radius", 0.1}, {"centre_world_at_t0", {4, 0, 0.5}}},
                     {{"type", "sphere"}, {"radius", 0.1}, {"centre_world_at_t0", {5, 0, 0.5}}}}}};
  const Json plane{{"type", "plane"}, {"normal", {1, 0, 0}}, {"offset", -3}};
  const Json setup{{"bodies", {box, rod, feet}},
                   {"static_bodies",
                    {{{"name", "ground"}, {"shape", plane}},
                     {{"name", "belt"}, {"shape", plane}, {"surface_velocity", {0, 2, 0}}}}},
                   {"contacts", {contact("ground", "box"), contact("belt", "rod"), contact("box", "feet")}}};
  const std::string file =
      folder_with("shapes", {{"a.json", make_case("nonsmooth", setup, {}).dump()}}) + "/a.json";
  const Case c = load_case(file);
  ASSERT_EQ(c.pairs.size(), 3u);
  EXPECT_EQ(c.world.shape_count(), 6);
  EXPECT_TRUE(c.world.may_collide(c.pairs[0].body_a, c.pairs[0].body_b));
  EXPECT_FALSE(c.world.may_collide(c.pairs[0].body_b, c.pairs[1].body_b));
  EXPECT_EQ(c.carriers.size(), 1u);
  EXPECT_EQ(c.world.twist(c.pairs[1].body_a).v, Vec3(0, 2, 0));
  for (int i = 0; i < c.world.shape_count(); ++i) {
    const ShapeRecord& shape = c.world.shape(ShapeId{i});
    const Vec3 middle = c.world.pose(shape.body).point(shape.pose.p);
    const Vec3 z = c.world.pose(shape.body).q * (shape.pose.q * Vec3::UnitZ());
    if (std::holds_alternative<HalfSpace>(*shape.shape)) {
      EXPECT_NEAR((middle - Vec3(-3, 0, 0)).norm(), 0, 1e-15);
      EXPECT_NEAR((z - Vec3::UnitX()).norm(), 0, 1e-15);
    }
    if (std::holds_alternative<Capsule>(*shape.shape)) {
      EXPECT_NEAR(std::abs(z.x()), 1, 1e-15);
    }
    if (std::holds_alternative<Sphere>(*shape.shape)) {
      EXPECT_NEAR(middle.z(), 0.5, 1e-15);
    }
  }
  const Material material = c.world.contact_material(ShapeId{0}, ShapeId{1});
  EXPECT_EQ(material.restitution, 0.5);
  EXPECT_EQ(material.static_friction, 0.4);
  EXPECT_EQ(material.dynamic_friction, 0.3);
}

}  // namespace
}  // namespace taut::reference::accuracy_test
