#pragma once

#include <vector>

#include "scenes/scene.h"

namespace taut {

/// n × n nodes joined by rods of 0.1 m with a ball joint from one rod end of each node to every other:
///   net-flag      pinned at two neighbouring corners
///   net-corners   pinned at all four corners, with some slack
///   net-catch     net-corners whose rods touch a ball that falls into it
///   net           short name of net-corners with other defaults
/// All rows are independent.
std::vector<SceneInfo> net_scenes();

}  // namespace taut
