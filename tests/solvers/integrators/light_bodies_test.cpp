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

/// Two free bodies of 10 and 20 t spin on a light one between them: its joints were closed by moves without
/// momentum, 2e-7 of the angular momentum a step.
TEST(RobustLightBodies, KeepTheAngularMomentumOfHeavyOnes) {
  for (const double light : {1.0, 1e-3, 1e-4, 1e-5, 1e-6}) {
    SCOPED_TRACE(light);
    World world;
    world.set_gravity(Vec3::Zero());
    const Vec3 spin(0.4, 0.3, -0.5);
    const auto add = [&](double mass, double size, const Vec3& p, const Vec3& w) {
      return world.add_body({.mass = MassProperties::box(size * Vec3(1, 0.8, 0.6), mass),
                             .pose = {exp_so3(Vec3(0.3, 0.2, 0.1)), p},
                             .twist = {w, spin.cross(p)}});
    };
    const BodyId a = add(1e4, 1, {1, 0, 0}, spin), between = add(light, 0.3, {0, 0, 0}, spin),
                 b = add(2e4, 1, {-1, 0.2, 0}, {0.1, -0.3, 0.2});
    world.add("weld", Fixed::at(world, a, between, {0.4, 0.1, 0}));
    world.add("pin", Ball::at(world, between, b, {-0.3, 0, 0.1}));
    Simulator simulator(world);
    Vec3 L;
    for (int i = 0; i <= 20; ++i) {
      const StepReport& report = simulator.step(0.04);
      ASSERT_TRUE(report.ok()) << report.message;
      if (i == 0) L = report.angular_momentum;
      // Joints that are open by 1e-10 m are the arms of couples.
      EXPECT_LE((report.angular_momentum - L).norm(), 1e-9 * L.norm()) << "step " << i;
      EXPECT_LE(report.gap.metres, 1e-9);
    }
  }
}

}  // namespace
}  // namespace taut::light_bodies_test
