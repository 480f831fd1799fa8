#pragma once

#include <string>
#include <utility>

#include "core/world/world.h"

namespace taut::testing {

/// One friction, static and dynamic.
inline Material rubbing(double friction, double restitution = 0) {
  Material material;
  material.static_friction = material.dynamic_friction = friction;
  material.restitution = restitution;
  return material;
}

/// A body of one shape, named by its number.
inline BodyId add_solid(World& world, const Shape& shape, MassProperties mass, const Pose& pose,
                        const Twist& twist, const Material& material) {
  const BodyId body = world.add_body({.name = std::string("b").append(std::to_string(world.body_count())),
                                      .mass = std::move(mass),
                                      .pose = pose,
                                      .twist = twist});
  world.add_shape(body, shape, {}, material);
  return body;
}

}  // namespace taut::testing
