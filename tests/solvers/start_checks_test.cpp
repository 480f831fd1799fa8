#include "solvers/start_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/joints.h"
#include "solvers/simulator.h"

// What is said of a world before its first step, against what the simulator then makes of it.
namespace taut {
namespace {

/// A chain of turned bodies on balls and hinges, of which every fourth is there twice, thrown at random.
World thrown_chain(int n, std::mt19937& random) {
  std::uniform_real_distribution<double> part(-1, 1);
  const auto vector = [&] { return Vec3(part(random), part(random), part(random)); };
  World world;
  BodyId last = kGround;
  for (int i = 0; i < n; ++i) {
    const Vec3 end = Vec3(i, 0, 0);
    const BodyId body = world.add_body({.mass = {1 + part(random) / 2, Vec3(0.1, 0.15, 0.2)},
                                        .pose = {exp_so3(vector()), end + 0.5 * vector()},
                                        .twist = {vector(), vector()}});
    for (int copy = 0; copy < (i % 4 == 0 ? 2 : 1); ++copy) {
      if (i % 2 == 0)
        world.add("", Ball::at(world, last, body, end));
      else
        world.add("", Hinge::at(world, last, body, end, Vec3::UnitY()));
    }
    last = body;
  }
  return world;
}

TEST(StartChecks, ForbiddenVelocityIsWhatTheFirstStepTakesAway) {
  std::mt19937 random(5);
  for (const int n : {1, 2, 7, 30}) {
    const World world = thrown_chain(n, random);
    World closed = world;
    Simulator simulator(closed);
    ASSERT_TRUE(simulator.assemble().ok());
    double speed = 0, spin = 0;
    for (int b = 0; b < world.body_count(); ++b) {
      const Twist &before = world.state().twists[b], &after = closed.state().twists[b];
      speed = std::max(speed, (before.v - after.v).norm());
      spin = std::max(spin, (before.w - after.w).norm());
    }
    const ForbiddenVelocity found = forbidden_velocity(world);
    EXPECT_NEAR(found.speed, speed, 1e-8 * speed);  // the shift that makes dependent rows safe
    EXPECT_NEAR(found.spin, spin, 1e-8 * spin);
    EXPECT_EQ(found.joints.size(), world.joint_count());
    EXPECT_TRUE(forbidden_velocity(closed).empty());
  }
}

TEST(StartChecks, TheCoarsestPositionIsThatOfTheFarthestCoordinate) {
  World world;
  world.add_body({.pose = {Quat::Identity(), Vec3(1, -1e7, 3)}});
  world.add_body({.pose = {Quat::Identity(), Vec3(5e6, 0, 0)}});
  EXPECT_EQ(coarsest_position(world), std::ldexp(1, 23 - 52));  // 2²³ ≤ 10⁷ < 2²⁴
}

}  // namespace
}  // namespace taut
