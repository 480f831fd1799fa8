#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "scenes/files/scene_file.h"
#include "scenes/import/imported_model.h"
#include "scenes/support/format.h"
#include "solvers/simulator/simulator.h"
#include "tests/sanitized.h"
#include "tests/scenes/import/corpus_checker.h"

// Models that others wrote: each loads or is refused by name; what they weigh and how they move is compared
// with MuJoCo.
namespace taut::corpus_test {
namespace {

using Json = nlohmann::json;

const Json& references() {
  static const Json kRead =
      Json::parse(std::ifstream(testing::model_folder().parent_path() / "references.json"));
  return kRead;
}

/// The document of a model; nothing if it is refused.
std::optional<ImportedModel> imported(const std::string& name) {
  try {
    return import_model(testing::model_folder() / name);
  } catch (const std::invalid_argument&) {
    return {};
  }
}

/// The document of a model where its file puts it: one that would start beyond limits has none.
std::optional<ImportedModel> imported_as_placed(const std::string& name) {
  auto model = imported(name);
  if (!model || std::ranges::none_of(model->notices, [](const ImportNotice& notice) {
        return notice.message.find("beyond its limits") != std::string::npos;
      }))
    return model;
  std::ifstream file(testing::model_folder() / name);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  const std::regex limits(name.ends_with(".xml") ? " (range|limited)=(\"[^\"]*\"|'[^']*')"
                                                 : "<limit\\b[^>]*/>");
  return import_model_text(std::regex_replace(text, limits, ""), testing::model_folder() / name);
}

Vec3 vector_of(const Json& json) {
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}
Quat orientation_of(const Json& body) {
  if (!body.contains("orientation")) return Quat::Identity();
  const Json& q = body["orientation"];
  return {q[0].get<double>(), q[1].get<double>(), q[2].get<double>(), q[3].get<double>()};
}
Mat3 matrix_of(const Json& rows) {
  Mat3 m;
  for (int i = 0; i < 3; ++i) m.row(i) = vector_of(rows[i]);
  return m;
}

struct Weight {
  double mass = 0;
  Vec3 centre = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
};
/// Of all bodies, those that stand still included, about their common centre of mass.  Inertia of axes is
/// none of them.
Weight weight_of(Json document) {
  Json bodies = Json::array();
  for (const Json& body : document["bodies"])
    if (body["name"].get<std::string>().find("_armature") == std::string::npos) bodies.push_back(body);
  document["bodies"] = bodies;
  Weight all;
  for (const Json& body : document["bodies"])
    if (body.contains("mass")) {
      all.mass += body["mass"].get<double>();
      all.centre += body["mass"].get<double>() * vector_of(body["position"]);
    }
  if (all.mass > 0) all.centre /= all.mass;
  for (const Json& body : document["bodies"])
    if (body.contains("mass")) {
      const Mat3 R = orientation_of(body).toRotationMatrix();
      const Vec3 r = vector_of(body["position"]) - all.centre;
      all.inertia += R * matrix_of(body["inertia"]) * R.transpose() +
                     body["mass"].get<double>() * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    }
  return all;
}

/// Meshes: MuJoCo keeps coordinates of their corners in single precision, 24 bits.
bool has_hulls(const Json& document) { return document.dump().find("convex_hull") != std::string::npos; }

TEST(ImportCorpus, EachModelLoadsOrIsRefusedWithFileAndLine) {
  const std::regex place("^.*\\.(xml|urdf|sdf):[0-9]+: .+");
  int loaded = 0;
  for (const std::string& name : testing::model_files()) try {
      const ImportedModel model = import_model(testing::model_folder() / name);
      (void)parse_scene(model.document.dump(), name);
      ++loaded;
    } catch (const ImportError& error) {
      for (const ImportNotice& problem : error.problems())
        EXPECT_TRUE(std::regex_match(problem.text(), place)) << error.what();
    } catch (const std::exception& error) {
      ADD_FAILURE() << name << ": " << error.what();
    }
  EXPECT_GE(loaded, 240);
}

TEST(ImportCorpus, MassCentreAndInertiaAreThoseOfMuJoCo) {
  int compared = 0;
  for (const auto& [name, reference] : references().items()) {
    if (!reference.is_object() || reference.contains("refused") || reference["deformable"] == true) continue;
    const auto model = imported_as_placed(name);
    if (!model) continue;
    const Json document = model->document;
    const Weight mine = weight_of(document);
    const double mass = reference["mass"].get<double>(), tolerance = has_hulls(document) ? 2e-8 : 1e-9;
    const Mat3 inertia = matrix_of(reference["inertia"]);
    EXPECT_NEAR(mine.mass, mass, tolerance * mass) << name;
    const double size = mass > 0 ? std::sqrt(inertia.norm() / mass) : 1;
    EXPECT_LT((mine.centre - vector_of(reference["centre"])).norm(), tolerance * (1 + size)) << name;
    EXPECT_LE((mine.inertia - inertia).norm(), tolerance * inertia.norm()) << name;
    ++compared;
  }
  EXPECT_GE(compared, 150);
}

/// Without what the reference has switched off.
Json only_smooth(Json document) {
  document["settings"]["contacts"] = false;
  for (Json& joint : document["joints"])
    for (Json& axis : joint.contains("axes") ? joint["axes"] : (joint["axes"] = Json::object())) {
      axis.erase("limits");
      if (axis.contains("friction")) axis["friction"].erase("static");
      if (axis.contains("friction") && axis["friction"].empty()) axis.erase("friction");
    }
  return document;
}

/// The root of a URDF stays where it is, as in the reference.
void hold_root(Json& document, const Json& positions) {
  std::set<std::string> moved;  // by a joint against another body
  for (const Json& joint : document["joints"])
    if (joint.contains("b")) moved.insert(joint["b"].get<std::string>());
  for (Json& body : document["bodies"])
    if (!moved.contains(body["name"].get<std::string>()) &&
        !positions.contains(body["name"].get<std::string>()))
      body["fixed"] = true;
  Json joints = Json::array();  // those of two fixed bodies are none
  std::set<std::string> fixed{"ground"};
  for (bool more = true; more;) {
    more = false;
    for (Json& body : document["bodies"]) {
      const std::string name = body["name"].get<std::string>();
      bool follows = body.value("fixed", false);
      for (const Json& joint : document["joints"])
        follows = follows || (joint["type"] == "fixed" && joint["b"] == name &&
                              fixed.contains(joint["a"].get<std::string>()));
      if (!follows || !fixed.insert(name).second) continue;
      body["fixed"] = more = true;
    }
  }
  for (const Json& joint : document["joints"])
    if (joint["type"] != "fixed" || !fixed.contains(joint["b"].get<std::string>())) joints.push_back(joint);
  document["joints"] = joints;
}

/// Where the centre of mass of the model's body is, in the scene's body, which may have a share of it or
/// more.
using Points = std::map<std::string, Vec3>;
Points marked_points(const World& world, const Json& positions) {
  Points points;
  for (const auto& [body, course] : positions.items())
    if (world.has_body(body)) points[body] = world.pose(world.body(body)).local(vector_of(course[0]));
  return points;
}

/// A body between joints moves with the one behind it, whose name its own begins with.
void set_velocities(World& world, const Json& velocities) {
  for (int b = 1; b < world.body_count(); ++b) {
    std::string name = world.name(BodyId{b});
    if (!velocities.contains(name)) name = name.substr(0, name.rfind('_'));
    if (world.is_fixed(BodyId{b}) || !velocities.contains(name)) continue;
    const Json& v = velocities[name];
    const Vec3 centre(v[0], v[1], v[2]), w(v[3], v[4], v[5]), at_centre(v[6], v[7], v[8]);
    world.set_twist(BodyId{b}, {w, at_centre + w.cross(world.pose(BodyId{b}).p - centre)});
  }
}

/// What carries the inertia of an axis goes along with it.
void set_velocities_of_armatures(World& world, const Json& document) {
  std::map<std::string, Vec3> slides;
  for (const Json& joint : document["joints"]) {
    if (joint["type"] == "slider") slides[joint["name"].get<std::string>()] = vector_of(joint["axis"]);
    if (joint["type"] != "gear" || joint["driven"]["axis"] != "displacement") continue;
    const std::string slide = joint["driven"]["joint"].get<std::string>();
    if (slide.find("_armature") == std::string::npos) continue;
    const JointId driving = world.joint(joint["driving"]["joint"].get<std::string>());
    const double rate = world.axis_rate(world.axis(driving, joint["driving"]["axis"].get<std::string>()));
    world.set_twist(world.joint(world.joint(slide)).b(), {Vec3::Zero(), rate * slides.at(slide)});
  }
}

/// Where the points of the reference are after a while.
Points ends_of(Scene scene, const Json& document, const Json& reference, double duration, double dt) {
  const Points points = marked_points(scene.world, reference["positions"]);
  set_velocities(scene.world, reference["velocities"]);
  set_velocities_of_armatures(scene.world, document);
  Simulator simulator(scene.world, scene.settings);
  bool fine = true;
  for (int i = 0; fine && i < std::lround(duration / dt); ++i) fine = simulator.step(dt).exact();
  EXPECT_TRUE(fine) << scene.name << ": " << simulator.report().message;
  Points ends;
  for (const auto& [body, point] : points) ends[body] = scene.world.pose(scene.world.body(body)).point(point);
  return ends;
}

/// The largest distance from what the reference has of each body at the index.
double largest_distance(const Points& ends, const Json& reference, int index) {
  double error = 0;
  for (const auto& [body, p] : ends) error = std::max(error, (p - vector_of(reference[body][index])).norm());
  return error;
}

/// MuJoCo's equalities are soft: with half their time constant, the distance from rigid joints is a quarter,
/// of the shortest two with which it is large enough to tell.  @returns whether there are such.
bool soften_as_their_square(const std::string& name, const Points& ends, const Json& soft) {
  constexpr double kTells = 5e-8;  // [m], above what steps of 1e-4 s change
  int finest = static_cast<int>(references()["time_constants"].size()) - 1;
  while (finest > 0 && largest_distance(ends, soft, finest) < kTells) --finest;
  if (finest == 0) return false;
  const double longer = largest_distance(ends, soft, finest - 1),
               distance = largest_distance(ends, soft, finest);
  EXPECT_NEAR(longer / distance, 4, 0.5) << name << ": " << longer << " m, " << distance << " m";
  return true;
}

/// Models whose motion depends on what has no counterpart, as a notice of each says.
const std::map<std::string, std::string> kMovesOtherwise = {
    {"mjcf/test_engine_testdata_actuation_activation.xml", "it does nothing"},
    {"mjcf/test_engine_testdata_actuation_refsite.xml", "it does nothing"},
    {"mjcf/test_engine_testdata_core_smooth_ten_armature_4.xml",
     "the spring of a wire through several points"},
    {"mjcf/test_engine_testdata_sensor_contact_net.xml", "\"springdamper\""},
};

bool says(const ImportedModel& model, const std::string& what) {
  return std::any_of(model.notices.begin(), model.notices.end(), [&](const ImportNotice& notice) {
    return notice.message.find(what) != std::string::npos;
  });
}

/// With steps of 1e-4 s, of order 2: some 2e-8 m in 0.1 s, and up to 1e-7 m with stiff springs.  A body
/// between joints that takes 1e-3 of an inertia changes some 2e-7 m.  Where there are loops, the reference is
/// what its soft equalities tend to as they become stiff.
TEST(ImportCorpus, ShortMotionsAreThoseOfMuJoCo) {
  if (testing::sanitized()) GTEST_SKIP() << "of very many steps";
  int compared = 0, with_loops = 0, softened = 0;
  for (const auto& [name, reference] : references().items()) {
    if (!reference.is_object() || !reference.contains("positions")) continue;
    const auto model = imported_as_placed(name);
    if (!model) continue;
    if (const auto other = kMovesOtherwise.find(name); other != kMovesOtherwise.end()) {
      EXPECT_TRUE(says(*model, other->second)) << name;
      continue;
    }
    Json document = only_smooth(model->document);
    if (name.starts_with("urdf")) hold_root(document, reference["positions"]);
    const Points ends = ends_of(parse_scene(document.dump(), name), document, reference,
                                references()["time"].get<double>(), 1e-4);
    const double error = largest_distance(ends, reference["positions"], 1);
    EXPECT_LT(error, says(*model, "a body between them") ? 1e-6 : 2e-7) << name;
    ++compared;
    if (!reference.contains("soft")) continue;
    ++with_loops;
    softened += soften_as_their_square(name, ends, reference["soft"]);
  }
  EXPECT_GE(compared, 95);
  EXPECT_GE(with_loops, 15);
  EXPECT_GE(softened, 8);
}

/// Loops that are open at the start are closed before the first step, and stay so.
TEST(ImportCorpus, LoopsAreClosedTo1e9) {
  int closed = 0;
  for (const std::string& name : testing::model_files()) {
    const auto model = imported(name);
    if (!model) continue;
    const Json document = model->document;
    const bool loops =
        std::any_of(document["joints"].begin(), document["joints"].end(), [](const Json& joint) {
          return joint.contains("anchor_a") || joint["type"] == "gear" || joint["type"] == "driver";
        });
    if (!loops) continue;
    Scene scene = parse_scene(only_smooth(document).dump(), name);
    Simulator simulator(scene.world, scene.settings);
    if (scene.assemble) {
      ASSERT_TRUE(simulator.assemble().exact()) << name << ": " << simulator.report().message;
    }
    for (int i = 0; i < 10; ++i)
      ASSERT_TRUE(simulator.step(1e-3).exact()) << name << ": " << simulator.report().message;
    EXPECT_LT(simulator.report().gap.metres, 1e-9) << name;
    EXPECT_LT(simulator.report().gap.radians, 1e-9) << name;
    ++closed;
  }
  EXPECT_GE(closed, 20);
}

/// As `taut import` says it.
std::string sizes_of(const Scene& scene, const ImportedModel& model) {
  const World& world = scene.world;
  return (world.moving_body_count() == 0 ? "loaded, nothing moves | " : "loaded | ") +
         counted(world.moving_body_count(), "moving body", "moving bodies") + ", " +
         counted(world.joint_count(), "joint") + ", " + counted(world.shape_count(), "shape") + "; " +
         counted(static_cast<long long>(model.notices.size()), "notice") + " |";
}

/// corpus.md says which models load, with sizes and notices, also of those that are not here:
/// `corpus_table BUILD/taut [FOLDER]` writes it.
TEST(ImportCorpus, TheTableSaysWhatLoads) {
  std::ifstream file(testing::model_folder().parent_path() / "corpus.md");
  const std::string table((std::istreambuf_iterator<char>(file)), {});
  const std::regex row("\\| (mjcf|sdf|urdf)/[^ ]* \\| (loaded|loaded, nothing moves|refused) \\| [^|]+ \\|");
  EXPECT_EQ(std::distance(std::sregex_iterator(table.begin(), table.end(), row), {}), 341);
  for (const std::string& name : testing::model_files()) {
    std::string said = "refused";
    try {
      const ImportedModel model = import_model(testing::model_folder() / name);
      said = sizes_of(parse_scene(model.document.dump(), name), model);
    } catch (const std::invalid_argument&) {
    }
    EXPECT_NE(table.find("| " + name + " | " + said), std::string::npos)
        << name << " is now: " << said << "; corpus_table writes the table";
  }
}

}  // namespace
}  // namespace taut::corpus_test
