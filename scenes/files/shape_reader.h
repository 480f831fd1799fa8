#pragma once

#include <filesystem>
#include <optional>

#include "scenes/builders/scene.h"
#include "scenes/files/json_reader.h"

/// Shapes and materials in JSON, of scene files and recordings alike.
namespace taut {

/// "type" and the sizes of that type; other keys of the object are left to the caller.  With a folder, hulls
/// and meshes can also come from a mesh file in it.  Nothing, and problems, for anything else or what
/// check_shape() refuses.
std::optional<PlacedShape> read_shape(JsonObject& keys, const std::filesystem::path* folder = nullptr);
/// The same for the types whose mass properties are closed forms.
std::optional<PlacedShape> read_primitive(JsonObject& keys);
/// Mass properties of a shape that read_primitive() gave.
MassProperties primitive_mass(const PlacedShape& primitive, double mass);

/// restitution, static_friction and so on, as the members of Material.
Material read_material(const JsonNode& node);

}  // namespace taut
