#pragma once

#include <string>
#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// A scene as a model for MuJoCo: trees of bodies, with equalities and tendons for what closes loops.
/// MuJoCo's contacts, limits and equalities are compliant; taut's are not.
/// @param notices gets what MJCF cannot say, one sentence each
std::string mjcf_of(const Scene& scene, std::vector<std::string>& notices);

}  // namespace taut
