#pragma once

#include <string>

#include "core/world/shape.h"

namespace taut {

/// Reads a mesh from an OBJ or STL file (text or binary) through assimp.  Polygons are cut into triangles,
/// all parts of the file become one mesh, and vertices in exactly one place become one, so that a closed STL
/// is closed. Coordinates are multiplied by `scale` (1e-3 for a file in millimetres).  Assimp keeps 24 bits
/// of them: an error of 6e-8 of their size.
/// @throws std::invalid_argument naming the file if it is missing, is neither .obj nor .stl, cannot be read
/// as such, or has no triangles; for a scale that is not positive; and for what check_shape() refuses.
TriangleMesh read_mesh(const std::string& file, double scale = 1);

}  // namespace taut
