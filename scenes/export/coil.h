#pragma once

#include "scenes/export/shape_mesh.h"

namespace taut {

/// What a spring looks like: a helix of round wire along z from −½ to ½ with straight ends on the axis.  It
/// is meant to be scaled by (r, r, L), and its wire is round where the radius is r = kCoilSlimness L.
inline constexpr double kCoilSlimness = 0.05;
DrawingMesh coil_mesh(int turns = 9, int corners_per_turn = 12, int corners_of_wire = 6);

}  // namespace taut
