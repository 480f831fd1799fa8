#include <gtest/gtest.h>

#include <cmath>

#include "tests/solvers/laws/sliding_block.h"

// Dampers of axes by tables, against closed forms.
namespace taut::axis_tables_test {
namespace {

using testing::kG;
using testing::run;
using testing::Slide;

/// A table that is linear is the damper that it describes.
TEST(AxisSpring, WithALinearDampingTableIsTheDamper) {
  const auto end = [](bool table, double c) {
    Slide s(-Vec3::UnitZ());
    AxisSpring spring{.stiffness = 200};
    if (table)
      spring.damping_table = Curve({{-0.3, -0.3 * c}, {0.1, 0.1 * c}, {0.2, 0.2 * c}});
    else
      spring.damping = c;
    s.world.set_spring(s.axis, spring);
    Simulator simulator(s.world);
    run(simulator, 5e-3, 200);
    return std::pair(s.world.axis_value(s.axis), s.world.axis_rate(s.axis));
  };
  for (const double c : {0.5, 30.0, 1e4, 1e8}) {  // beyond 800 N·s/m the second kick is implicit
    const auto [x, v] = end(false, c);
    const auto [x_table, v_table] = end(true, c);
    EXPECT_NEAR(x_table, x, 1e-9) << c;
    EXPECT_NEAR(v_table, v, 1e-8) << c;
  }
}

/// Terminal speeds on a digressive damper: 19.62 N is 0.1 m/s on the steep segment with a tenth of the
/// weight, and 1.1 m/s on the flat one with all of it.  What it takes is in the ledger's damping.
TEST(AxisSpring, FallsAtTheRateOfItsDampingTable) {
  for (const double mass : {0.2, 2.0, 20.0}) {
    Slide s(-Vec3::UnitZ(), mass);
    AxisSpring damper;
    damper.damping_table = Curve({{-0.1, -9.81}, {0, 0}, {0.1, 9.81}, {2.1, 29.43}});
    s.world.set_spring(s.axis, damper);
    Simulator simulator(s.world);
    run(simulator, 1e-2, 4000);
    const double weight = mass * kG, rate = weight < 9.81 ? weight / 98.1 : 0.1 + (weight - 9.81) / 9.81;
    EXPECT_NEAR(s.world.axis_rate(s.axis), rate, 1e-6 * rate) << mass;
    EXPECT_NEAR(simulator.report().ledger.damping, -weight * rate * 1e-2, 1e-6 * weight * rate) << mass;
    EXPECT_NEAR(simulator.axis_report(s.axis).force.damping, -weight, 1e-6 * weight) << mass;
  }
}

/// Thrown against a digressive damper so steep at rest that Newton's method alone jumps over it: the way to
/// rest is that of m v' = −F(v), v from 3 to 0.1 m/s on the flat segment and then steeply down.
TEST(AxisSpring, StopsOnADampingTableThatIsSteepAtRest) {
  Slide s(Vec3::UnitX());
  AxisSpring damper;
  damper.damping_table = Curve({{-3, -12}, {-1e-3, -10}, {1e-3, 10}, {3, 12}});
  s.world.set_spring(s.axis, damper);
  s.world.set_twist(s.block, {Vec3::Zero(), Vec3(3, 0, 0)});
  Simulator simulator(s.world);
  run(simulator, 1e-2, 300);
  // F = 10 + b (v − 1e-3), b = 2/2.999: dx = −m v dv/F, and m v/1e4 less below 1e-3 m/s.
  const double b = 2 / 2.999, a = 10 - 1e-3 * b;
  const double way = 2 * ((3 - 1e-3) / b - a / (b * b) * std::log((a + 3 * b) / (a + 1e-3 * b)));
  EXPECT_NEAR(s.world.axis_value(s.axis), way + 2 * 1e-3 / 1e4, 1e-4);
  EXPECT_LE(std::abs(s.world.axis_rate(s.axis)), 1e-12);
}

}  // namespace
}  // namespace taut::axis_tables_test
