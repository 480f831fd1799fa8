#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <span>

#include "core/base/fnv1a.h"
#include "core/state/same_state.h"
#include "scenes/files/scene_file.h"
#include "solvers/simulator/simulator.h"
#include "tests/fuzz/input_file.h"

// Checkpoints: a letter for the world, of kWorlds, then edits of the payload of a sound one, which gets its
// checksum again. What is refused leaves the world as it was; what is taken up can be gone on from, as the
// sound one is, and kept again.

namespace taut::fuzz {
namespace {

constexpr const char* kMechanism =
    R"({"format": "taut-scene/1", "settings": {"threads": 1, "merge_fixed_joints": true},
 "bodies": [
  {"name": "arm", "mass": 1, "inertia": [1, 1, 1], "position": [0.5, 0, 0]},
  {"name": "rod", "mass": 2, "inertia": [1, 2, 2], "position": [1.5, 0, 0], "angular_velocity": [0, 1, 0]},
  {"name": "tip", "mass": 1, "inertia": [1, 1, 1], "position": [2, 0, 0]}],
 "joints": [
  {"name": "pivot", "type": "hinge", "a": "ground", "b": "arm", "anchor": [0, 0, 0], "axis": [0, 1, 0],
   "axes": {"angle": {"limits": {"lower": -9, "upper": 0.01}, "friction": {"static": 1}}}},
  {"name": "elbow", "type": "hinge", "a": "arm", "b": "rod", "anchor": [1, 0, 0], "axis": [0, 1, 0],
   "axes": {"angle": {"spring": {"stiffness": 1}}}, "break": {"force": 1000}},
  {"name": "weld", "type": "fixed", "a": "rod", "b": "tip", "anchor": [2, 0, 0]}]})";

constexpr const char* kContacts =
    R"({"format": "taut-scene/1", "settings": {"threads": 1, "sleep": true, "sleep_time": 0},
 "ground": {"shapes": [{"type": "half_space"}]},
 "bodies": [{"name": "box", "density": 1000, "shapes": [{"type": "box", "size": [1, 1, 1]}], "position": [0, 0, 0.5]},
  {"name": "ball", "density": 1000, "shapes": [{"type": "sphere", "radius": 0.5, "material": {"compliance": 1e-6}}],
   "position": [0, 0, 1.5], "velocity": [0.1, 0, 0]}]})";

/// What needs RATTLE in them, and what goes with all but the force level.
constexpr std::string_view kOfRattle[] = {R"(, "break": {"force": 1000})",
                                          R"(, "material": {"compliance": 1e-6})"};
constexpr std::string_view kOfImpulses[] = {
    R"("angle": {"limits": {"lower": -9, "upper": 0.01}, "friction": {"static": 1}})",
    R"("angle": {"spring": {"stiffness": 1}})"};

void leave_out(std::string& text, std::span<const std::string_view> parts) {
  for (std::string_view part : parts)
    if (const std::size_t at = text.find(part); at != text.npos) text.erase(at, part.size());
}

struct Kind {
  char letter;  // the first byte of an input
  std::string_view scene;
  Integrator integrator;
  bool rests;
};
constexpr Kind kWorlds[] = {
    {'c', kContacts, Integrator::kRattle, false},      {'m', kMechanism, Integrator::kRattle, false},
    {'s', kContacts, Integrator::kRattle, true},       {'j', kContacts, Integrator::kMoreauJean, false},
    {'k', kMechanism, Integrator::kMoreauJean, false}, {'f', kMechanism, Integrator::kForceEuler, false}};

Scene scene_of(const Kind& kind) {
  std::string text(kind.scene);
  if (kind.integrator != Integrator::kRattle) leave_out(text, kOfRattle);
  if (kind.integrator == Integrator::kForceEuler) leave_out(text, kOfImpulses);
  Scene scene = parse_scene(text, "original.json");
  scene.settings.integrator = kind.integrator;
  scene.settings.max_substeps = 4;
  for (int b = 0; kind.rests && b < scene.world.body_count(); ++b) scene.world.set_twist({b}, {});
  return scene;
}

/// A scene, and the bytes of a checkpoint of it after two steps.
struct Original {
  explicit Original(const Kind& kind) : scene(scene_of(kind)) {
    Scene copy = scene;
    Simulator simulator(copy.world, copy.settings);
    for (int i = 0; i < 2; ++i)
      if (!simulator.step(copy.dt).ok()) found("a sound world fails: " + simulator.report().message);
    bytes = simulator.checkpoint().bytes();
    begin = bytes.find('\n') + 1;
  }

  Scene scene;
  std::string bytes;
  std::size_t begin = 0;  // of the payload, which ends with a checksum of eight bytes
};

const Original& original_of(char letter) {
  static std::unique_ptr<Original> originals[std::size(kWorlds)];  // each as soon as it is asked for
  std::size_t i = 0;
  while (i < std::size(kWorlds) && kWorlds[i].letter != letter) ++i;
  i %= std::size(kWorlds);
  if (!originals[i]) originals[i] = std::make_unique<Original>(kWorlds[i]);
  return *originals[i];
}

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
    if (payload.empty()) return;
    const std::size_t place = (byte(e) * 256u + byte(e + 1)) % payload.size(), what = byte(e + 2) % 6,
                      value = byte(e + 3);
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
    const State before = scene.world.state();
    try {
      simulator.step(scene.dt);
    } catch (const std::invalid_argument&) {  // of numbers that no simulation has come to
      if (!same(scene.world.state(), before)) found("a step that threw has changed the world");
      return;
    }
    const StepReport& report = simulator.report();
    if (!is_finite(scene.world)) found("the state is not finite; the step said " + report.message);
    if (!report.exact() && report.message.empty()) found("a step failed without a word");
    try {
      simulator.restore(simulator.checkpoint());
    } catch (const std::invalid_argument& why) {
      found(std::string("what a simulation has kept it does not take up: ") + why.what());
    }
  }
}

}  // namespace
}  // namespace taut::fuzz

// libFuzzer's notes on what a step compares take three fifths of its time, and no bytes here are words to be
// found.
extern "C" void __wrap___sanitizer_cov_trace_cmp8(std::uint64_t, std::uint64_t) {}
extern "C" void __wrap___sanitizer_cov_trace_const_cmp8(std::uint64_t, std::uint64_t) {}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace taut::fuzz;
  if (size == 0) return 0;
  restore(original_of(static_cast<char>(data[0])), text_of(data + 1, size - 1));
  return 0;
}
