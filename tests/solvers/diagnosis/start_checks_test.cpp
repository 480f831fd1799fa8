#include "solvers/diagnosis/start_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"

// What is said of a world before its first step, against what the simulator then makes of it.
namespace taut::start_checks_test {
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
    ASSERT_TRUE(simulator.assemble().exact());
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

TEST(StartChecks, OverlapsAreThoseOfPairsThatMayTouchWithTheirDepth) {
  World world;
  world.add_shape(kGround, HalfSpace{});
  const auto ball = [&](double x, double z) {
    const BodyId body =
        world.add_body({.mass = MassProperties::sphere(0.5, 1), .pose = {.p = Vec3(x, 0, z)}});
    world.add_shape(body, Sphere{0.5});
    return body;
  };
  const BodyId low = ball(0, 0.4), a = ball(5, 3), b = ball(5.3, 3), c = ball(-5, 3), d = ball(-5, 3);
  ball(20, 0.5 - 1e-6);
  world.set_collision(c, d, false);
  const std::vector<StartOverlap> found = start_overlaps(world);
  ASSERT_EQ(found.size(), 2);
  EXPECT_EQ(found[0].a, a);
  EXPECT_EQ(found[0].b, b);
  EXPECT_NEAR(found[0].depth, 0.7, 1e-12);
  EXPECT_EQ(found[1].a, kGround);
  EXPECT_EQ(found[1].b, low);
  EXPECT_NEAR(found[1].depth, 0.1, 1e-12);
}

/// Two balls on a spring, one on a spring to the ground whose ends may meet, and a rod that is pulled across
/// at its end: ω² = k (1/m₁ + 1/m₂), k/m and k (1/m + l²/I).
TEST(StartChecks, SpringsThatAreTooFastAreThoseOfTheirFrequencies) {
  World world;
  const BodyId light = world.add_body({.name = "light", .mass = MassProperties::sphere(0.1, 1)});
  const BodyId heavy = world.add_body({.mass = MassProperties::sphere(0.1, 3), .pose = {.p = Vec3(1, 2, 3)}});
  const BodyId rod = world.add_body({.mass = {2, Vec3(0.1, 0.4, 0.4)}});
  const Vec3 o = Vec3::Zero();
  const ForceId pair = world.add_force(SpringDamper(light, heavy, o, o, 900, 3, 0));
  const ForceId centred = world.add_force(SpringDamper(kGround, light, o, o, 400, 0, 0));
  const ForceId lever =
      world.add_force(SpringDamper(kGround, rod, Vec3(0.5, 0, 1), Vec3(0.5, 0, 0), 1000, 0.9, 0));
  const double omega[] = {std::sqrt(900 * (1 + 1.0 / 3)), std::sqrt(400),
                          std::sqrt(1000 * (0.5 + 0.25 / 0.4))};
  const std::vector<SpringFrequency> all = too_fast_springs(world, 0.11);
  ASSERT_EQ(all.size(), 3);
  const ForceId order[] = {pair, lever, centred};
  const double frequency[] = {omega[0], omega[2], omega[1]};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(all[i].spring, order[i]);
    EXPECT_NEAR(all[i].omega, frequency[i], 1e-12 * frequency[i]);
  }
  EXPECT_EQ(too_fast_springs(world, 2.001 / omega[0]).size(), 1);
  EXPECT_TRUE(too_fast_springs(world, 1.999 / omega[0]).empty());
}

/// Semi-implicit Euler gains energy where it is said to, and not a little below.
TEST(StartChecks, ASpringIsTooFastWhereAnExplicitSchemeGainsEnergy) {
  for (const double angle : {1.98, 2.02}) {
    World world;
    world.set_gravity(Vec3::Zero());
    const BodyId ball =
        world.add_body({.mass = MassProperties::sphere(0.1, 1), .pose = {.p = Vec3(1, 0, 0)}});
    world.add_force(SpringDamper(kGround, ball, Vec3::Zero(), Vec3::Zero(), 100, 0, 0));
    const double h = angle / 10;
    EXPECT_EQ(too_fast_springs(world, h).size(), angle > 2 ? 1 : 0);
    Settings settings;
    settings.integrator = Integrator::kForceEuler;
    Simulator simulator(world, settings);
    for (int i = 0; i < 200; ++i) ASSERT_TRUE(simulator.step(h).exact());
    if (angle > 2)
      EXPECT_GT(world.pose(ball).p.norm(), 100);
    else
      EXPECT_LT(world.pose(ball).p.norm(), 20);
  }
}

}  // namespace
}  // namespace taut::start_checks_test
