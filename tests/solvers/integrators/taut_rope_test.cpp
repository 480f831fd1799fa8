#include <gtest/gtest.h>

#include <cmath>

#include "core/joints/joints.h"
#include "tests/solvers/integrators/measured_order.h"

// A rope under tension is a joint like others.
namespace taut::taut_rope_test {
namespace {

/// A block that swings in space on a rope over a pin, from a corner, fast enough to keep it taut.
struct RopePendulum {
  World world;
  RopePendulum() {
    const Vec3 pin(0, 0, 0.4), corner(0.1, 0.05, 0.1), p(1, 0, -1), w(0.3, -0.2, 0.5);
    const Vec3 line = p + corner - pin, n = line.normalized();
    Vec3 v(0, 1.5, 0);
    v -= n.dot(v + w.cross(corner)) * n;  // the rope is neither jerked nor slack at first
    const BodyId block =
        world.add_body({.mass = {1.5, Vec3(0.2, 0.3, 0.35)}, .pose = {Quat::Identity(), p}, .twist = {w, v}});
    world.add("rope",
              Rope({{kGround, Vec3(0.5, 0, 0.4)}, {kGround, pin}, {block, corner}}, 0.5 + line.norm()));
  }
  static void expect_taut(const World& world, Simulator& simulator) {
    const AxisId axis{world.joint("rope"), 0};
    const double limit = world.axis_properties(axis).limits->upper;
    EXPECT_NEAR(world.axis_value(axis), limit, 1e-9);
    EXPECT_LT(simulator.axis_report(axis).force.limit, -1);
  }
};

TEST(TautRope, KeepsTheSecondOrder) {
  const double order = testing::order_of([] { return RopePendulum().world; }, RopePendulum::expect_taut);
  EXPECT_GT(order, 1.5);
}

/// 10 s: the energy error, 3e-4 J at 5 ms, is of second order, without drift.
TEST(TautRope, StaysTautAndKeepsItsEnergy) {
  const auto worst_at = [](double h) {
    RopePendulum p;
    Simulator simulator(p.world);
    double worst = 0, start = 0;
    for (int i = 0; i < std::lround(10 / h); ++i) {
      EXPECT_TRUE(simulator.step(h).exact()) << i << ": " << simulator.report().message;
      RopePendulum::expect_taut(p.world, simulator);
      if (i == 0) start = simulator.report().energy();
      worst = std::max(worst, std::abs(simulator.report().energy() - start));
    }
    return worst;
  };
  const double coarse = worst_at(5e-3), fine = worst_at(2.5e-3);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_LT(fine, 0.35 * coarse);
}

}  // namespace
}  // namespace taut::taut_rope_test
