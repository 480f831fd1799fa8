// Contacts whose normals joints hold: no impulse changes their rates.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/joints/ball.h"
#include "solvers/simulator/simulator.h"

namespace taut::held_normals_test {
namespace {

struct ChainOnFloor {
  double friction, dt;
  int links;
};

class HeldNormals : public ::testing::TestWithParam<ChainOnFloor> {};

/// A chain of capsules, straight at first, that swings down and folds on a floor.  Links fold back onto their
/// neighbours, which do not collide with them: then the first and the last of three in one line touch at
/// their ends, and each of them may give way by what is of second order alone.
World chain_on_floor(const ChainOnFloor& chain) {
  constexpr double kLength = 0.2, kRadius = 0.02, kHeight = 1.2;
  World world;
  const Material material{.static_friction = chain.friction, .dynamic_friction = chain.friction};
  world.add_shape(kGround, HalfSpace{}, {}, material);
  const Capsule shape{kRadius, kLength - 2 * kRadius};
  BodyId last = kGround;
  for (int i = 0; i < chain.links; ++i) {
    BodySpec link{.name = std::to_string(i), .mass = MassProperties::capsule(kRadius, shape.length, 1.7)};
    link.pose = {.q = Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitY())),
                 .p = Vec3((i + 0.5) * kLength, 0, kHeight)};
    const BodyId body = world.add_body(link);
    world.add_shape(body, shape, {}, material);
    world.add(link.name, Ball::at(world, last, body, Vec3(i * kLength, 0, kHeight)));
    last = body;
  }
  return world;
}

TEST_P(HeldNormals, OfAChainOnAFloorEndNoRun) {
  World world = chain_on_floor(GetParam());
  Simulator simulator(world);
  double penetration = 0, gained = 0;
  for (int i = 0; i < 2.5 / GetParam().dt; ++i) {
    const StepReport& report = simulator.step(GetParam().dt);
    ASSERT_TRUE(report.ok()) << world.time() << ' ' << report.message;
    ASSERT_LE(report.gap.metres, 1e-9);
    penetration = std::max(penetration, report.penetration);
    gained = std::max(gained, report.ledger.contacts);
  }
  EXPECT_LE(penetration, 1e-4);
  // With 8 ms a step of this chain without friction, which has no such contact, gains 8e-3 J of 20 J.
  EXPECT_LE(gained, GetParam().dt < 0.005 ? 1e-6 : 1e-2);
}

INSTANTIATE_TEST_SUITE_P(Chains, HeldNormals,
                         ::testing::Values(ChainOnFloor{0, 0.002, 10}, ChainOnFloor{0, 0.008, 10},
                                           ChainOnFloor{0.3, 0.002, 10}, ChainOnFloor{0.3, 0.004, 10},
                                           ChainOnFloor{0.3, 0.008, 10}, ChainOnFloor{0.7, 0.004, 3},
                                           ChainOnFloor{1, 0.004, 10}));

}  // namespace
}  // namespace taut::held_normals_test
