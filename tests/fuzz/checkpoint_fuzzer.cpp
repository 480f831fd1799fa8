#include "core/base/fnv1a.h"
#include "core/state/same_state.h"
#include "scenes/files/scene_file.h"
#include "solvers/simulator/simulator.h"
#include "tests/fuzz/input_file.h"

// Checkpoints: 'm' for a mechanism or 'c' for bodies in contact, then the payload, which gets mark and
// checksum here. What is refused leaves the world as it was; what is taken up can be gone on from.

namespace taut::fuzz {
namespace {

const char* const kMechanism =
    R"({"format": "taut-scene/1", "settings": {"threads": 1, "merge_fixed_joints": true},
 "bodies": [
  {"name": "arm", "mass": 1, "inertia": [1, 1, 1], "position": [0.5, 0, 0]},
  {"name": "rod", "mass": 2, "inertia": [1, 2, 2], "position": [1.5, 0, 0], "angular_velocity": [0, 1, 0]},
  {"name": "tip", "mass": 1, "inertia": [1, 1, 1], "position": [2, 0, 0]}],
 "joints": [
  {"name": "pivot", "type": "hinge", "a": "ground", "b": "arm", "anchor": [0, 0, 0], "axis": [0, 1, 0],
   "axes": {"angle": {"limits": {"lower": -9, "upper": 0.01}, "friction": {"static": 1}}}},
  {"name": "elbow", "type": "hinge", "a": "arm", "b": "rod", "anchor": [1, 0, 0], "axis": [0, 1, 0],
   "break": {"force": 1000}, "axes": {"angle": {"spring": {"stiffness": 1}}}},
  {"name": "weld", "type": "fixed", "a": "rod", "b": "tip", "anchor": [2, 0, 0]}]})";

const char* const kContacts =
    R"({"format": "taut-scene/1", "settings": {"threads": 1, "sleep": true, "sleep_time": 0},
 "ground": {"shapes": [{"type": "half_space"}]},
 "bodies": [{"name": "box", "density": 1000, "shapes": [{"type": "box", "size": [1, 1, 1]}], "position": [0, 0, 0.5]},
  {"name": "ball", "density": 1000, "shapes": [{"type": "sphere", "radius": 0.5, "material": {"compliance": 1e-6}}],
   "position": [0, 0, 1.5], "velocity": [0.1, 0, 0]}]})";

/// A checkpoint with this payload.
std::string sealed(std::string_view payload) {
  Fnv1a sum;
  sum.add(payload);
  std::string bytes = "taut-checkpoint/2\n" + std::string(payload);
  for (int i = 0; i < 8; ++i) bytes += static_cast<char>(sum.value() >> (8 * i));
  return bytes;
}

void restore(const Scene& original, std::string_view payload) {
  Scene scene = original;
  Simulator simulator(scene.world, scene.settings);
  try {
    simulator.restore(Checkpoint::from_bytes(sealed(payload)));
  } catch (const std::invalid_argument&) {
    if (!same(scene.world.state(), original.world.state()))
      found("a checkpoint that was refused has changed the world");
    return;
  }
  for (int i = 0; i < 2; ++i) {
    const StepReport& report = simulator.step(scene.dt);
    if (!report.ok() && report.message.empty()) found("a step failed without a word");
  }
}

}  // namespace
}  // namespace taut::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace taut::fuzz;
  static const taut::Scene mechanism = taut::parse_scene(kMechanism, "mechanism.json");
  static const taut::Scene contacts = taut::parse_scene(kContacts, "contacts.json");
  if (size == 0) return 0;
  restore(data[0] == 'm' ? mechanism : contacts, text_of(data + 1, size - 1));
  return 0;
}
