#include <algorithm>
#include <array>
#include <limits>

#include "core/base/fnv1a.h"
#include "core/state/same_state.h"
#include "scenes/files/scene_file.h"
#include "solvers/simulator/simulator.h"
#include "tests/fuzz/input_file.h"

// Checkpoints: 'm' for a mechanism or 'c' for bodies in contact, then edits of the payload of a sound one,
// which gets its checksum again. What is refused leaves the world as it was; what is taken up can be gone on
// from, as the sound one is.

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

/// A scene, and the bytes of a checkpoint of it after two steps.
struct Original {
  explicit Original(const char* text) : scene(parse_scene(text, "original.json")) {
    Scene copy = scene;
    Simulator simulator(copy.world, copy.settings);
    for (int i = 0; i < 2; ++i) simulator.step(copy.dt);
    bytes = simulator.checkpoint().bytes();
    begin = bytes.find('\n') + 1;
  }

  Scene scene;
  std::string bytes;
  std::size_t begin = 0;  // of the payload, which ends with a checksum of eight bytes
};

constexpr std::size_t kSum = 8, kEdit = 4;
const std::array<double, 8> kNumbers{0,
                                     1,
                                     -1,
                                     1e-300,
                                     1e300,
                                     std::numeric_limits<double>::infinity(),
                                     std::numeric_limits<double>::quiet_NaN(),
                                     4e9};
const std::array<std::int64_t, 8> kCounts{
    0, 1, -1, 3, 1 << 20, 1ll << 31, 1ll << 40, std::numeric_limits<std::int64_t>::max()};

/// Each edit is a place, of two bytes, what is done there, and with what.
void edit(std::string& payload, std::string_view edits) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(edits[i]); };
  for (std::size_t e = 0; e + kEdit <= edits.size(); e += kEdit) {
    const std::size_t place = byte(e) * 256u + byte(e + 1), what = byte(e + 2) % 6, value = byte(e + 3);
    if (place >= payload.size()) continue;
    const auto overwrite = [&](const auto& number) {
      payload.replace(place, std::min(sizeof number, payload.size() - place),
                      reinterpret_cast<const char*>(&number),
                      std::min(sizeof number, payload.size() - place));
    };
    if (what == 0) payload[place] = edits[e + 3];
    if (what == 1) overwrite(kNumbers[value % kNumbers.size()]);
    if (what == 2) overwrite(kCounts[value % kCounts.size()]);
    if (what == 3) payload.erase(place, value);
    if (what == 4) payload.insert(place, value, '\0');
    if (what == 5) payload.insert(place, payload.substr(place, value));
  }
}

/// The payload with its mark and a sound checksum.
std::string sealed(const Original& original, std::string_view payload) {
  Fnv1a sum;
  sum.add(payload);
  std::string bytes = original.bytes.substr(0, original.begin) + std::string(payload);
  for (std::size_t i = 0; i < kSum; ++i) bytes += static_cast<char>(sum.value() >> (8 * i));
  return bytes;
}

void restore(const Original& original, std::string_view edits) {
  Scene scene = original.scene;
  Simulator simulator(scene.world, scene.settings);
  std::string payload = original.bytes.substr(original.begin, original.bytes.size() - original.begin - kSum);
  edit(payload, edits);
  try {
    simulator.restore(Checkpoint::from_bytes(sealed(original, payload)));
  } catch (const std::invalid_argument& why) {
    if (!same(scene.world.state(), original.scene.world.state()))
      found("a checkpoint that was refused has changed the world");
    if (edits.size() < kEdit) found(std::string("a sound checkpoint was refused: ") + why.what());
    return;
  }
  for (int i = 0; i < 2; ++i) {
    const StepReport& report = simulator.step(scene.dt);
    if (!report.exact() && report.message.empty()) found("a step failed without a word");
  }
}

}  // namespace
}  // namespace taut::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace taut::fuzz;
  static const Original mechanism(kMechanism), contacts(kContacts);
  if (size == 0) return 0;
  restore(data[0] == 'm' ? mechanism : contacts, text_of(data + 1, size - 1));
  return 0;
}
