#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/fuzz/mechanism_random.h"

namespace taut::fuzz {

using Json = nlohmann::json;

inline Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Json json_of(const Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }

/// A scene that is being made, with the scales that all of its parts have.
struct MechanismDraft {
  explicit MechanismDraft(std::uint64_t seed) : random(seed) {}

  Random random;
  Json scene;
  double size = 1, mass = 1, mass_decades = 0, g = 9.81, speed = 0, dt = 0;
  int count = 2;             ///< of bodies
  bool free = false;         ///< no gravity, and nothing is tied to the ground
  bool plain = false;        ///< the integrator knows joints and forces alone
  bool moreau = false;       ///< it is Moreau–Jean, without compliant contacts and joints that break
  bool contacts = false;     ///< bodies have shapes
  std::vector<Vec3> places;  ///< of the bodies

  std::string body_name(int i) const { return i < 0 ? "ground" : "b" + std::to_string(i); }
  Vec3 place(int i) const { return i < 0 ? Vec3(0, 0, size) : places[i]; }
  double force() const { return mass * g; }
  Json table(double x, double y) {
    return Json::array({Json::array({-x, -y * random.uniform(0.5, 2)}), Json::array({0, 0}),
                        Json::array({x, y * random.uniform(0.5, 2)})});
  }
};

/// Joints between the bodies of the draft, with what acts along their axes.
void add_joints(MechanismDraft& draft);
/// Gears and the like between axes that are there.
void add_couplings(MechanismDraft& draft);

}  // namespace taut::fuzz
