#include <cmath>
#include <nlohmann/json.hpp>

#include "core/state/same_state.h"
#include "scenes/files/scene_file.h"
#include "scenes/program/live_controls.h"
#include "tests/fuzz/input_file.h"

// What browsers send to a run, a message a line, each by one of three browsers in turn, and a step after each
// that lets the run go on.  What is refused says why and changes nothing; whatever is taken, the state stays
// finite, a step that fails says why and leaves the world as it was, and pages get numbers.

namespace taut::fuzz {
namespace {

constexpr int kMostLines = 40;

const char* const kScene = R"({"format": "taut-scene/1", "bodies": [
  {"name": "ball", "density": 1000, "shape": {"type": "sphere", "radius": 0.15}, "position": [0, 0, 3]},
  {"name": "wheel", "density": 1000, "shape": {"type": "box", "size": [0.4, 0.1, 0.1]}, "position": [1, 0, 0]},
  {"name": "arm", "density": 1000, "shape": {"type": "box", "size": [0.4, 0.1, 0.1]}, "position": [3, 0, 0]},
  {"name": "crank", "density": 1000, "shape": {"type": "box", "size": [0.4, 0.1, 0.1]}, "position": [5, 0, 0]},
  {"name": "slide", "density": 1000, "shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [7, 0, 0]},
  {"name": "block", "fixed": true, "density": 1000, "shape": {"type": "box", "size": [0.2, 0.2, 0.2]},
   "position": [-1, 0, 0]}],
 "joints": [
  {"name": "axle", "type": "hinge", "a": "ground", "b": "wheel", "anchor": [1, 0, 0], "axis": [0, 1, 0],
   "axes": {"angle": {"motor": {"velocity": 1}}}},
  {"name": "elbow", "type": "hinge", "a": "ground", "b": "arm", "anchor": [2.8, 0, 0], "axis": [0, 1, 0],
   "axes": {"angle": {"motor": {"position": 0.1}, "limits": {"lower": -2, "upper": 2}}}},
  {"name": "knee", "type": "hinge", "a": "ground", "b": "crank", "anchor": [4.8, 0, 0], "axis": [0, 1, 0],
   "axes": {"angle": {"motor": {"trajectory": {"spline": [[0, 0], [0.5, 0.4], [1, -0.3]]}}}}},
  {"name": "rail", "type": "slider", "a": "ground", "b": "slide", "anchor": [7, 0, 0], "axis": [1, 0, 0],
   "axes": {"displacement": {"motor": {"trajectory": {"spline": [[0, 0], [1, 0.3]]}, "max_force": 4000}}}}]})";

struct Run {
  Run() : simulator(scene.world, scene.settings), controls(scene.world, simulator, true) {}
  Scene scene = parse_scene(kScene, "live.json");
  Simulator simulator;
  LiveControls controls;
};

void tell(LiveControls& controls, int browser, const std::string& message) {
  const nlohmann::json before = controls.state();
  try {
    controls.obey(browser, message);
    return;
  } catch (const std::exception& error) {
    if (std::string_view(error.what()).empty()) found("a message was refused without a reason");
  }
  if (controls.state() != before) found("a message that was refused has changed the run");
  const LiveControls::News news = controls.take_news();
  if (news.state || news.pace) found("a message that was refused has news");
}

/// False if the run has ended.
bool step(Run& run) {
  const State before = run.scene.world.state();
  run.controls.begin_step(run.scene.dt);
  const StepReport& report = run.simulator.step(run.scene.dt);
  if (report.ok()) run.controls.end_step();
  if (!report.ok() && report.message.empty()) found("a step has failed without a reason");
  if (!report.ok() && !same(run.scene.world.state(), before))
    found("a step that failed has changed the world");
  if (!is_finite(run.scene.world)) found("the state is not finite");
  return report.ok();
}

}  // namespace
}  // namespace taut::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace taut::fuzz;
  Run run;
  std::string_view rest = text_of(data, size);
  for (int line = 0; line < kMostLines && !rest.empty(); ++line) {
    const std::string message(rest.substr(0, rest.find('\n')));
    rest.remove_prefix(std::min(rest.size(), message.size() + 1));
    tell(run.controls, line % 3, message);
    const nlohmann::json state = run.controls.state();
    for (const auto& target : state["targets"])
      if (!target.is_number() || !std::isfinite(target.get<double>())) found("a target is no number");
    (void)run.controls.take_news();
    if (!run.controls.is_waiting() && !step(run)) return 0;
  }
  for (int browser = 0; browser < 3; ++browser) run.controls.forget(browser);
  return 0;
}
