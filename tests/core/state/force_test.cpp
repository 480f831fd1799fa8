#include "core/state/force.h"

#include <gtest/gtest.h>

#include "core/world/world.h"
#include "tests/core/expect_invalid.h"
#include "tests/core/random_state.h"

namespace taut::force_test {
namespace {

using testing::expect_invalid;
using testing::moved;
using testing::Random;

std::vector<Wrench> wrenches_of(const World& world, const State& state) {
  std::vector<Wrench> wrenches(world.body_count());
  world.forces(state, wrenches);
  return wrenches;
}

/// A world without gravity, with one force law on its two bodies in random states.
struct OneLaw {
  World world;
  BodyId a, b;
  explicit OneLaw(Random& random) {
    world.set_gravity(Vec3::Zero());
    a = world.add_body({.pose = random.pose(), .twist = random.twist()});
    b = world.add_body({.pose = random.pose(), .twist = random.twist()});
  }
};

/// Wrench = −∂V/∂q for every body, by central differences of the world's potential energy.  ε = 6e-6 leaves
/// errors near 1e-10 of quantities of order one to ten; the tolerance is fifty times that.
void expect_wrenches_from_potential(const World& world) {
  const State& state = world.state();
  const std::vector<Wrench> wrenches = wrenches_of(world, state);
  constexpr double h = 6e-6, tolerance = 5e-9;
  for (int body = 1; body < world.body_count(); ++body) {
    const auto potential = [&](const Vec3& turn, const Vec3& shift) {
      State other = state;
      other.poses[body] = moved(state.poses[body], turn, shift);
      return world.potential_energy(other);
    };
    for (int k = 0; k < 3; ++k) {
      const Vec3 e = h * Vec3::Unit(k), zero = Vec3::Zero();
      const double torque = (potential(-e, zero) - potential(e, zero)) / (2 * h);
      const double force = (potential(zero, -e) - potential(zero, e)) / (2 * h);
      EXPECT_NEAR(wrenches[body].torque[k], torque, tolerance * std::max(1.0, std::abs(torque)));
      EXPECT_NEAR(wrenches[body].force[k], force, tolerance * std::max(1.0, std::abs(force)));
    }
  }
}

TEST(Forces, GravityPullsMovingBodies) {
  World world;
  const BodyId arm = world.add_body({.mass = {2, Vec3(1, 2, 2.5)}});
  const BodyId wall = world.add_body({.pose = {Quat::Identity(), Vec3(-1, 0, 0)}, .fixed = true});
  const auto wrenches = wrenches_of(world, world.state());
  EXPECT_EQ(wrenches[arm.index].force, Vec3(2 * Vec3(0, 0, -9.81)));
  EXPECT_EQ(wrenches[arm.index].torque, Vec3::Zero());
  EXPECT_EQ(wrenches[wall.index].force, Vec3::Zero());
  EXPECT_EQ(wrenches[kGround.index].force, Vec3::Zero());
}

TEST(Forces, ConservativeLawsPullDownTheirPotential) {
  Random random(32);
  for (int i = 0; i < 20; ++i) {
    OneLaw s(random);
    s.world.set_gravity(random.vector(10));
    s.world.add_force(PointForce(s.a, random.vector(), random.vector(5)));
    s.world.add_force(SpringDamper(s.a, s.b, random.vector(), random.vector(), 3, 0.5, 0));
    s.world.add_force(SpringDamper(s.b, kGround, random.vector(), random.vector(), 2, 0, 0));
    s.world.add_force(ForceCallback(
        [b = s.b.index](const State& x, std::span<Wrench> w) { w[b].force -= 4 * x.poses[b].p; }, false,
        [b = s.b.index](const State& x) { return 2 * x.poses[b].p.squaredNorm(); }));
    EXPECT_FALSE(s.world.forces_depend_on_velocity());
    expect_wrenches_from_potential(s.world);
  }
}

TEST(Forces, FollowerLawsTurnWithTheBody) {
  World world;
  world.set_gravity(Vec3::Zero());
  const Quat quarter = exp_so3(Vec3(0, 0, std::acos(0.0)));  // x to y
  const BodyId body = world.add_body({.pose = {quarter, Vec3::Zero()}});
  world.add_force(PointForce(body, Vec3(1, 0, 0), Vec3(0, 3, 0), true));
  world.add_force(BodyTorque(body, Vec3(5, 0, 0), true));
  world.add_force(BodyTorque(body, Vec3(7, 0, 0), false));
  const Wrench wrench = wrenches_of(world, world.state())[body.index];
  EXPECT_LT((wrench.force - Vec3(-3, 0, 0)).norm(), 1e-15 * 10);
  EXPECT_LT((wrench.torque - Vec3(7, 5, 3)).norm(), 1e-15 * 10);  // lever, body torque, world torque
  EXPECT_EQ(world.potential_energy(world.state()), 0);
}

TEST(Forces, SpringDamperObeysTheThirdLawAndDissipates) {
  Random random(33);
  for (int i = 0; i < 20; ++i) {
    OneLaw s(random);
    const Vec3 p = random.vector(), q = random.vector();
    s.world.add_force(SpringDamper(s.a, s.b, p, q, 0, 1, 2.5));
    EXPECT_TRUE(s.world.forces_depend_on_velocity());
    const auto w = wrenches_of(s.world, s.world.state());
    const Wrench &on_a = w[s.a.index], &on_b = w[s.b.index];
    const Pose &A = s.world.pose(s.a), &B = s.world.pose(s.b);
    EXPECT_LT((on_a.force + on_b.force).norm(), 1e-13);
    EXPECT_LT((on_a.torque + A.p.cross(on_a.force) + on_b.torque + B.p.cross(on_b.force)).norm(), 1e-13);
    // Its power is −c (dL/dt)².
    const Twist &V_A = s.world.twist(s.a), &V_B = s.world.twist(s.b);
    const Vec3 n = (B.point(q) - A.point(p)).normalized();
    const double rate = n.dot(V_B.at(B.q * q) - V_A.at(A.q * p));
    const double power =
        on_a.torque.dot(V_A.w) + on_a.force.dot(V_A.v) + on_b.torque.dot(V_B.w) + on_b.force.dot(V_B.v);
    EXPECT_NEAR(power, -2.5 * rate * rate, 1e-13 * std::max(1.0, std::abs(power)));
  }
}

TEST(Forces, ASpringByTablesPullsAsTheySay) {
  World world;
  const BodyId body = world.add_body({.pose = {.p = {3, 0, 0}}, .twist = {Vec3::Zero(), Vec3(0.5, 2, 0)}});
  world.set_gravity(Vec3::Zero());
  AxisSpring law{.rest = 1};
  law.table = Curve({{0, 0}, {1, 5}, {3, 25}});
  law.damping_table = Curve({{0, 0}, {1, 8}});
  world.add_force(SpringDamper(kGround, body, Vec3::Zero(), Vec3::Zero(), law));
  EXPECT_TRUE(world.forces_depend_on_velocity());
  EXPECT_TRUE(wrenches_of(world, world.state())[body.index].force.isApprox(Vec3(-15 - 4, 0, 0), 1e-15));
  EXPECT_EQ(world.potential_energy(world.state()), 2.5 + 10);
  EXPECT_EQ(world.spring_energy(world.state()), 2.5 + 10);
  // Without springs nothing is left.
  std::vector<Wrench> wrenches(world.body_count());
  world.forces(world.state(), wrenches, Springs::kLeftOut);
  EXPECT_EQ(wrenches[body.index].force, Vec3::Zero());
  EXPECT_FALSE(world.forces_depend_on_velocity(Springs::kLeftOut));
  EXPECT_FALSE(world.has_dissipative_forces(Springs::kLeftOut));
  law.stiffness = 2;
  expect_invalid([&] { SpringDamper(kGround, body, Vec3::Zero(), Vec3::Zero(), law); },
                 {"spring stiffness of spring-damper", "beside a table", "2"});
}

TEST(Forces, ASpringSaysItsLineAndTension) {
  Random random(34);
  for (int i = 0; i < 20; ++i) {
    OneLaw s(random);
    const SpringDamper law(s.a, s.b, random.vector(), random.vector(), 3, 0.5, 2.5);
    const auto line = law.line_force(s.world.state());
    ASSERT_TRUE(line);
    EXPECT_TRUE(line->elastic);
    std::vector<Wrench> wrenches(s.world.body_count());
    law.accumulate(s.world.state(), wrenches);
    const Vec3 p = s.world.pose(line->a).point(line->p_AP), q = s.world.pose(line->b).point(line->p_BQ);
    const Vec3 pull = line->tension * (q - p).normalized();
    EXPECT_LT((wrenches[s.a.index].force - pull).norm(), 1e-13 * (1 + pull.norm()));
  }
  const OneLaw s(random);
  EXPECT_FALSE(PointForce(s.a, Vec3::Zero(), Vec3::UnitX()).line_force(s.world.state()));
}

TEST(Forces, SpringOfNoLengthPullsNowhere) {
  World world;
  world.set_gravity(Vec3::Zero());
  const BodyId body = world.add_body({});
  world.add_force(SpringDamper(kGround, body, Vec3::Zero(), Vec3::Zero(), 1, 1, 1));
  EXPECT_EQ(wrenches_of(world, world.state())[body.index].force, Vec3::Zero());
}

TEST(Forces, CanBeReplaced) {
  World world;
  world.set_gravity(Vec3::Zero());
  const BodyId left = world.add_body({}), right = world.add_body({.pose = {Quat::Identity(), Vec3::UnitX()}});
  const ForceId pull = world.add_force(PointForce(right, Vec3::Zero(), Vec3::UnitZ()));
  EXPECT_FALSE(world.forces_depend_on_velocity());
  world.set_force(pull, std::make_shared<SpringDamper>(left, right, Vec3::Zero(), Vec3::Zero(), 2, 0, 1));
  EXPECT_TRUE(world.forces_depend_on_velocity());
  EXPECT_EQ(world.force_count(), 1);
  EXPECT_TRUE(world.force(pull).line_force(world.state()));
  EXPECT_EQ(wrenches_of(world, world.state())[right.index].force, Vec3(-2, 0, 0));
}

}  // namespace
}  // namespace taut::force_test
