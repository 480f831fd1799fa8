// Contacts whose normals joints hold: no impulse changes their rates.
#include <gtest/gtest.h>

#include <algorithm>

#include "solvers/simulator/simulator.h"
#include "tests/solvers/chain_on_floor.h"

namespace taut::held_normals_test {
namespace {

struct ChainOnFloor {
  double friction, dt;
  int links;
};

class HeldNormals : public ::testing::TestWithParam<ChainOnFloor> {};

/// Links fold back onto their neighbours, which do not collide with them: then the first and the last of
/// three in one line touch at their ends, and each of them may give way by what is of second order alone.
TEST_P(HeldNormals, OfAChainOnAFloorEndNoRun) {
  World world = testing::chain_on_floor(GetParam().links, GetParam().friction);
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
  EXPECT_LE(gained, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Chains, HeldNormals,
                         ::testing::Values(ChainOnFloor{0, 0.002, 10}, ChainOnFloor{0, 0.008, 10},
                                           ChainOnFloor{0.3, 0.002, 10}, ChainOnFloor{0.3, 0.004, 10},
                                           ChainOnFloor{0.3, 0.008, 10}, ChainOnFloor{0.7, 0.004, 3},
                                           ChainOnFloor{1, 0.004, 10}));

}  // namespace
}  // namespace taut::held_normals_test
