#pragma once

#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// `suspension-bridge`: a deck of planks on ropes from a cable of rods between two towers.  A load drives
/// over it, under which the ropes break one after another if they are too weak.
std::vector<SceneInfo> suspension_bridge_scenes();

}  // namespace taut
