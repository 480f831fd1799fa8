#include <nlohmann/json.hpp>

#include "core/state/same_state.h"
#include "scenes/files/scene_file.h"
#include "scenes/files/state_file.h"
#include "scenes/files/state_json.h"
#include "tests/fuzz/input_file.h"

// Texts of state files, for a mechanism with axes and for bodies in contact.  What is refused leaves the
// world as it was; what is taken is written again, and read back to the same bits.

namespace taut::fuzz {
namespace {

const char* const kMechanism = R"({"format": "taut-scene/1", "bodies": [
  {"name": "arm", "mass": 1, "inertia": [1, 1, 1], "position": [0.5, 0, 0]},
  {"name": "rod", "mass": 2, "inertia": [1, 2, 2], "position": [1.5, 0, 0]}],
 "joints": [
  {"name": "pivot", "type": "hinge", "a": "ground", "b": "arm", "anchor": [0, 0, 0], "axis": [0, 1, 0],
   "axes": {"angle": {"limits": {"lower": -9, "upper": 9}}}},
  {"name": "elbow", "type": "cylindrical", "a": "arm", "b": "rod", "anchor": [1, 0, 0], "axis": [0, 1, 0],
   "break": {"force": 1000}, "axes": {"angle": {"spring": {"stiffness": 1}}}}]})";

const char* const kContacts = R"({"format": "taut-scene/1", "ground": {"shapes": [{"type": "half_space"}]},
 "bodies": [{"name": "box", "density": 1000, "shapes": [{"type": "box", "size": [1, 1, 1]},
   {"type": "sphere", "radius": 0.5}], "position": [0, 0, 0.5]},
  {"name": "ball", "density": 1000, "shapes": [{"type": "sphere", "radius": 0.5}], "position": [0, 0, 1.5]}]})";

void check(const World& original, std::string_view text) {
  World world = original;
  SavedMemory memory;
  try {
    memory = apply_state(world, text, "fuzz.json");
  } catch (const SceneFileError& error) {
    if (error.problems().empty()) found("a state was refused without a problem");
    if (!same(world.state(), original.state())) found("a state that was refused has changed the world");
    return;
  }
  const std::string written = state_json(world, memory).dump();
  World again = original;
  try {
    const SavedMemory read = apply_state(again, written, "fuzz.json");
    if (state_json(again, read).dump() != written) found("a state that is written and read is another");
  } catch (const SceneFileError& error) {
    found(std::string("what was written is refused: ") + error.what());
  }
}

}  // namespace
}  // namespace taut::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace taut::fuzz;
  static const taut::World mechanism = taut::parse_scene(kMechanism, "mechanism.json").world;
  static const taut::World contacts = taut::parse_scene(kContacts, "contacts.json").world;
  check(mechanism, text_of(data, size));
  check(contacts, text_of(data, size));
  return 0;
}
