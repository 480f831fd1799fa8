#pragma once

#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// Mechanisms with limits, motors, drivers and wires:
///   n-four-bar   n windows of 1 m bars that fall through their singular positions
///   car          chassis on a stand, four hinge-2 wheels, engine with a torque curve, differential, steering
///   robot-arm    six axes whose motors follow a trajectory with limited torque
///   crane        boom on a luffing rope, hook on a wire over sheaves that a winch pulls
std::vector<SceneInfo> machine_scenes();

}  // namespace taut
