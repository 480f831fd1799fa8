#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/world.h"

/// Reads the cases of tests/references (schema: the README there).
namespace taut::reference {

/// One value to be met, a number or a list of them.
struct Quantity {
  std::string name;
  std::optional<double> time;  ///< none: a constant of the motion, an event, or statics
  std::vector<double> value;
  double uncertainty = 0;      ///< of the reference itself
  double tolerance = 0;        ///< at the step `dt` of the case
  double tolerance_limit = 0;  ///< as dt → 0
  nlohmann::json probe;        ///< how to measure it; null if the file does not say

  bool has_probe() const { return !probe.is_null(); }
  /// Values given for orientation carry a tolerance of 1e9.
  bool binding() const { return tolerance < 1e8; }
};

/// Points of A and B that a joint ties, in body axes.
struct Anchors {
  BodyId a, b;
  Vec3 p_AP, p_BQ;
};

struct Impulse {
  BodyId body;
  Vec3 p_BP, impulse;  ///< body axes; world axes [N·s]
};

struct Case {
  std::string id, level;
  double dt = 1e-3;     ///< the step that the tolerances are for [s]
  double duration = 0;  ///< [s]
  World world;
  std::map<std::string, Anchors> anchors;  ///< by joint
  std::vector<Impulse> impulses;           ///< at t = 0
  std::vector<Quantity> quantities;
};

/// @throws std::exception if the file is not there or has something in it that the schema does not know.
Case load_case(const std::filesystem::path& file);

/// All case files of a folder in alphabetical order.
std::vector<std::filesystem::path> case_files(const std::filesystem::path& folder);

/// "world" is the ground.
BodyId find_body(const World& world, const std::string& name);
/// The entry of that name as a vector of three.
Vec3 vector_of(const nlohmann::json& object, const char* key);

}  // namespace taut::reference
