#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace taut::model {

/// Two links that are in each other at the start.
struct LinkOverlap {
  std::string a, b;
  double depth = 0;  ///< [m]
};

/// Which links that are in each other at the start are meant to be.
enum class Meant {
  kAll,     ///< all, by more than round-off: URDF has no words for who may touch whom
  kOfRobot  ///< those of one robot, by so much that steps could not take them apart gently
};

/// Adds pairs to a scene document, so that such links do not touch.  Robots are drawn with shapes that are in
/// each other about their joints, also of links that are not next to each other.
/// @returns the pairs, deepest first
std::vector<LinkOverlap> forbid_overlaps(nlohmann::ordered_json& document, const std::string& file,
                                         Meant meant);

}  // namespace taut::model
