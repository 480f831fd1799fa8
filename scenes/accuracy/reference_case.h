#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/world/world.h"

/// Reads cases of the schema mbs-reference/1 (tests/references/README.md): a small mechanical problem, and
/// values that were obtained without a multibody simulator.
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
  std::string orientation;     ///< why no run of this case can measure it; empty: one can

  bool has_probe() const { return !probe.is_null(); }
  /// Values given for orientation carry a tolerance of 1e9 or a reason.
  bool binding() const { return tolerance < 1e8 && orientation.empty(); }
};

/// Points of A and B that a joint ties, in body axes.
struct Anchors {
  BodyId a, b;
  Vec3 p_AP, p_BQ;
};

/// A free axis of a hinge, slider or cylindrical joint.
struct FreeAxis {
  AxisId id;
  BodyId a, b;
  Vec3 axis_A;       ///< in axes of A
  double start = 0;  ///< what the file calls the coordinate at t = 0, where the World has 0
};

/// A gear, a differential or a driver: torque coef · m on each body about its axis, the opposite on the other
/// body of its hinge; m is what the probe `multiplier` measures.
struct Coupling {
  struct Term {
    FreeAxis hinge;  ///< with the direction that the file gives the axis
    double coef = 1;
  };
  std::vector<Term> terms;
};

struct Impulse {
  BodyId body;
  Vec3 p_BP, impulse;  ///< body axes; world axes [N·s]
};

/// Two bodies that may touch.  All others pass through each other.
struct Pair {
  std::string a, b;
  BodyId body_a, body_b;
};

struct Case {
  std::string id, family, level, description;
  double dt = 1e-3;     ///< the step that the tolerances are for [s]
  double duration = 0;  ///< [s]
  World world;
  std::map<std::string, Anchors> anchors;     ///< by joint
  std::map<std::string, FreeAxis> axes;       ///< by joint; of a cylindrical one the angle
  std::map<std::string, Coupling> couplings;  ///< by joint
  std::vector<Impulse> impulses;              ///< at t = 0
  std::vector<Pair> pairs;                    ///< in the order of the file
  std::vector<Quantity> quantities;
  /// Bodies that stand for moving parts of the world: in no energy and no momentum.
  std::set<BodyId> carriers;
  /// Parts of the set-up that taut has no law for, in words.  Nothing of such a case is measured.
  std::vector<std::string> missing;

  bool has_axis_properties() const;
};

/// @throws std::exception if the file is not there, is no case, or has something in it that the schema does
/// not know.
Case load_case(const std::filesystem::path& file);

/// All case files of a folder in alphabetical order; the index is none.
/// @throws std::invalid_argument if there is no such folder.
std::vector<std::filesystem::path> case_files(const std::filesystem::path& folder);

/// "world" is the ground.
BodyId find_body(const World& world, const std::string& name);
/// The entry of that name as a vector of three.
Vec3 vector_of(const nlohmann::json& object, const char* key);

}  // namespace taut::reference
