#pragma once

#include <string>

#include "scenes/scene.h"

namespace taut {

/// Adds the bodies, joints, probes and drawings of `block` to `scene`, every name with `prefix` in front,
/// moved as a whole by `placement` (X_WF of the block's world frame F).  What the block fixes to the ground
/// is then fixed to the ground of `scene`, or with a placement to a new fixed body `prefix`ground that has
/// this pose. Gravity, settings and times stay those of `scene`.
/// @throws std::invalid_argument for a name that is taken, or a block with forces: a Force acts on the ids of
/// its own world.
void append_scene(Scene& scene, const Scene& block, const std::string& prefix, const Pose& placement);

}  // namespace taut
