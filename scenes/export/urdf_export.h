#pragma once

#include <string>
#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// A scene as a robot: one tree of links, the ground is its link "world".  URDF knows hinges, slides and
/// links that are fixed or free.  Values of joints are 0 at the start.
/// @param notices gets what URDF cannot say, one sentence each
std::string urdf_of(const Scene& scene, std::vector<std::string>& notices);

}  // namespace taut
