#pragma once

#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// stack, wall, heap, pile and card-house: bodies without joints on a floor.
std::vector<SceneInfo> stack_scenes();

}  // namespace taut
