#pragma once

#include <string>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"

namespace taut {

/// What a run with steps of dt would not say by itself of the state that it starts from, a sentence each:
/// velocities that joints forbid, positions too far from the origin for joints to close, shapes that pass
/// through each other, bodies in each other, and springs that are too fast for an integrator that takes them
/// as forces.
std::vector<std::string> start_warnings(const World& world, const Settings& settings, double dt);

/// The one on pairs of shapes that may touch and have no law for it, wherever they are; or none.
std::string passing_warning(const World& world, const Settings& settings);

}  // namespace taut
