#pragma once

#include <set>
#include <string>
#include <string_view>

#include "scenes/builders/scene.h"

namespace taut {

/// The look of a name: all its numbers are 0, so that "rod_12" looks like "rod_0".
std::string look_of(std::string_view name);

/// The looks of the names of bodies, joints and materials that a builder makes, whatever its parameters.
std::set<std::string> looks_of(const SceneInfo& builder);

}  // namespace taut
