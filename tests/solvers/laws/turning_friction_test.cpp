#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "core/joints/joints.h"
#include "core/state/force.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/contact_bodies.h"
#include "tests/solvers/contact_energy.h"

/// Friction of turning proportional to the rate, τ = −c Λ_n ω, alone and beside that of Coulomb.
namespace taut::turning_friction_test {
namespace {

constexpr double kG = 9.81, kRadius = 0.1, kInertia = 0.4 * kRadius * kRadius;  // of a ball of 1 kg

using testing::add_ball, testing::rubbing;

Material turning(double rolling_linear, double spinning_linear, double rolling = 0, double spinning = 0) {
  Material material = rubbing(0.8);
  material.rolling_friction = rolling;
  material.spinning_friction = spinning;
  material.rolling_friction_linear = rolling_linear;
  material.spinning_friction_linear = spinning_linear;
  return material;
}

/// A ball on the plane z = 0 that rolls along x and spins about z.
World ball_on_plane(const Material& material, double rolling_rate, double spinning_rate) {
  World world;
  world.add_shape(kGround, HalfSpace{}, {}, material);
  add_ball(world, kRadius, Vec3(0, 0, kRadius),
           {Vec3(0, rolling_rate, spinning_rate), Vec3(kRadius * rolling_rate, 0, 0)}, material);
  return world;
}

const BodyId kBall{1};

Settings with(Integrator integrator) {
  Settings settings;
  settings.integrator = integrator;
  return settings;
}

void run(World& world, const Settings& settings, double time, int steps) {
  Simulator simulator(world, settings);
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulator.step(time / steps);
    ASSERT_TRUE(report.exact()) << "step " << i << ": " << report.message;
    ASSERT_LE(report.natural_residual, 1e-8) << "step " << i;
    ASSERT_LE(report.ledger.friction, 1e-13) << "step " << i;
    ASSERT_NEAR(report.ledger.total(), report.ledger.change(), 1e-13) << "step " << i;
    ASSERT_NEAR(report.ledger.integration, 0, 1e-11) << "step " << i;
  }
}

/// Errors fall by `ratio` at least each time steps are halved.
void expect_order(const std::function<double(int)>& error, int steps, double ratio) {
  double last = error(steps);
  EXPECT_GT(last, 1e-9);  // there is something to see
  for (int i = 0; i < 3; ++i) {
    const double next = error(steps *= 2);
    EXPECT_GE(last / next, ratio) << steps;
    last = next;
  }
}

/// How far a ball is from ω(t) = ω₀ exp(−b t), rolling and spinning at once, at 1 s.
double decay_error(Integrator integrator, int steps) {
  constexpr double kRoll = 0.003, kSpin = 0.0008, kRate = 5;
  World world = ball_on_plane(turning(kRoll, kSpin), kRate, kRate);
  run(world, with(integrator), 1, steps);
  const double roll = kRoll * kG / (kInertia + kRadius * kRadius), spin = kSpin * kG / kInertia;
  const double way = kRadius * kRate / roll * (1 - std::exp(-roll));
  const Vec3& w = world.twist(kBall).w;
  EXPECT_NEAR(w.x(), 0, 1e-12);
  return std::abs(w.y() - kRate * std::exp(-roll)) + std::abs(w.z() - kRate * std::exp(-spin)) +
         std::abs(world.pose(kBall).p.x() - way) / kRadius;
}

TEST(TurningFriction, a_ball_slows_down_by_its_closed_form_to_order_2) {
  expect_order([](int steps) { return decay_error(Integrator::kRattle, steps); }, 20, 3.9);
}

TEST(TurningFriction, a_ball_slows_down_by_its_closed_form_to_order_1_by_moreau_jean) {
  expect_order([](int steps) { return decay_error(Integrator::kMoreauJean, steps); }, 20, 1.9);
}

/// ω̇ = −a − b ω, then rest: ω = (ω₀ + a/b) exp(−b t) − a/b until t₁ = ln(1 + ω₀ b/a)/b.
double stop_error(int steps, double time) {
  constexpr double kArm = 0.001, kLinear = 0.0006, kRate = 6;
  World world = ball_on_plane(turning(kLinear, kLinear, kArm, kArm), kRate, kRate);
  run(world, {}, time, steps);
  const auto rate = [&](double inertia) {
    const double a = kArm * kG / inertia, b = kLinear * kG / inertia;
    return time < std::log1p(kRate * b / a) / b ? (kRate + a / b) * std::exp(-b * time) - a / b : 0;
  };
  const Vec3& w = world.twist(kBall).w;
  return std::abs(w.y() - rate(kInertia + kRadius * kRadius)) + std::abs(w.z() - rate(kInertia));
}

TEST(TurningFriction, both_laws_add_up_to_order_2_and_a_ball_rests_at_last) {
  expect_order([](int steps) { return stop_error(steps, 1); }, 50, 3.9);  // spins until 1.04 s
  EXPECT_LE(stop_error(150, 5), 1e-9);                                    // rolls until 3.63 s
}

/// Coulomb's friction of turning holds a ball that a torque turns, up to its bound, and beyond it the rest of
/// the torque is c Λ_n ω: the steady state.
TEST(TurningFriction, holds_below_coulombs_bound_and_lets_turn_at_the_rate_of_the_rest) {
  constexpr double kArm = 0.002, kLinear = 0.01;
  for (const double part : {0.9, 2.5}) {
    World world = ball_on_plane(turning(0, kLinear, 0, kArm), 0, 0);
    world.add_force(BodyTorque(kBall, Vec3(0, 0, part * kArm * kG)));
    run(world, {}, 3, 300);
    EXPECT_NEAR(world.twist(kBall).w.z(), std::max(0.0, part - 1) * kArm / kLinear, 1e-8) << part;
  }
}

/// Torque and normal force of each contact of a step obey the law with the mean of the rates before and
/// after it.
TEST(TurningFriction, reports_have_the_torque_of_the_law) {
  constexpr double kRoll = 0.003, kSpin = 0.0008;
  World world = ball_on_plane(turning(kRoll, kSpin), 5, 7);
  Simulator simulator(world);
  for (int i = 0; i < 20; ++i) {
    const Vec3 before = world.twist(kBall).w;
    ASSERT_TRUE(simulator.step(0.01).exact());
    const Vec3 mean = 0.5 * (before + world.twist(kBall).w);
    ASSERT_EQ(simulator.contacts().size(), 1U);
    const ContactReport contact = simulator.contacts().front();
    const Vec3 torque = (contact.contact.B == kBall ? 1 : -1) * contact.torque;
    const Vec3 law(-kRoll * mean.x(), -kRoll * mean.y(), -kSpin * mean.z());
    EXPECT_LE((torque - contact.normal_force * law).norm(), 1e-10) << i;
  }
}

/// However large c is, rates only fall, and turn round nowhere.
TEST(TurningFriction, of_any_size_turns_no_rate_round) {
  for (const Integrator integrator : {Integrator::kRattle, Integrator::kMoreauJean})
    for (const double c : {0.01, 0.1, 1.0, 1e3, 1e6}) {
      World world = ball_on_plane(turning(c, c), 5, 7);
      Simulator simulator(world, with(integrator));
      Vec3 last = world.twist(kBall).w;
      for (int i = 0; i < 50; ++i) {
        ASSERT_TRUE(simulator.step(0.02).exact()) << c << ' ' << i;
        const Vec3 w = world.twist(kBall).w;
        for (int axis : {1, 2}) {
          EXPECT_GE(w[axis], -1e-8) << c << ' ' << i;
          EXPECT_LE(w[axis], last[axis] + 1e-8) << c << ' ' << i;
        }
        last = w;
      }
      if (c >= 1) {
        EXPECT_LE(last.norm(), 1e-6) << c;
      }
    }
}

/// What one body gets the other loses: I ω̇ = ∓c N (ω_a − ω_b) of two balls that are pressed together.
TEST(TurningFriction, acts_on_both_bodies) {
  constexpr double kLinear = 0.002, kForce = 5, kTime = 0.5;
  const Material material = turning(kLinear, kLinear);
  World world;
  world.set_gravity(Vec3::Zero());
  const BodyId a = add_ball(world, kRadius, Vec3(0, 0, 0), {Vec3(0, 0, 9), Vec3::Zero()}, material);
  const BodyId b =
      add_ball(world, kRadius, Vec3(0, 0, 2 * kRadius), {Vec3(0, 0, -3), Vec3::Zero()}, material);
  world.add_force(PointForce(a, Vec3::Zero(), Vec3(0, 0, kForce)));
  world.add_force(PointForce(b, Vec3::Zero(), Vec3(0, 0, -kForce)));
  run(world, {}, kTime, 100);
  EXPECT_NEAR(world.twist(a).w.z() + world.twist(b).w.z(), 6, 1e-12);
  EXPECT_NEAR(world.twist(a).w.z() - world.twist(b).w.z(),
              12 * std::exp(-2 * kLinear * kForce / kInertia * kTime), 1e-3);
}

/// Impacts turn as little as they may: c times the impulse takes a part of the spin, none more than all.
TEST(TurningFriction, of_an_impact_takes_a_part_of_the_spin) {
  for (const double restitution : {0.0, 0.8})
    for (const double c : {1e-4, 1e-2, 10.0}) {
      Material material = turning(0, c);
      material.restitution = restitution;
      World world;
      world.add_shape(kGround, HalfSpace{}, {}, material);
      add_ball(world, kRadius, Vec3(0, 0, kRadius + 0.2), {Vec3(0, 0, 10), Vec3::Zero()}, material);
      Simulator simulator(world);
      const double speed = std::sqrt(2 * kG * 0.2), fall = speed / kG;
      while (world.time() < fall + 0.02) ASSERT_TRUE(simulator.step(1e-3).ok());
      const double impulse = c * (1 + restitution) * speed / kInertia;
      EXPECT_GE(world.twist(kBall).w.z(), -1e-12) << c << ' ' << restitution;
      EXPECT_LE(world.twist(kBall).w.z(), 10 / (1 + 0.9 * impulse)) << c << ' ' << restitution;
    }
}

/// Sweeps come to what the direct solver finds.
TEST(TurningFriction, is_met_by_sweeps) {
  World direct = ball_on_plane(turning(0.003, 0.002, 0.0005, 0.0003), 5, 7);
  World world = direct;
  run(direct, {}, 1, 100);
  for (const Solver solver : {Solver::kGaussSeidel, Solver::kPairwise, Solver::kPropagation}) {
    World swept = world;
    Settings settings;
    settings.solver = solver;
    settings.iterations = 200;
    Simulator simulator(swept, settings);
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(0.01).ok());
    EXPECT_LE((swept.twist(kBall).w - direct.twist(kBall).w).norm(), 1e-6) << int(solver);
  }
}

/// A compliant contact has the same law.
TEST(TurningFriction, of_compliant_contacts) {
  constexpr double kSpin = 0.0008;
  Material material = turning(0, kSpin);
  material.compliance = 1e-5;
  World world = ball_on_plane(material, 0, 5);
  world.set_pose(kBall, {Quat::Identity(), Vec3(0, 0, kRadius - 1e-5 * kG)});
  Simulator simulator(world);
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(simulator.step(1e-3).ok()) << i;
  EXPECT_NEAR(world.twist(kBall).w.z(), 5 * std::exp(-kSpin * kG / kInertia), 1e-4);
}

/// Bodies of all shapes, thrown with any friction, restitution and compliance: contacts never give energy.
class ThrownBodies : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(TurningFriction, ThrownBodies, ::testing::Range(0, 12));

TEST_P(ThrownBodies, lose_energy_by_friction_of_turning) {
  std::mt19937 random(GetParam());
  std::uniform_real_distribution<double> unit(0, 1);
  const auto chance = [&](double part) { return unit(random) < part; };
  const auto decades = [&](double low, double high) {
    return std::pow(10, low + (high - low) * unit(random));
  };
  World world;
  Material material = rubbing(unit(random), chance(0.5) ? unit(random) : 0);
  material.rolling_friction_linear = decades(-5, 0);
  material.spinning_friction_linear = decades(-5, 0);
  if (chance(0.5)) material.rolling_friction = decades(-4, -2);
  if (chance(0.5)) material.spinning_friction = decades(-4, -2);
  world.add_shape(kGround, HalfSpace{}, {}, material);
  for (int i = 0; i < 6; ++i) {
    const Pose pose{contact_worlds::random_turn(random),
                    Vec3(0.4 * (i % 2), 0.4 * (i / 2 % 2), 0.3 + 0.3 * i)};
    const Twist twist{contact_worlds::random_vector(random, 10), contact_worlds::random_vector(random, 1)};
    const Vec3 size = Vec3(0.1, 0.1, 0.1) + 0.1 * Vec3(unit(random), unit(random), unit(random));
    switch (i % 3) {
      case 0:
        testing::add_box(world, size, pose, twist, material);
        break;
      case 1:
        add_ball(world, 0.5 * size.x(), pose.p, twist, material);
        break;
      default:
        testing::add_solid(world, Ellipsoid{0.5 * size}, MassProperties::ellipsoid(0.5 * size, 1), pose,
                           twist, material);
    }
  }
  Simulator simulator(world);
  testing::expect_contacts_give_nothing(simulator, 0.004, 400, 1e-6);
}

/// A run that goes on from a checkpoint is the one that was not interrupted, to the last bit.
TEST(TurningFriction, goes_on_from_a_checkpoint) {
  const auto thrown = [] {
    World world = ball_on_plane(turning(0.003, 0.002, 0.0005, 0.0003), 5, 7);
    testing::add_box(world, Vec3(0.1, 0.2, 0.3), {.p = Vec3(0.4, 0, 0.4)}, {Vec3(3, 2, 1), Vec3::Zero()},
                     turning(0.01, 0.02));
    return world;
  };
  World world = thrown(), other = thrown();
  Simulator simulator(world), again(other);
  for (int i = 0; i < 60; ++i) ASSERT_TRUE(simulator.step(0.005).ok());
  again.restore(Checkpoint::from_bytes(simulator.checkpoint().bytes()));
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(simulator.step(0.005).ok() && again.step(0.005).ok());
    for (const BodyId body : {BodyId{1}, BodyId{2}}) {
      ASSERT_EQ(world.pose(body).p, other.pose(body).p) << i;
      ASSERT_EQ(world.twist(body).w, other.twist(body).w) << i;
    }
  }
}

/// Two half balls welded to one another roll as one ball does, and fall asleep.
TEST(TurningFriction, of_merged_bodies_that_fall_asleep) {
  const Material material = turning(0.01, 0.01, 0.0005, 0.0005);
  const auto rolling = [&](bool merge) {
    World world;
    world.add_shape(kGround, HalfSpace{}, {}, material);
    const Twist twist{Vec3(0, 2, 1), Vec3(2 * kRadius, 0, 0)};
    const BodyId ball = add_ball(world, kRadius, Vec3(0, 0, kRadius), twist, material);
    const BodyId core = world.add_body(
        {.name = "core", .mass = MassProperties::sphere(0.05, 1), .pose = world.pose(ball), .twist = twist});
    world.add("weld", Fixed::at(world, ball, core, world.pose(ball).p));
    Settings settings;
    settings.merge_fixed_joints = merge;
    settings.sleep = true;
    Simulator simulator(world, settings);
    for (int i = 0; i < 50; ++i) EXPECT_TRUE(simulator.step(0.01).ok());
    const double way = world.pose(ball).p.x();
    for (int i = 0; i < 500; ++i) EXPECT_TRUE(simulator.step(0.01).ok());
    EXPECT_TRUE(world.is_asleep(ball));
    return way;
  };
  EXPECT_NEAR(rolling(true), rolling(false), 1e-6);  // some steps are divided: of order 2
}

}  // namespace
}  // namespace taut::turning_friction_test
