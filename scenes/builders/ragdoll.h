#pragma once

#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// `ragdoll`: a body of eleven parts with cones, twist limits and hinges with limits, hung by its left hand.
/// `ragdoll-stairs`: the same body, falling down stairs.
std::vector<SceneInfo> ragdoll_scenes();

}  // namespace taut
