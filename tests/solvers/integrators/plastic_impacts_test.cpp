#include <gtest/gtest.h>

#include <numbers>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/contact_bodies.h"

/// With Settings::locate_plastic_impacts what follows an impact without restitution is of order 2, too.
namespace taut::plastic_impacts_test {
namespace {

using namespace contact_worlds;

constexpr double kTilt = 6 * std::numbers::pi / 180, kHalf = 0.15, kHeight = 0.6;

/// A block of 0.3 m × 1.2 m that is let go on one edge, comes down on the other and rocks on.
World rocking_block() {
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, rubbing(1));
  const Quat q(Eigen::AngleAxisd(kTilt, Vec3::UnitY()));
  const Vec3 edge(kHalf, 0, 0);
  const BodyId block = world.add_body({.name = "block",
                                       .mass = {10, Vec3(1.275, 1.275, 0.15)},
                                       .pose = {q, edge + q * Vec3(-kHalf, 0, kHeight)}});
  world.add_shape(block, Box{Vec3(0.3, 0.3, 1.2)}, {}, rubbing(1));
  return world;
}

/// Upper and lower leg that swing; the knee stops at its limit with a jolt.
World leg_with_a_knee() {
  World world;
  const MassProperties leg(1, Vec3(0.02, 0.02, 0.001));
  const BodyId thigh =
      world.add_body({.name = "thigh", .mass = leg, .pose = {Quat::Identity(), Vec3(0, 0, -0.25)}});
  const BodyId shank =
      world.add_body({.name = "shank", .mass = leg, .pose = {Quat::Identity(), Vec3(0, 0, -0.75)}});
  world.add("hip", Hinge::at(world, kGround, thigh, Vec3::Zero(), Vec3::UnitY()));
  const JointId knee = world.add("knee", Hinge::at(world, thigh, shank, Vec3(0, 0, -0.5), Vec3::UnitY()));
  world.set_limits(AxisId{knee, 0}, AxisLimits{.lower = -1, .upper = 0.05});
  world.set_twist(shank, {Vec3(0, 3, 0), Vec3(-0.75, 0, 0)});
  return world;
}

/// Positions after this many steps to `time`.
Eigen::VectorXd end_of(World (*make)(), double time, int steps, bool located) {
  World world = make();
  Settings settings;
  settings.locate_plastic_impacts = located;
  Simulator simulator(world, settings);
  for (int i = 0; i < steps; ++i)
    EXPECT_TRUE(simulator.step(time / steps).exact()) << simulator.report().message;
  Eigen::VectorXd p(3 * (world.body_count() - 1));
  for (int b = 1; b < world.body_count(); ++b) p.segment<3>(3 * (b - 1)) = world.pose(BodyId{b}).p;
  return p;
}

struct Motion {
  const char* name;
  World (*make)();
  double curvature;  ///< error over h² [m/s²]
};
class PlasticImpacts : public ::testing::TestWithParam<Motion> {};

/// Beside that is what tolerances of positions and of the time of an impact leave.
TEST_P(PlasticImpacts, LeaveErrorsOfOrder2WhereTheyAreLocated) {
  const auto& [name, make, curvature] = GetParam();
  constexpr double kTime = 0.6, kLeft = 1e-8;
  const Eigen::VectorXd truth = end_of(make, kTime, 8320, true);
  for (const int steps : {130, 260, 520}) {
    const double h = kTime / steps;
    const double located = (end_of(make, kTime, steps, true) - truth).norm();
    const double late = (end_of(make, kTime, steps, false) - truth).norm();
    EXPECT_LE(located, curvature * h * h + kLeft) << steps;
    EXPECT_LE(located, 0.06 * late) << steps;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, PlasticImpacts,
                         ::testing::Values(Motion{"block", rocking_block, 0.01},
                                           Motion{"knee", leg_with_a_knee, 0.08}),
                         [](const auto& motion) { return std::string(motion.param.name); });

}  // namespace
}  // namespace taut::plastic_impacts_test
