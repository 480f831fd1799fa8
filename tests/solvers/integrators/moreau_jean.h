#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/contact_bodies.h"

/// What tests of Moreau–Jean time stepping share.
namespace taut::moreau_jean_parts {

inline constexpr double kG = 9.81;

inline Settings moreau_jean(double theta = 0.5, DriftCure cure = DriftCure::kAuto) {
  Settings settings;
  settings.integrator = Integrator::kMoreauJean;
  settings.theta = theta;
  settings.drift_cure = cure;
  return settings;
}

inline std::string numbered(const char* what, int i) {
  std::string name = what;
  name += std::to_string(i);
  return name;
}

inline BodyId add_box(World& world, const std::string& name, const Vec3& size, const Vec3& position,
                      const Material& material, double mass = 1) {
  const BodyId body =
      world.add_body({.name = name, .mass = MassProperties::box(size, mass), .pose = {.p = position}});
  world.add_shape(body, Box{size}, {}, material);
  return body;
}

inline BodyId add_ball(World& world, const std::string& name, const Vec3& position, const Material& material,
                       double mass = 1, double radius = 0.1) {
  const BodyId body =
      world.add_body({.name = name, .mass = MassProperties::sphere(radius, mass), .pose = {.p = position}});
  world.add_shape(body, Sphere{radius}, {}, material);
  return body;
}

inline void run(Simulator& simulator, double dt, int steps) {
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulator.step(dt);
    ASSERT_TRUE(report.exact()) << "step " << i << ": " << report.message;
    ASSERT_LE(report.natural_residual, 1e-8) << "step " << i;
    ASSERT_LE(report.velocity_residual, 1e-9) << "step " << i;
  }
}

/// A chain of rods of 0.2 m on ball joints; the first hangs from the world at `top`, or is free.
inline std::vector<BodyId> add_chain(World& world, int links, const Vec3& top, bool hangs,
                                     const Material* material) {
  std::vector<BodyId> rods;
  for (int i = 0; i < links; ++i) {
    const Vec3 centre = top + Vec3(0.2 * i + 0.1, 0, 0);
    rods.push_back(world.add_body({.name = numbered("rod", i),
                                   .mass = MassProperties::box(Vec3(0.2, 0.04, 0.04), 0.3),
                                   .pose = {.p = centre}}));
    if (material) world.add_shape(rods.back(), Box{Vec3(0.2, 0.04, 0.04)}, {}, *material);
    if (i > 0 || hangs)
      world.add(numbered("joint", i),
                Ball::at(world, i > 0 ? rods[i - 1] : kGround, rods[i], top + Vec3(0.2 * i, 0, 0)));
  }
  return rods;
}

}  // namespace taut::moreau_jean_parts
