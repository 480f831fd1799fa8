#pragma once

#include <gtest/gtest.h>

#include "solvers/simulator/simulator.h"

// Worlds and simulators of the tests of sleep.
namespace taut::testing {

inline constexpr double kStep = 1.0 / 240;

inline Settings sleeping(bool sleep = true) {
  Settings settings;
  settings.sleep = sleep;
  return settings;
}

inline World with_floor() {
  World world;
  world.add_shape(kGround, HalfSpace{});
  return world;
}

/// A box of 0.2 m and 1 kg with friction.
inline BodyId add_box(World& world, const Vec3& p, Material material = {}) {
  const BodyId box =
      world.add_body({.mass = MassProperties::box({0.2, 0.2, 0.2}, 1), .pose = {Quat::Identity(), p}});
  material.static_friction = material.dynamic_friction = 0.5;
  world.add_shape(box, Box{{0.2, 0.2, 0.2}}, {}, material);
  return box;
}

inline void advance(Simulator& simulator, int steps, double dt = kStep) {
  for (int i = 0; i < steps; ++i)
    ASSERT_TRUE(simulator.step(dt).exact()) << "step " << i << ": " << simulator.report().message;
}

}  // namespace taut::testing
