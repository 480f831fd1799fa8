#include "solvers/integrators/reduced/closed_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/joints/joints.h"
#include "core/state/motion.h"
#include "core/world/diagnostics.h"
#include "scenes/builders/scene.h"
#include "solvers/common/setting_checks.h"
#include "solvers/integrators/reduced/beyond_rows.h"
#include "solvers/simulator/simulator.h"
#include "tests/core/random_state.h"
#include "tests/solvers/integrators/reduced/reduced_runs.h"

namespace taut::closed_tree_test {
namespace {

using namespace testing;

Settings settings_of(Integrator integrator) {
  Settings settings = fine_settings(integrator);
  settings.position_tolerance = 1e-11;
  settings.contacts = false;
  return settings;
}

BodyId add_rod(World& world, const char* name, const Vec3& from, const Vec3& to, double mass = 1) {
  const Vec3 along = to - from;
  const double length = along.norm(), across = mass * length * length / 12;
  return world.add_body({.name = name,
                         .mass = MassProperties(mass, Vec3(0.01 * mass, across, 1.05 * across)),
                         .pose = {Quat::FromTwoVectors(Vec3::UnitX(), along / length), (from + to) / 2}});
}

/// Crank, coupler and rocker in the xz plane on hinges about y: of the 20 rows 11 say something.
World four_bar() {
  World world;
  const Vec3 foot(0, 0, 0), elbow(0.1, 0, 0.4), knee(1.2, 0, 0.8), heel(1, 0, 0), y = Vec3::UnitY();
  const BodyId crank = add_rod(world, "crank", foot, elbow);
  const BodyId coupler = add_rod(world, "coupler", elbow, knee, 0.8);
  const BodyId rocker = add_rod(world, "rocker", heel, knee, 1.3);
  world.add("foot", Hinge::at(world, kGround, crank, foot, y));
  world.add("elbow", Hinge::at(world, crank, coupler, elbow, y));
  world.add("knee", Hinge::at(world, coupler, rocker, knee, y));
  world.add("heel", Hinge::at(world, kGround, rocker, heel, y));
  world.set_twist(crank, {2 * y, 2 * y.cross(world.pose(crank).p)});
  return world;
}

/// Bricard's linkage of six links, along edges of a cube, one of them the ground: by Grübler's count it could
/// not move.
World bricard() {
  World world;
  const Vec3 corner[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}, {0, 0, 1}};
  const auto at = [&](int k) { return corner[k % 6]; };
  const auto axis = [&](int k) -> Vec3 { return (at(k) - at(k + 5)).cross(at(k + 1) - at(k)); };
  BodyId last = kGround;
  for (int k = 1; k < 6; ++k) {
    const BodyId next = add_rod(world, ("link" + std::to_string(k)).c_str(), at(k), at(k + 1));
    world.add("corner" + std::to_string(k), Hinge::at(world, last, next, at(k), axis(k)));
    last = next;
  }
  world.add("corner0", Hinge::at(world, last, kGround, at(0), axis(0)));
  return world;
}

/// Four rods on ball joints between two points of the ground, with a fifth across: rows that do not depend on
/// each other.
World net() {
  World world;
  const Vec3 at[] = {{0, 0, 0}, {0.4, 0.3, -0.5}, {1, -0.2, -0.7}, {1.6, 0.1, -0.4}, {2, 0, 0}};
  BodyId rods[4];
  for (int k = 0; k < 4; ++k)
    rods[k] = add_rod(world, ("rod" + std::to_string(k)).c_str(), at[k], at[k + 1], 1 + 0.2 * k);
  world.add("left", Ball::at(world, kGround, rods[0], at[0]));
  for (int k = 1; k < 4; ++k) world.add("", Ball::at(world, rods[k - 1], rods[k], at[k]));
  world.add("right", Ball::at(world, kGround, rods[3], at[4]));
  world.add("across", Distance::between(world, rods[0], rods[3], at[1], at[3]));
  return world;
}

/// RATTLE of order 8 is another formulation, with the multipliers of all rows.
TEST(ClosedTree, LoopsHaveTheirOrders) {
  struct Case {
    const char* name;
    World start;
    double time;
    int steps, midpoint_steps;
  };
  for (const Case& c : {Case{"net", net(), 1, 50, 100},
                        {"four-bar", four_bar(), 0.4, 40, 100},
                        {"bricard", bricard(), 1, 25, 100}}) {
    SCOPED_TRACE(c.name);
    World truth = c.start;
    run(truth, settings_of(Integrator::kRattle8), c.time, 500);
    EXPECT_GT(distance(c.start, truth), 0.3);
    const auto order = [&](Integrator integrator, int steps) {
      return order_towards(truth, c.start, settings_of(integrator), c.time, steps);
    };
    EXPECT_NEAR(order(Integrator::kRecursive, c.steps), 4, 0.3);
    EXPECT_NEAR(order(Integrator::kLagrangian, c.steps), 4, 0.3);
    EXPECT_NEAR(order(Integrator::kRecursiveMidpoint, c.midpoint_steps), 2, 0.1);
    EXPECT_NEAR(order(Integrator::kLagrangianMidpoint, c.midpoint_steps), 2, 0.1);
  }
}

TEST(ClosedTree, LoopsStayClosedAndKeepTheirEnergy) {
  for (World world : {net(), four_bar(), bricard()}) {
    Simulator simulator(world, settings_of(Integrator::kRecursive));
    double start = 0;
    for (int i = 0; i < 1000; ++i) {
      ASSERT_TRUE(simulator.step(0.002).exact()) << simulator.report().message;
      if (i == 0) start = total_energy(world, world.state());
      EXPECT_LE(std::max(simulator.report().gap.metres, simulator.report().gap.radians), 1e-11);
      EXPECT_LE(simulator.report().velocity_residual, 1e-11);
    }
    EXPECT_NEAR(total_energy(world, world.state()), start, 1e-6);
  }
}

/// A parallelogram whose rods are alike stays one: the coupler does not turn, and the cranks turn as a
/// pendulum of two cranks that carry the coupler at their ends.
TEST(ClosedTree, AParallelogramIsAPendulum) {
  for (const Integrator integrator : kReduced) {
    World world;
    const Vec3 y = Vec3::UnitY(), z = Vec3::UnitZ();
    const double m = 0.9, M = 1.7, inertia = 2 * (m / 12 * 1.0 + m / 4);  // of both cranks about their feet
    const BodyId a = add_rod(world, "a", Vec3::Zero(), z, m),
                 b = add_rod(world, "b", Vec3::UnitX(), Vec3::UnitX() + z, m);
    const BodyId coupler = add_rod(world, "coupler", z, Vec3::UnitX() + z, M);
    world.add("", Hinge::at(world, kGround, a, Vec3::Zero(), y));
    world.add("", Hinge::at(world, kGround, b, Vec3::UnitX(), y));
    world.add("", Hinge::at(world, a, coupler, z, y));
    world.add("", Hinge::at(world, coupler, b, Vec3::UnitX() + z, y));
    for (const BodyId body : {a, b}) world.set_twist(body, {y, 0.5 * Vec3::UnitX()});
    world.set_twist(coupler, {Vec3::Zero(), Vec3::UnitX()});
    run(world, settings_of(integrator), 0.5, 500);
    const double angle = log_so3(world.pose(a).q * Quat::FromTwoVectors(Vec3::UnitX(), z).conjugate()).y();
    const double rate = world.twist(a).w.y();
    const double height = std::cos(angle), fallen = (m * 1 + M * 1) * 9.81 * (1 - height);
    const double midpoint = is_midpoint(integrator) ? 1e-4 : 1e-9;
    // Energy in closed form, and both cranks alike.
    EXPECT_NEAR(0.5 * (world.twist(a).w.squaredNorm() * inertia + M * rate * rate),
                0.5 * (inertia + M) + fallen, midpoint * 20);
    EXPECT_GT(rate, 1.5);
    EXPECT_NEAR(world.twist(b).w.y(), rate, 1e-10);
    EXPECT_NEAR(world.twist(coupler).w.norm(), 0, 1e-10);
  }
}

/// Wheels with moments I₁ and I₂ on the ground: α₁ = τ/(I₁ + r² I₂); the gear is cut.
TEST(ClosedTree, GearsAndDifferentialsAsInClosedForm) {
  for (const Integrator integrator : kReduced) {
    World world;
    world.set_gravity(Vec3::Zero());
    BodyId wheels[3];
    AxisId angles[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3 at(2.0 * k, 0, 0);
      wheels[k] = world.add_body({.mass = MassProperties(1, Vec3(2.0, 0.5 + k, 2.2)), .pose = {.p = at}});
      const JointId hinge =
          world.add("hinge" + std::to_string(k), Hinge::at(world, kGround, wheels[k], at, Vec3::UnitY()));
      angles[k] = world.axis(hinge, "angle");
    }
    World differential = world;
    world.add("gear", Gear(world, angles[0], angles[1], -2));
    world.add_force(BodyTorque(wheels[0], Vec3(0, 3, 0)));
    run(world, settings_of(integrator), 0.5, 50);
    const double alpha = 3 / (0.5 + 4 * 1.5);
    EXPECT_NEAR(world.axis_rate(angles[0]), 0.5 * alpha, 1e-12);
    EXPECT_NEAR(world.axis_value(angles[1]), -2 * 0.125 * alpha, 1e-12);
    // The case 0 gets τ, its shafts 1 and 2 τ/2 each: α_k = τ/2I_k less the inertia of the case.
    differential.add("differential", Differential(differential, angles[0], angles[1], angles[2]));
    differential.add_force(BodyTorque(wheels[0], Vec3(0, 3, 0)));
    run(differential, settings_of(integrator), 0.5, 50);
    const double I0 = 0.5, I1 = 1.5, I2 = 2.5, c = (1 / I1 + 1 / I2) / 2;
    const double torque = 3 / (2 + I0 * c);  // λ on either shaft: I₀ α₀ = τ − 2λ, 2 α₀ = λ (1/I₁ + 1/I₂)
    EXPECT_NEAR(differential.axis_rate(angles[1]), 0.5 * torque / I1, 1e-12);
    EXPECT_NEAR(differential.axis_rate(angles[2]), 0.5 * torque / I2, 1e-12);
  }
}

/// Present and mean forces of joints, cut ones too, against those of RATTLE, whose error is h² of them; where
/// rows depend on each other those of least norm among cut rows are others, so not there.
TEST(ClosedTree, ReactionsAsThoseOfRattle) {
  const auto reactions_of = [](Integrator integrator) {
    World world = net();
    Simulator simulator(world, settings_of(integrator));
    for (int i = 0; i < 500; ++i) EXPECT_TRUE(simulator.step(2e-4).exact());
    std::vector<Reaction> reactions;
    for (const char* name : {"left", "right", "across"}) {
      reactions.push_back(simulator.reaction(world.joint(name)));
      reactions.push_back(simulator.mean_reaction(world.joint(name)));
    }
    return reactions;
  };
  const std::vector<Reaction> truth = reactions_of(Integrator::kRattle);
  for (const Integrator integrator : kReduced) {
    const std::vector<Reaction> found = reactions_of(integrator);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_LE((found[i].force - truth[i].force).norm(), 1e-4) << i;
      EXPECT_GT(truth[i].force.norm(), 1) << i;
    }
  }
}

/// Boxes, limits and equalities with A = B Bᵀ of full and of lower rank: each row is on its law.
TEST(BeyondRows, MeetTheirLaws) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    testing::Random random(seed);
    const int count = 1 + static_cast<int>(seed % 12), rank = seed % 3 == 0 ? (count + 1) / 2 : count;
    dense::Matrix B(count, rank);
    for (int i = 0; i < count; ++i)
      for (int j = 0; j < rank; ++j) B(i, j) = random.uniform(-1, 1);
    BeyondRows rows{.A = B * B.transpose(), .b = dense::Vector(count), .alone = dense::Vector(count)};
    std::vector<RowLaw> laws;
    for (int i = 0; i < count; ++i) {
      rows.b[i] = random.uniform(-1, 1);
      rows.alone[i] = random.uniform(0.5, 2) * std::max(1e-3, rows.A(i, i));
      // Of dependent rows none that no impulse could satisfy.
      laws.push_back(i == 0 && rank == count       ? RowLaw::equality(0.3)
                     : i % 3 == 1 && rank == count ? RowLaw::lower_limit(random.uniform(-0.2, 0.2))
                                                   : RowLaw::box(-random.uniform(0.1, 1), 0.5));
    }
    std::vector<int> segments(count, 1);
    dense::Vector lambda, w;
    ASSERT_TRUE(solve_laws(rows, laws, segments, lambda, w)) << seed;
    EXPECT_LE((rows.A * lambda + rows.b - w).norm(), 1e-9 * (1 + lambda.norm())) << seed;
    for (int i = 0; i < count; ++i)
      EXPECT_NEAR(laws[i].project(rows.alone[i], lambda[i], w[i]), lambda[i], 1e-6 * (1 + lambda.norm()))
          << seed << ", row " << i;
  }
}

/// Of three rows that say the same λ is divided, in the scale of free bodies, and a deficit that is known is
/// left out even where rows seem to say more.
TEST(BeyondRows, DependentRowsShare) {
  BeyondRows rows{.A = dense::Matrix::Constant(3, 3, 2),
                  .b = dense::Vector::Constant(3, 6),
                  .alone = dense::Vector::Constant(3, 2)};
  RankDeficit deficit;
  EXPECT_LE((solve_closed(rows, deficit) + dense::Vector::Ones(3)).norm(), 1e-12);
  EXPECT_EQ(deficit.rows, 2);
  rows.A(0, 0) += 1e-9;
  rows.b[0] += 1;
  EXPECT_GT(solve_equalities(rows).norm(), 1e3);
  EXPECT_LE(solve_equalities(rows, deficit).norm(), 3);
}

/// A crank that follows the time closes a loop: its work is what energy changes by.
TEST(ClosedTree, DriversInLoopsDoTheirWork) {
  World world = four_bar();
  world.add("driver", Driver(world, world.axis(world.joint("heel"), "angle"), harmonic_motion(0, 0.2, 5)));
  World truth = world;
  run(truth, settings_of(Integrator::kRattle8), 1, 500);
  Simulator simulator(world, settings_of(Integrator::kRecursive));
  ASSERT_TRUE(simulator.step(0.001).exact()) << simulator.report().message;
  double drivers = 0;
  const double start = total_energy(world, world.state());
  for (int i = 1; i < 1000; ++i) {
    ASSERT_TRUE(simulator.step(0.001).exact());
    drivers += simulator.report().ledger.drivers;
  }
  EXPECT_LE(distance(world, truth), 1e-8);
  EXPECT_GT(std::abs(drivers), 0.1);
  EXPECT_NEAR(total_energy(world, world.state()) - start, drivers, 1e-8);
}

}  // namespace
}  // namespace taut::closed_tree_test
