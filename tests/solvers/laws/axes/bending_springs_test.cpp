#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"
#include "tests/core/random_state.h"

/// Springs of a swing with their rest at 0, where that has no direction.
namespace taut::bending_springs_test {
namespace {

/// A ball of unit inertia about the origin, held there by a joint that bends away from x.
struct Bent {
  World world;
  BodyId body;
  JointId joint;
  explicit Bent(bool universal) {
    world.set_gravity(Vec3::Zero());
    body = world.add_body({.mass = MassProperties(1, Vec3(1, 1, 1))});
    joint =
        universal
            ? world.add("", Universal::at(world, kGround, body, Vec3::Zero(), Vec3::UnitY(), Vec3::UnitZ()))
            : world.add("", Ball::at(world, kGround, body, Vec3::Zero()).with_axes(world, Vec3::UnitX()));
  }
  AxisId axis(const char* ball, const char* cross) const {
    return world.axis(joint, world.joint(joint).type() == "ball" ? ball : cross);
  }
};

class BendingSpring : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(All, BendingSpring, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "Universal" : "Ball"; });

/// In a plane it is a harmonic oscillator with a damper, I s̈ = −k s − c ṡ, straight through 0, however far.
TEST_P(BendingSpring, SwingsThroughStraightAsAnOscillator) {
  constexpr double k = 40, c = 0.6, angle = 1.4;
  double error[2];
  for (int fine : {0, 1}) {
    Bent bent(GetParam());
    bent.world.set_spring(bent.axis("swing", "swing"), AxisSpring{.stiffness = k, .damping = c});
    bent.world.set_pose(bent.body, {.q = exp_so3(angle * Vec3::UnitY())});
    const AxisId along = bent.axis("swing_x", "swing_1"), other = bent.axis("swing_y", "swing_2");
    // x and y of the frame of the ball joint are across the axis in some way.
    const double s0[2] = {bent.world.axis_value(along), bent.world.axis_value(other)};
    Simulator simulator(bent.world);
    const double h = fine ? 1e-3 : 2e-3, decay = 0.5 * c, omega = std::sqrt(k - decay * decay);
    const auto x = [&](double t) {
      return std::exp(-decay * t) * (std::cos(omega * t) + decay / omega * std::sin(omega * t));
    };
    error[fine] = 0;
    for (int i = 1; i * h <= 2 + 1e-9; ++i) {
      const StepReport& report = simulator.step(h);
      ASSERT_TRUE(report.exact()) << report.message;
      ASSERT_EQ(report.substeps, 1);
      ASSERT_NEAR(report.ledger.total(), report.ledger.change(), 1e-12 * k);
      error[fine] = std::max({error[fine], std::abs(bent.world.axis_value(along) - s0[0] * x(i * h)),
                              std::abs(bent.world.axis_value(other) - s0[1] * x(i * h))});
      // Told of the middle of the step, along both components.
      const double force =
          std::hypot(simulator.axis_report(along).force.spring, simulator.axis_report(other).force.spring);
      ASSERT_NEAR(force, k * angle * std::abs(x((i - 0.5) * h)), 1e-2) << i;
      ASSERT_EQ(simulator.axis_report(bent.axis("swing", "swing")).force.spring, 0);
    }
  }
  EXPECT_LT(error[1], 1e-4);
  EXPECT_NEAR(error[0] / error[1], 4, 0.1);
}

/// Over the top, where both components change their sign, nothing is thrown: the spring pushes to either
/// side.
TEST_P(BendingSpring, GoesThroughTheFold) {
  for (double damping : {0.0, 0.2}) {
    constexpr double k = 1, speed = 4;  // ½ k π² = 4.9 J of 8 J
    Bent bent(GetParam());
    bent.world.set_spring(bent.axis("swing", "swing"), AxisSpring{.stiffness = k, .damping = damping});
    bent.world.set_twist(bent.body, {speed * Vec3::UnitY(), Vec3::Zero()});
    Simulator simulator(bent.world);
    double most = 0, last = 0.5 * speed * speed;
    for (int i = 0; i < 2000; ++i) {
      const StepReport& report = simulator.step(1e-3);
      ASSERT_TRUE(report.exact()) << report.message;
      const double theta = bent.world.axis_value(bent.axis("swing", "swing"));
      most = std::max(most, theta);
      ASSERT_NEAR(report.spring_energy, 0.5 * k * theta * theta, 1e-12);
      // The kink at π costs or gives what h ω misses of it.
      ASSERT_LE(report.energy(), last + 2e-2) << i;
      if (damping == 0) {
        ASSERT_NEAR(report.energy(), 0.5 * speed * speed, 2e-2) << i;
      }
      last = report.energy();
    }
    EXPECT_GT(most, std::numbers::pi - 0.01);
  }
}

/// Friction of the same swing holds the bend that the spring would undo, and slides where it is too weak.
TEST_P(BendingSpring, StandsBesideFriction) {
  for (double friction : {3.0, 1.0}) {
    constexpr double k = 4, angle = 0.5;
    Bent bent(GetParam());
    const AxisId swing = bent.axis("swing", "swing");
    bent.world.set_pose(bent.body, {.q = exp_so3(angle * Vec3::UnitY())});
    bent.world.set_spring(swing, AxisSpring{.stiffness = k});
    bent.world.set_friction(swing, AxisFriction{friction, friction});
    Simulator simulator(bent.world);
    for (int i = 0; i < 2000; ++i) ASSERT_TRUE(simulator.step(2e-3).exact()) << i;
    const double rest = bent.world.axis_value(swing);
    if (friction > k * angle)
      EXPECT_NEAR(rest, angle, 1e-9);
    else  // half a swing about the place where the spring is as strong, if not beyond straight
      EXPECT_NEAR(rest, std::abs(2 * friction / k - angle), 1e-4);
  }
}

/// Both springs of a component act.
TEST_P(BendingSpring, IsAddedToThoseOfItsComponents) {
  Bent bent(GetParam());
  const AxisId first = bent.axis("swing_x", "swing_1");
  bent.world.set_spring(bent.axis("swing", "swing"), AxisSpring{.stiffness = 30, .damping = 6});
  bent.world.set_spring(first, AxisSpring{.stiffness = 10, .damping = 2, .rest = 0.8});
  Simulator simulator(bent.world);
  for (int i = 0; i < 2000; ++i) ASSERT_TRUE(simulator.step(5e-3).exact());
  EXPECT_NEAR(bent.world.axis_value(first), 0.8 * 10 / 40, 1e-6);
  EXPECT_NEAR(bent.world.axis_value(bent.axis("swing", "swing")), 0.8 * 10 / 40, 1e-6);
  // Without that of the swing its own is left, and a row less.
  bent.world.set_spring(bent.axis("swing", "swing"), std::nullopt);
  for (int i = 0; i < 4000; ++i) ASSERT_TRUE(simulator.step(5e-3).exact());
  EXPECT_NEAR(bent.world.axis_value(first), 0.8, 1e-6);
}

/// Six bodies in free flight, joined by joints that bend against springs of any stiffness.
struct Chain {
  World world;
  testing::Random random;
  double step = 0;

  Chain(unsigned seed, bool universal, bool damped) : random(seed) {
    world.set_gravity(Vec3::Zero());
    step = seed % 3 == 0 ? 1e-3 : seed % 3 == 1 ? 2e-3 : 5e-3;
    std::vector<BodyId> body;
    for (int i = 0; i < 6; ++i) {
      const Vec3 size = Vec3::Constant(0.3) + random.vector(0.2);
      body.push_back(
          world.add_body({.mass = MassProperties::box(size, random.uniform(1, 20)),
                          .pose = {.q = random.rotation(), .p = Vec3(0.4 * i, 0, 0) + random.vector(0.1)}}));
    }
    for (int i = 0; i + 1 < 6; ++i) {
      const BodyId a = body[i], b = body[i + 1];
      const Vec3 p = 0.5 * (world.pose(a).p + world.pose(b).p);
      const JointId joint = universal
                                ? world.add("", Universal::at(world, a, b, p, Vec3::UnitY(), Vec3::UnitZ()))
                                : world.add("", Ball::at(world, a, b, p).with_axes(world, Vec3::UnitX()));
      world.set_spring(world.axis(joint, "swing"),
                       AxisSpring{.stiffness = std::pow(10, random.uniform(2, 10)),
                                  .damping = damped ? std::pow(10, random.uniform(-2, 5)) : 0});
    }
    for (BodyId b : body) world.set_twist(b, {random.vector(2), random.vector()});
  }
};

TEST_P(BendingSpring, OfAnyStiffnessInChainsGainsNoEnergy) {
  long substeps = 0, steps = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    Chain chain(seed, GetParam(), seed % 2 == 1);
    Simulator simulator(chain.world);
    const Vec3 P = linear_momentum(chain.world, chain.world.state());
    const Vec3 L = angular_momentum(chain.world, chain.world.state());
    double start = 0;
    for (int i = 0; i < 200; ++i) {
      const StepReport& report = simulator.step(chain.step);
      ASSERT_TRUE(report.exact()) << seed << " step " << i << ": " << report.message;
      if (i == 0) start = report.ledger.start;
      ASSERT_LE(report.energy(), 1.02 * start) << seed << " step " << i;
      ASSERT_NEAR(report.ledger.total(), report.ledger.change(), 1e-12 * start) << seed << " step " << i;
      ASSERT_LE(std::max(report.gap.metres, report.gap.radians), 1e-9) << seed << " step " << i;
      ASSERT_LE((report.linear_momentum - P).norm(), 1e-9) << seed << " step " << i;
      ASSERT_LE((report.angular_momentum - L).norm(), 1e-9) << seed << " step " << i;
      substeps += report.substeps;
      ++steps;
    }
  }
  EXPECT_LE(substeps,
            1.2 * steps);  // two for chains that turn fast for their step; 450 along the swing itself
}

}  // namespace
}  // namespace taut::bending_springs_test
