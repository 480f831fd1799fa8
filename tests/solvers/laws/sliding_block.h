#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"

namespace taut::testing {

inline constexpr double kG = 9.81;

/// A block of 2 kg on a slider along `axis` through the origin.
struct Slide {
  World world;
  BodyId block;
  JointId joint;
  AxisId axis;
  explicit Slide(const Vec3& direction, double mass = 2) {
    block = world.add_body({.name = "block", .mass = MassProperties::box(Vec3(0.1, 0.1, 0.1), mass)});
    joint = world.add("slide", Slider::at(world, kGround, block, Vec3::Zero(), direction));
    axis = world.axis(joint, "displacement");
  }
};

inline void run(Simulator& simulator, double dt, int steps) {
  for (int i = 0; i < steps; ++i) {
    const StepReport& r = simulator.step(dt);
    ASSERT_TRUE(r.exact()) << "step " << i << ": " << r.message;
    ASSERT_LE(r.complementarity_residual, 1e-9);
    ASSERT_NEAR(r.ledger.start + r.ledger.total(), r.energy(), 1e-12 * (1 + std::abs(r.energy()))) << i;
    ASSERT_LE(std::max(r.gap.metres, r.gap.radians), 1e-9);
  }
}

}  // namespace taut::testing
