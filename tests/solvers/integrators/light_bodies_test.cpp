#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"

// Light bodies between heavy ones hold weakly, in the scale of their own rows, what hangs on them.
namespace taut::light_bodies_test {
namespace {

/// A hinge whose 5 t hang on a body of 1e-7 kg swings down from rest: joints have no rates, and energy is
/// kept.
class LightBodies : public ::testing::TestWithParam<Integrator> {};

TEST_P(LightBodies, CarryHeavyOnesWithoutRatesInTheirJoints) {
  World world;
  const BodyId light = world.add_body(
      {.mass = MassProperties::sphere(0.1, 1e-7), .pose = {Quat::Identity(), {0.1, 0.05, 0.2}}});
  const BodyId heavy = world.add_body(
      {.mass = MassProperties::box({0.3, 0.4, 0.35}, 5000), .pose = {Quat::Identity(), {0.3, 0.1, -0.1}}});
  world.add("pin", Hinge::at(world, kGround, light, {0, 0, 0}, Vec3(1, -1, -2).normalized()));
  world.add("weld", Fixed::at(world, light, heavy, {0.2, 0.1, 0.1}));
  Settings settings;
  settings.integrator = GetParam();
  Simulator simulator(world, settings);
  constexpr double kOpen = 1e-10 * 5000 * 9.81;  // tolerance of positions times the load [J]
  double energy = 0, moved = 0;
  for (int i = 0; i < 12; ++i) {
    const StepReport& report = simulator.step(5e-4);
    ASSERT_TRUE(report.exact()) << report.message;
    EXPECT_LE(report.velocity_residual, 1e-9) << "step " << i;
    if (i == 0) energy = report.energy();
    moved = std::max(moved, report.kinetic_energy);
    EXPECT_LE(std::abs(report.energy() - energy), 1e-5 * moved + kOpen) << "step " << i;
  }
  EXPECT_GT(moved, 1);
}

INSTANTIATE_TEST_SUITE_P(Orders, LightBodies,
                         ::testing::Values(Integrator::kRattle, Integrator::kRattle4, Integrator::kRattle8));

}  // namespace
}  // namespace taut::light_bodies_test
