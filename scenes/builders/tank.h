#pragma once

#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// tank: a tracked vehicle on flat ground, a ramp or bumps.
std::vector<SceneInfo> tank_scenes();

}  // namespace taut
