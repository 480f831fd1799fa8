#pragma once

#include "scenes/builders/scene.h"

namespace taut {

/// A cylinder along body x, as MassProperties::rod() has it.
PlacedShape rod_shape(double length, double radius);

/// Has a body of the scene drawn as this shape; nothing collides and no mass changes.
/// @throws std::invalid_argument for a body that is not there or what check_shape() refuses.
void draw(Scene& scene, BodyId body, const PlacedShape& shape);

}  // namespace taut
