#pragma once

#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// vehicle-bridge: a vehicle drives over a hanging bridge.
std::vector<SceneInfo> crossing_scenes();

}  // namespace taut
