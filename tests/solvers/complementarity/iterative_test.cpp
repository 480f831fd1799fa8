#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"

/// The iterative alternatives against the direct solver, closed forms and laws.
namespace taut::iterative_test {
namespace {

constexpr double kG = 9.81;
constexpr Solver kIterative[] = {Solver::kGaussSeidel, Solver::kPairwise, Solver::kPropagation};

Settings with(Solver solver, int iterations, double relaxation = 1) {
  Settings settings;
  settings.solver = solver;
  settings.iterations = iterations;
  settings.relaxation = relaxation;
  return settings;
}

class Iterative : public ::testing::TestWithParam<Solver> {};
INSTANTIATE_TEST_SUITE_P(Solvers, Iterative, ::testing::ValuesIn(kIterative), [](const auto& solver) {
  return std::string(solver.param == Solver::kGaussSeidel ? "gauss_seidel"
                     : solver.param == Solver::kPairwise  ? "pairwise"
                                                          : "propagation");
});

double distance(const World& a, const World& b) {
  double largest = 0;
  for (int i = 0; i < a.body_count(); ++i)
    largest = std::max(largest, (a.pose({i}).p - b.pose({i}).p).norm());
  return largest;
}

TEST_P(Iterative, TendsToTheDirectSolution) {
  for (const char* name : {"pendulum-hinge", "chain", "bridge-hinge"}) {
    Scene direct = build_scene(name, {{"n", 4}}), iterative = build_scene(name, {{"n", 4}});
    Simulator exact(direct.world, Settings{});
    Simulator simulator(iterative.world, with(GetParam(), 4000));
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(exact.step(1e-3).exact());
      const StepReport& report = simulator.step(1e-3);
      ASSERT_TRUE(report.exact()) << report.message;
      ASSERT_EQ(report.counts.factorizations, 0);
      ASSERT_LE(std::max(report.gap.metres, report.gap.radians), 1e-9) << name;
    }
    EXPECT_LE(distance(direct.world, iterative.world), 1e-7) << name;
  }
}

/// A net of few sweeps stretches, and the report says by how much.
TEST_P(Iterative, SaysHowOpenTheJointsAre) {
  double last = 1e300;
  for (int iterations : {5, 50, 500}) {
    Scene scene = build_scene("net-flag", {{"n", 5}});
    Simulator simulator(scene.world, with(GetParam(), iterations));
    double largest = 0;
    for (int i = 0; i < 30; ++i) {
      const StepReport& report = simulator.step(1e-3);
      ASSERT_TRUE(report.exact()) << report.message;
      largest = std::max(largest, report.gap.metres);
    }
    const Rows rows(scene.world);
    std::vector<double> phi(rows.row_count());
    rows.residual(scene.world.state(), phi);
    EXPECT_EQ(max_gap(rows, phi).metres, simulator.report().gap.metres);
    EXPECT_LT(largest, last);
    last = largest;
  }
  EXPECT_LE(last, 1e-5);
}

/// Newton's third law holds for each impulse, however few there are.
TEST(IterativeMomenta, AreKept) {
  for (Solver solver : kIterative) {
    World world;
    world.set_gravity(Vec3::Zero());
    std::vector<BodyId> rods;
    for (int i = 0; i < 6; ++i)
      rods.push_back(world.add_body({.mass = MassProperties::box(Vec3(1, 0.1, 0.1), 1 + i),
                                     .pose = {.p = Vec3(i, 0, 0)},
                                     .twist = {.w = Vec3(0, 0.3, 1), .v = Vec3(0, i * 1.0 - 2.5, 0)}}));
    for (int i = 1; i < 6; ++i) world.add("", Ball::at(world, rods[i - 1], rods[i], Vec3(i - 0.5, 0, 0)));
    Simulator simulator(world, with(solver, 3));
    const Vec3 P = linear_momentum(world, world.state()), L = angular_momentum(world, world.state());
    for (int i = 0; i < 200; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
    EXPECT_LE((linear_momentum(world, world.state()) - P).norm(), 1e-11 * P.norm());
    // Impulses at the two sides of an open joint make a couple.
    EXPECT_LE((angular_momentum(world, world.state()) - L).norm(), 1e-2 * L.norm());
  }
}

TEST(IterativeRelaxation, BeyondOneClosesChainsFaster) {
  const auto gap = [](double relaxation) {
    Scene scene = build_scene("chain", {{"n", 30}});
    Simulator simulator(scene.world, with(Solver::kGaussSeidel, 10, relaxation));
    for (int i = 0; i < 50; ++i) EXPECT_TRUE(simulator.step(1e-3).exact());
    return simulator.report().gap.metres;
  };
  EXPECT_LE(gap(1.7), 0.3 * gap(1));
}

World boxes(int count, double top_density) {
  World world;
  world.add_shape(kGround, HalfSpace{});
  for (int i = 0; i < count; ++i) {
    const double density = i == count - 1 ? top_density : 1000;
    const BodyId box = world.add_body({.mass = MassProperties::box(Vec3(0.2, 0.2, 0.2), Density{density}),
                                       .pose = {.p = Vec3(0, 0, 0.1 + 0.2 * i)}});
    world.add_shape(box, Box{Vec3(0.2, 0.2, 0.2)});
  }
  return world;
}

TEST_P(Iterative, CarriesAStack) {
  World world = boxes(4, 1000);
  Simulator simulator(world, with(GetParam(), 400));
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(simulator.step(2e-3).exact());
  const double weight = 4 * 8 * kG;
  double ground = 0;
  for (const ContactReport& contact : simulator.contacts())
    if (contact.contact.A == kGround || contact.contact.B == kGround) ground += contact.normal_force;
  if (GetParam() != Solver::kPropagation) {
    EXPECT_NEAR(ground, weight, 1e-3 * weight);
  }
  EXPECT_LE(simulator.report().penetration, 1e-5);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(world.pose({i + 1}).p.z(), 0.1 + 0.2 * i, 1e-5);
}

/// A heavy box on light ones is where iterations fail; holding fast what is below carries it.
TEST(IterativePropagation, CarriesAHeavyBoxOnLightOnes) {
  const auto moved = [](Solver solver) {
    World world = boxes(8, 1e5);
    Simulator simulator(world, with(solver, 10));
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(simulator.step(2e-3).exact());
    return std::abs(1.5 - world.pose({8}).p.z());
  };
  const double without = moved(Solver::kGaussSeidel);
  EXPECT_GT(without, 1e-3);
  EXPECT_LE(moved(Solver::kPropagation), 1e-6);
}

TEST_P(Iterative, SlidesAndSticksByCoulombsLaw) {
  for (const double friction : {0.3, 0.5}) {
    World world;
    const double slope = 0.4;  // tan: 0.42
    world.set_gravity(kG * Vec3(std::sin(slope), 0, -std::cos(slope)));
    Material material;
    material.static_friction = material.dynamic_friction = friction;
    world.add_shape(kGround, HalfSpace{}, {}, material);
    const BodyId box = world.add_body(
        {.mass = MassProperties::box(Vec3(0.2, 0.2, 0.1), 3), .pose = {.p = Vec3(0, 0, 0.05)}});
    world.add_shape(box, Box{Vec3(0.2, 0.2, 0.1)}, {}, material);
    Simulator simulator(world, with(GetParam(), 500));
    for (int i = 0; i < 500; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
    const double a = kG * (std::sin(slope) - friction * std::cos(slope));
    EXPECT_NEAR(world.pose(box).p.x(), a > 0 ? 0.5 * a * 0.25 : 0, 1e-4);
  }
}

TEST_P(Iterative, BouncesByRestitutionWithoutAFactor) {
  World world;
  Material material;
  material.restitution = 0.5;
  world.add_shape(kGround, HalfSpace{}, {}, material);
  const BodyId ball =
      world.add_body({.mass = MassProperties::sphere(0.1, 2), .pose = {.p = Vec3(0, 0, 1.1)}});
  world.add_shape(ball, Sphere{0.1}, {}, material);
  Simulator simulator(world, with(GetParam(), 50));
  double highest = 0;  // after the first impact, which is at √(2/g) = 0.45 s; the second is at 0.9 s
  while (world.time() < 0.85) {
    const StepReport report = simulator.step(1e-3);
    ASSERT_TRUE(report.exact());
    ASSERT_EQ(report.counts.factorizations, 0);
    if (world.time() > 0.46) highest = std::max(highest, world.pose(ball).p.z());
  }
  EXPECT_NEAR(highest, 0.1 + 0.25, 1e-5);  // e² of the height; g h²/8 from the next step
}

TEST_P(Iterative, MeetsLimitsAndMotors) {
  World world;
  const BodyId arm =
      world.add_body({.mass = MassProperties::box(Vec3(1, 0.1, 0.1), 2), .pose = {.p = Vec3(0.5, 0, 0)}});
  const JointId hinge = world.add("hinge", Hinge::at(world, kGround, arm, Vec3::Zero(), Vec3::UnitY()));
  const AxisId angle = world.axis(hinge, "angle");
  world.set_limits(angle, AxisLimits{.lower = -0.5, .upper = 0.5});
  Simulator simulator(world, with(GetParam(), 200));
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_NEAR(world.axis_value(angle), 0.5, 1e-6);  // falls, and rests on it
  EXPECT_NEAR(simulator.axis_report(angle).force.limit, -2 * kG * 0.5 * std::cos(0.5), 1e-4);
}

TEST(IterativeSettings, BadOnesAreRefused) {
  World world = boxes(1, 1000);
  const auto refused = [&](Settings settings) {
    EXPECT_THROW(Simulator(world, settings), std::invalid_argument);
  };
  refused(with(Solver::kGaussSeidel, 0));
  refused(with(Solver::kGaussSeidel, 10, 0));
  refused(with(Solver::kGaussSeidel, 10, 2));
  Settings settings = with(Solver::kPairwise, 10);
  settings.integrator = Integrator::kRattle4;
  refused(settings);
  settings = with(Solver::kPairwise, 10);
  settings.tension = TensionPolicy::kImplicit;
  refused(settings);
}

}  // namespace
}  // namespace taut::iterative_test
