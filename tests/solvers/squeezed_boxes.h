#pragma once

#include "core/world/world.h"

namespace taut::testing {

/// How far each side of a box is in its wall [m]: less is what contacts may yield.
inline constexpr double kSqueeze = 3e-5;

/// Boxes between two rigid walls that are nearer to each other than the boxes are wide: no motion meets the
/// gaps of both sides, and no method the laws.
inline void add_squeezed_boxes(World& world) {
  world.add_shape(kGround, HalfSpace{});
  for (int side : {-1, 1}) world.add_shape(kGround, Box{{1, 40, 10}}, {.p = Vec3(side, 0, 5)});
  const Vec3 size(1 + 2 * kSqueeze, 0.5, 0.5);
  for (int k = 0; k < 5; ++k) {
    const BodyId box = world.add_body({.mass = MassProperties::box(size, 1), .pose = {.p = Vec3(0, k, 1)}});
    world.add_shape(box, Box{size});
    const BodyId top = world.add_body(  // which makes the boxes' laws a matter of other bodies
        {.mass = MassProperties::box(Vec3(0.5, 0.5, 0.5), 1), .pose = {.p = Vec3(0, k, 1.5)}});
    world.add_shape(top, Box{Vec3(0.5, 0.5, 0.5)});
  }
}

}  // namespace taut::testing
