#include "scenes/builders/drawing.h"

#include <numbers>

namespace taut {

PlacedShape rod_shape(double length, double radius) {
  const Quat z_to_x = exp_so3(Vec3(0, std::numbers::pi / 2, 0));
  return {Cylinder{radius, length}, {z_to_x, Vec3::Zero()}};
}

void draw(Scene& scene, BodyId body, const PlacedShape& shape) {
  (void)scene.world.name(body);  // throws for a body that is not there
  check_shape(shape.shape);
  scene.drawings.push_back({body, shape});
}

}  // namespace taut
