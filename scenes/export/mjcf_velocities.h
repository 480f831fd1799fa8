#pragma once

#include <string>
#include <vector>

#include "scenes/export/model_tree.h"

namespace taut {

/// The velocities of a world as `qvel` of a <key>, joint by joint in the order of the bodies as they stand in
/// the file, depth first: of a free body that of its origin, world axes, and its angular velocity in its own
/// axes; of a ball the angular velocity against the parent, in the axes of the body; of a hinge or slide its
/// rate.  "" if nothing moves.  Bodies that move as their joints forbid are a notice.
std::string mjcf_velocities(const World& world, const ModelTree& tree, std::vector<std::string>& notices);

}  // namespace taut
