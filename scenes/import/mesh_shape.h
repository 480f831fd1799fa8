#pragma once

#include <filesystem>
#include <optional>

#include "scenes/import/robot_model.h"

namespace taut::model {

/// Where the file is that a model names: beside `folder`, or for package://NAME/REST and model://NAME/REST in
/// a folder NAME above it; empty: nowhere.
std::filesystem::path find_mesh(const std::filesystem::path& folder, std::string_view name);

/// The convex hull of a mesh file, with its coordinates scaled; what shapes of robots collide as.
/// @throws std::invalid_argument if there is no such file, or it is neither OBJ nor STL, or flat.
ConvexHull mesh_hull(const std::filesystem::path& folder, std::string_view name, const Vec3& scale);

}  // namespace taut::model
