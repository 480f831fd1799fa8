#pragma once

#include <string>
#include <vector>

#include "core/world.h"
#include "solvers/settings.h"

namespace taut {

/// What a run would not say by itself of the state that it starts from, a sentence each: velocities that
/// joints forbid, and positions too far from the origin for joints to close.
std::vector<std::string> start_warnings(const World& world, const Settings& settings);

}  // namespace taut
