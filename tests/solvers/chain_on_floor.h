#pragma once

#include <numbers>

#include "core/joints/ball.h"
#include "core/math/so3.h"
#include "core/world/world.h"

namespace taut::testing {

/// Capsules of steel on ball joints, straight along x at first, that swing down and fall on a floor.
inline World chain_on_floor(int links, double friction) {
  World world;
  const Material material{.static_friction = friction, .dynamic_friction = friction};
  world.add_shape(kGround, HalfSpace{}, {}, material);
  BodyId last = kGround;
  const Quat along_x = exp_so3(Vec3(0, std::numbers::pi / 2, 0));
  for (int k = 0; k < links; ++k) {
    const BodySpec link{.mass = MassProperties::capsule(0.02, 0.16, Density{7800}),
                        .pose = {along_x, Vec3(0.1 + 0.2 * k, 0, 1.2)}};
    const BodyId body = world.add_body(link);
    world.add_shape(body, Capsule{0.02, 0.16}, {}, material);
    world.add("", Ball::at(world, last, body, Vec3(0.2 * k, 0, 1.2)));
    last = body;
  }
  return world;
}

}  // namespace taut::testing
