#include <gtest/gtest.h>

#include <algorithm>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"

// A straight row of rods between two pins with gravity across: no finite force holds it, and joints that do
// not stretch let none of it sag.
namespace taut::taut_row_test {
namespace {

/// The row, from pin 0 to pin n, with a pendulum on the middle that has nothing to do with it.
struct Row {
  World world;
  explicit Row(int n, bool last_pin = true) {
    BodyId last = kGround;
    for (int i = 0; i < n; ++i) {
      BodySpec rod{.name = "rod " + std::to_string(i), .mass = MassProperties::rod(1, 0.01, 1)};
      rod.pose.p = Vec3(i + 0.5, 0, 0);
      const BodyId body = world.add_body(rod);
      world.add("pin " + std::to_string(i), Ball::at(world, last, body, Vec3(i, 0, 0)));
      last = body;
      if (i == n / 2) add_bystander(body, Vec3(i + 0.5, 0, 0));
    }
    if (last_pin) world.add("pin " + std::to_string(n), Ball::at(world, last, kGround, Vec3(n, 0, 0)));
  }
  void add_bystander(BodyId on, const Vec3& at) {
    BodySpec bob{.name = "bob", .mass = MassProperties::sphere(0.1, 0.1)};
    bob.pose.p = at - Vec3(0, 0, 0.5);
    world.add("bystander", Ball::at(world, on, world.add_body(bob), at));
  }
};

TEST(TautRow, ThatHasALoadAcrossIsNamedFromPinToPin) {
  for (const int n : {8, 24, 100, 1000}) {
    Row row(n);
    Simulator simulator(row.world);
    for (int i = 0; i < 40; ++i)
      if (!simulator.step(1e-3).ok()) break;
    const StepReport& report = simulator.report();
    ASSERT_EQ(report.status, Status::kContradiction) << n << ": " << report.message;
    EXPECT_TRUE(report.contradiction.bounds.empty() && report.contradiction.contacts.empty());
    EXPECT_GT(report.contradiction.residual, 0.5e-10);
    EXPECT_LT(report.contradiction.residual, 1e-9);
    std::vector<std::string> expected, named = names_of(report.contradiction, row.world);
    for (int i = 0; i <= n; ++i) expected.push_back("ball pin " + std::to_string(i));
    if (n > 24) {  // larger sets are in the order of the world
      EXPECT_EQ(named, expected);
      const std::string ends =
          "ball pin 0, ball pin 1, ball pin 2, ball pin 3, ball pin 4, ball pin 5, ball pin 6 … ball pin ";
      EXPECT_NE(report.message.find(ends + std::to_string(n) + ", " + std::to_string(n + 1) + " in all"),
                std::string::npos)
          << report.message;
    }
    std::sort(named.begin(), named.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(named, expected);
  }
}

TEST(TautRow, WithoutItsLastPinSwings) {
  Row row(100, false);
  Simulator simulator(row.world);
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
}

}  // namespace
}  // namespace taut::taut_row_test
