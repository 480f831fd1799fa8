#pragma once

#include <vector>

#include "scenes/scene.h"

namespace taut {

/// `ragdoll`: a body of eleven parts with cones, twist limits and hinges with limits, hung by its left hand.
std::vector<SceneInfo> ragdoll_scenes();

}  // namespace taut
