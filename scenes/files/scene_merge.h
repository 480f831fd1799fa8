#pragma once

#include <string>

#include "scenes/builders/scene.h"

namespace taut {

/// Adds the world, probes and drawings of `block` to `scene` as World::append() does, every name with
/// `prefix` in front and moved as a whole by `placement`.  Gravity, settings and times stay those of `scene`.
/// @throws std::invalid_argument for a name that is taken.
void append_scene(Scene& scene, const Scene& block, const std::string& prefix, const Pose& placement);

/// The first of its names that is there already, as `body "rod_0"`; "" if none is.
std::string taken_name(const Scene& scene, const Scene& block, const std::string& prefix,
                       const Pose& placement);

}  // namespace taut
