#pragma once

#include <filesystem>
#include <optional>

#include "scenes/import/robot_model.h"

namespace taut::model {

/// Where the file is that a model names: beside `folder`, or for package://NAME/REST and model://NAME/REST in
/// a folder NAME above it.
/// @throws std::invalid_argument if it is nowhere; `what` is to be in it.
std::filesystem::path find_asset(const char* what, const std::filesystem::path& folder,
                                 std::string_view name);

/// A mesh file, with its coordinates scaled; a scale that mirrors turns the triangles round.
/// @throws std::invalid_argument if there is no such file, or it is neither OBJ nor STL.
TriangleMesh scaled_mesh(const std::filesystem::path& folder, std::string_view name, const Vec3& scale);

/// The volume of a mesh as MJCF counts it, of density 1: from tetrahedra between each triangle and a point
/// within.
enum class MeshVolume {
  kExact,   ///< with their signs
  kLegacy,  ///< without: hollows count twice
};
LinkInertia mesh_inertia(const TriangleMesh& mesh, MeshVolume volume);

/// The convex hull of a mesh file, with its coordinates scaled; what shapes of robots collide as.
/// @throws std::invalid_argument if there is no such file, or it is neither OBJ nor STL, or flat.
ConvexHull mesh_hull(const std::filesystem::path& folder, std::string_view name, const Vec3& scale);

}  // namespace taut::model
