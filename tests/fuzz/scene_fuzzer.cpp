#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scenes/files/scene_file.h"
#include "scenes/program/start_warnings.h"
#include "solvers/simulator/simulator.h"
#include "tests/fuzz/input_file.h"

// Texts of scene files.  What is no scene is refused with SceneFileError that names paths and messages; what
// is one is checked as `taut check` does, and small ones are stepped twice.

namespace taut::fuzz {
namespace {

/// Scenes that builders make large are slow and no find: their parameters stay small here.
bool builds_much(std::string_view text) {
  if (text.find("\"generate\"") == text.npos && text.find("\"cables\"") == text.npos &&
      text.find('\\') == text.npos)
    return false;
  const auto document = nlohmann::json::parse(text, nullptr, false, true);
  if (!document.is_object()) return false;
  if (const auto cables = document.find("cables"); cables != document.end() && cables->is_array())
    for (const auto& cable : *cables)
      if (const auto links = cable.is_object() ? cable.find("links") : cable.end();
          cable.is_object() && links != cable.end() && links->is_number() && links->get<double>() > 30)
        return true;
  if (!document.contains("generate")) return false;
  const nlohmann::json& blocks = document["generate"];
  if (!blocks.is_array()) return false;
  if (blocks.size() > 2) return true;
  for (const auto& block : blocks) {
    if (!block.is_object()) continue;
    const std::string builder = block.value("builder", nlohmann::json()).dump();
    if (builder != "\"chain\"" && builder != "\"net\"" && builder != "\"joint-grid\"" &&
        builder != "\"stack\"")
      return true;
    const auto parameters = block.find("parameters");
    if (parameters == block.end() || !parameters->is_object() || !parameters->contains("n")) return true;
    for (const auto& value : *parameters)
      if (value.is_number() && !(std::abs(value.get<double>()) <= 4)) return true;
  }
  return false;
}

std::size_t corners_of(const World& world) {
  std::size_t corners = 0;
  for (int s = 0; s < world.shape_count(); ++s) {
    const Shape& shape = *world.shape(ShapeId{s}).shape;
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) corners += mesh->triangles.size();
    if (const auto* field = std::get_if<HeightField>(&shape)) corners += field->heights.size();
    if (const auto* hull = std::get_if<ConvexHull>(&shape)) corners += hull->points.size();
  }
  return corners;
}

void step(Scene& scene) {
  Settings settings = scene.settings;
  settings.threads = 1;
  settings.max_substeps = std::min(settings.max_substeps, 4);
  settings.max_newton_iterations = std::min(settings.max_newton_iterations, 12);
  settings.iterations = std::min(settings.iterations, 20);
  try {
    Simulator simulator(scene.world, settings);
    simulator.set_events(scene.events);
    if (scene.assemble && !simulator.assemble().ok()) return;
    for (int i = 0; i < 2; ++i) {
      const StepReport& report = simulator.step(scene.dt);
      if (!is_finite(scene.world)) found("the state is not finite; the step said " + report.message);
      if (!report.exact() && report.message.empty()) found("a step failed without a word");
      if (!report.ok()) return;
    }
  } catch (const std::invalid_argument&) {  // settings that do not go with the scene
  }
}

}  // namespace
}  // namespace taut::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace taut;
  using namespace taut::fuzz;
  const std::string_view text = text_of(data, size);
  if (builds_much(text)) return 0;
  static const std::string file = source_dir() + "/scenes/examples/fuzz.json";
  try {
    Scene scene = parse_scene(text, file);
    if (scene.world.body_count() > 40 || scene.world.joint_count() > 60 || corners_of(scene.world) > 200)
      return 0;
    scene.world.validate();
    start_warnings(scene.world, scene.settings, scene.dt);
    if (scene.world.body_count() <= 12) step(scene);
  } catch (const SceneFileError& error) {
    if (error.problems().empty()) found("a scene was refused without a problem");
    for (const SceneFileProblem& problem : error.problems())
      if (problem.line < 1 || problem.column < 1 || problem.message.empty())
        found("a problem without place or message");
  }
  return 0;
}
