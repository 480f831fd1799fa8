#pragma once

#include <nlohmann/json.hpp>

#include "core/world/shape.h"

namespace taut {

/// {"type": "box", "size": [x, y, z]} and so on: shape_name() and the members of the shape under their names.
nlohmann::json shape_to_json(const Shape& shape);
/// @throws std::exception for anything else, or what check_shape() refuses.
Shape shape_from_json(const nlohmann::json& json);

nlohmann::json vector_to_json(const Vec3& v);
Vec3 vector_from_json(const nlohmann::json& json);

}  // namespace taut
