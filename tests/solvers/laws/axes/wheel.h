#pragma once

#include "core/joints/joints.h"
#include "core/world/world.h"

namespace taut::axes_test {

/// A wheel about z.
struct Wheel {
  World world;
  BodyId wheel;
  AxisId axis;
  double inertia;
  explicit Wheel(double mass = 3, double radius = 0.2) {
    const MassProperties m = MassProperties::cylinder(radius, 0.05, mass);
    wheel = world.add_body({.name = "wheel", .mass = m});
    const JointId joint = world.add("axle", Hinge::at(world, kGround, wheel, Vec3::Zero(), Vec3::UnitZ()));
    axis = world.axis(joint, "angle");
    inertia = m.inertia_B()(2, 2);
    world.set_gravity(Vec3::Zero());
  }
};

}  // namespace taut::axes_test
