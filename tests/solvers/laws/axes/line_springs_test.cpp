#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"
#include "tests/allocation_counter.h"
#include "tests/core/random_state.h"

// Springs and dampers between points of two bodies, linear and by tables, which RATTLE takes implicitly.
namespace taut::line_springs_test {
namespace {

using testing::Random;

constexpr double kG = 9.81;

void run(Simulator& simulator, double dt, int steps) {
  for (int i = 0; i < steps; ++i) {
    const StepReport& r = simulator.step(dt);
    ASSERT_TRUE(r.exact()) << i << ": " << r.message;
    const double scale = 1 + std::abs(r.energy()) + r.kinetic_energy + r.spring_energy;
    ASSERT_NEAR(r.ledger.start + r.ledger.total(), r.energy(), 1e-12 * scale) << i;
    ASSERT_NEAR(r.ledger.total(), r.ledger.change(), 1e-12 * scale) << i;
    ASSERT_EQ(r.ledger.forces, 0);
  }
}

/// A ball of 2 kg without weight at x, on a spring to the origin.
struct Ball1 {
  World world;
  BodyId ball;
  explicit Ball1(const AxisSpring& law, double x, double v = 0) {
    world.set_gravity(Vec3::Zero());
    ball = world.add_body({.mass = MassProperties::sphere(0.1, 2),
                           .pose = {.p = {x, 0, 0}},
                           .twist = {Vec3::Zero(), Vec3(v, 0, 0)}});
    world.add_force(SpringDamper(kGround, ball, Vec3::Zero(), Vec3::Zero(), law));
  }
  double x() const { return world.pose(ball).p.x(); }
  double v() const { return world.twist(ball).v.x(); }
};

/// x(T) of x'' = f(x, x')/2 by Runge and Kutta's method with a step that is short for it.
double integrated(const std::function<double(double x, double v)>& force, double x, double v, double T) {
  const int n = 200000;
  const double h = T / n;
  for (int i = 0; i < n; ++i) {
    const auto a = [&](double px, double pv) { return force(px, pv) / 2; };
    const double a1 = a(x, v), v2 = v + h / 2 * a1, a2 = a(x + h / 2 * v, v2), v3 = v + h / 2 * a2,
                 a3 = a(x + h / 2 * v2, v3), v4 = v + h * a3, a4 = a(x + h * v3, v4);
    x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return x;
}

/// Errors after T at steps of T/n and T/2n.
std::pair<double, double> errors(const AxisSpring& law, double x, double exact, double T, int n) {
  double error[2];
  for (int k : {0, 1}) {
    Ball1 b(law, x);
    Simulator simulator(b.world);
    run(simulator, T / (n << k), n << k);
    error[k] = std::abs(b.x() - exact);
  }
  return {error[0], error[1]};
}

/// The midpoint rule is slow by (ω h)²/12 of the frequency.
TEST(LineSprings, SwingAsInTheClosedFormWithSecondOrder) {
  const double T = 3, omega = std::sqrt(50.0 / 2), decay = 1.0 / 4;
  const double damped = std::sqrt(omega * omega - decay * decay);
  for (const double rest : {0.0, 1.0}) {
    const auto [coarse, fine] =
        errors({.stiffness = 50, .rest = rest}, rest + 0.4, rest + 0.4 * std::cos(omega * T), T, 600);
    EXPECT_LT(coarse, 0.4 * omega * T * 0.025 * 0.025 / 12) << rest;
    EXPECT_NEAR(coarse / fine, 4, 0.2) << rest;
  }
  const double end =
      0.4 * std::exp(-decay * T) * (std::cos(damped * T) + decay / damped * std::sin(damped * T));
  const auto [coarse, fine] = errors({.stiffness = 50, .damping = 1, .rest = 1}, 1.4, 1 + end, T, 600);
  EXPECT_LT(coarse, 0.4 * omega * T * 0.025 * 0.025 / 12);
  EXPECT_NEAR(coarse / fine, 4, 0.2);
}

/// Springs of 10 … 1e9 N/m below each other, with dampers of 0, 1e-3 k s and k s, at steps of many periods:
/// no energy comes from nowhere, and with dampers they come to rest as in statics.
TEST(LineSprings, AreStableAtAnyStiffnessAndDamping) {
  for (const double damping : {0.0, 1e-3, 1.0}) {
    World world;
    BodyId last = kGround;
    std::vector<BodyId> balls;
    const double stiffness[] = {10, 1e3, 1e5, 1e7, 1e9};
    for (const double k : stiffness) {
      const Vec3 p(0, 0, -0.5 * (1 + std::ssize(balls)));
      balls.push_back(world.add_body({.mass = MassProperties::sphere(0.1, 2), .pose = {.p = p}}));
      world.add_force(SpringDamper(last, balls.back(), Vec3::Zero(), Vec3::Zero(), k, 0.5, damping * k));
      last = balls.back();
    }
    world.set_twist(balls[2], {Vec3::Zero(), Vec3(0.3, 0.2, 0)});
    Simulator simulator(world);
    double start = 0, work = 0, least = 0, most = 0;
    for (int i = 0; i < 2400; ++i) {
      ASSERT_NO_FATAL_FAILURE(run(simulator, 1.0 / 240, 1)) << damping << ' ' << i;
      const StepReport& r = simulator.report();
      if (i == 0) start = r.ledger.start;
      work += r.ledger.damping;
      ASSERT_LE(r.ledger.damping, 1e-12) << i;
      least = std::min(least, r.energy() - start - work), most = std::max(most, r.energy() - start - work);
    }
    // What swings across the springs is explicit, second order.
    EXPECT_LT(std::max(most, -least), 2e-3);
    if (damping < 1) continue;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const Vec3 up = i > 0 ? world.pose(balls[i - 1]).p : Vec3(Vec3::Zero());
      const double stretch = static_cast<double>(balls.size() - i) * 2 * kG / stiffness[i];
      EXPECT_NEAR((world.pose(balls[i]).p - up).norm() - 0.5, stretch, 5e-3 * stretch) << stiffness[i];
    }
  }
}

/// A digressive damper: steep at rest, flat beyond 0.1 m/s; a progressive spring with a stop of 1e6 N/m.
TEST(LineSprings, WithTablesMoveAsAnIndependentIntegrationSays) {
  AxisSpring law{.rest = 1};
  law.table = Curve({{-0.3, -40}, {0, 0}, {0.2, 10}, {0.5, 100}});
  law.damping_table = Curve({{-2, -9}, {-0.1, -5}, {0, 0}, {0.1, 3}, {2, 6}});
  const auto force = [&](double x, double v) { return spring_force(law, x) + damping_force(law, v); };
  const double exact = integrated(force, 1.45, 0, 1.5);
  const auto [coarse, fine] = errors(law, 1.45, exact, 1.5, 300);
  EXPECT_LT(coarse, 1e-4);
  EXPECT_LT(fine, 0.5 * coarse);
}

TEST(LineSprings, KeepTheirEnergyWhateverTheTable) {
  AxisSpring law{.rest = 1};
  law.table = Curve({{-0.1, -1e5}, {-0.05, 0}, {0.05, 0}, {0.06, 1e7}});  // free play between stops
  Ball1 b(law, 1, 3);
  Simulator simulator(b.world);
  double most = 0, least = 9;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_NO_FATAL_FAILURE(run(simulator, 1.0 / 240, 1)) << i;
    most = std::max(most, simulator.report().energy()), least = std::min(least, simulator.report().energy());
  }
  EXPECT_NEAR(least, 9, 1e-6);
  EXPECT_NEAR(most, 9, 1e-6);
}

TEST(LineSprings, PassThroughTheirAnchor) {
  for (const double rest : {0.0, 0.5}) {
    Ball1 b({.stiffness = 10, .rest = rest}, 1, -4);
    Simulator simulator(b.world);
    double least = 1;
    for (int i = 0; i < 480; ++i) {
      ASSERT_NO_FATAL_FAILURE(run(simulator, 1.0 / 240, 1)) << rest << ' ' << i;
      least = std::min(least, b.x());
      if (rest == 0) {
        ASSERT_NEAR(simulator.report().ledger.integration, 0, 1e-12) << i;
      }
    }
    EXPECT_LT(least, -0.9) << rest;
    // Where the force jumps, with a length of its own, one step may be off by the way through it.
    const double E = 16 + 5 * (1 - rest) * (1 - rest);
    EXPECT_NEAR(simulator.report().energy(), E, rest == 0 ? 1e-9 * E : 0.01 * E);
  }
}

TEST(LineSprings, DoNotAllocateInAStep) {
  World world;
  Random random(5);
  for (int i = 0; i < 6; ++i) {
    const BodyId body = world.add_body({.mass = {1.5, Vec3(0.2, 0.3, 0.35)}, .pose = random.pose()});
    AxisSpring law{.stiffness = 40, .rest = i % 2 * 0.7};
    law.damping_table = Curve({{-1, -3}, {0, 0}, {1, 2}});
    world.add_force(SpringDamper(kGround, body, random.vector(2), random.vector(0.2), law));
  }
  Simulator simulator(world);
  run(simulator, 1e-3, 20);
  const auto before = allocation_count();
  for (int i = 0; i < 20; ++i) (void)simulator.step(1e-3);
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace taut::line_springs_test
