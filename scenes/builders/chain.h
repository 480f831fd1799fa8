#pragma once

#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// Rods in a row, hung from the world at one end and released from the horizontal:
///   pendulum-ball, pendulum-hinge   1 m, 1 kg rods
///   chain                           0.1 m, 0.1 kg rods on ball joints
///   chain-heavy                     the same with 100 kg at the free end
std::vector<SceneInfo> chain_scenes();

}  // namespace taut
