#pragma once

#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// net-drag: a net with a load on it is dragged by two of its corners over bumpy ground.
std::vector<SceneInfo> net_drag_scenes();

}  // namespace taut
