#pragma once

#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// chain-over-cylinder: a chain with a weight at each end over a fixed drum.
std::vector<SceneInfo> capstan_scenes();

}  // namespace taut
