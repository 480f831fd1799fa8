#pragma once

#include <vector>

#include "scenes/builders/scene.h"

namespace taut {

/// joint-grid: n × n spheres of radius 0.4 m and 1000 kg/m³ at (k, −i, 0), row i = 0 fixed, with ball joints
/// half-way between vertical neighbours and, below the fixed row, between horizontal ones.  3 (n − 1)(2n − 1)
/// rows, of which (n − 1)(n − 2) are redundant: within its plane the grid is rigid.
///
/// Gravity is along −y, where the grid hangs, or with `swing` along −z, where it swings down.
std::vector<SceneInfo> joint_grid_scenes();

}  // namespace taut
