#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace taut::model {

/// Adds pairs to a scene document, so that bodies whose shapes are in each other at the start do not touch.
/// Robots are drawn with such shapes, and URDF has no words for who may touch whom.
/// @returns the names of the bodies of each pair
std::vector<std::pair<std::string, std::string>> forbid_overlaps(nlohmann::ordered_json& document,
                                                                 const std::string& file);

}  // namespace taut::model
