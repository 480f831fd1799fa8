#pragma once

#include <vector>

#include "scenes/scene.h"

namespace taut {

/// stack, wall and heap: bodies without joints on a floor.
std::vector<SceneInfo> stack_scenes();

}  // namespace taut
