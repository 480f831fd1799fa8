#include <gtest/gtest.h>

#include <cmath>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"
#include "tests/core/random_mass.h"
#include "tests/solvers/simulator/merging.h"

// What fixed joints bear whose bodies move as one.
namespace taut::merged_reactions_test {
namespace {

using testing::merging;
using testing::Random;
using testing::random_mass;
using testing::solving;

void expect_near(const Reaction& got, const Vec3& force, const Vec3& torque, double tolerance) {
  EXPECT_LT((got.force - force).norm(), tolerance) << got.force.transpose() << " / " << force.transpose();
  EXPECT_LT((got.torque - torque).norm(), tolerance) << got.torque.transpose() << " / " << torque.transpose();
}

/// n boxes in a row from a wall at x = 0; weld k is at x = k length.
struct Cantilever {
  static constexpr double kLength = 0.5, kMass = 3;
  World world;
  std::vector<BodyId> boxes;
  std::vector<JointId> welds;

  explicit Cantilever(int n, bool from_B = false) {
    for (int k = 0; k < n; ++k) {
      boxes.push_back(world.add_body({.mass = MassProperties::box({kLength, 0.1, 0.2}, kMass),
                                      .pose = {Quat::Identity(), {(k + 0.5) * kLength, 0, 0}}}));
      const BodyId before = k > 0 ? boxes[k - 1] : kGround, body = boxes[k];
      const Vec3 at(k * kLength, 0, 0);
      welds.push_back(
          world.add("", from_B ? Fixed::at(world, body, before, at) : Fixed::at(world, before, body, at)));
    }
  }
};

TEST(MergedReactions, OfACantileverAreShearAndMoment) {
  constexpr int kBoxes = 60;
  for (const bool from_B : {false, true}) {
    Cantilever beam(kBoxes, from_B);
    Simulator simulator(beam.world, merging());
    ASSERT_TRUE(simulator.step(0.01).exact());
    for (int k = 0; k < kBoxes; ++k) {
      const double weight = (kBoxes - k) * Cantilever::kMass * 9.81,
                   arm = (kBoxes - k) * Cantilever::kLength / 2;
      const double sign = from_B ? -1 : 1;
      const Vec3 force(0, 0, sign * weight), torque(0, -sign * weight * arm, 0);
      // Sums of 60 terms of this size.
      expect_near(simulator.reaction(beam.welds[k]), force, torque, 1e-11);
      expect_near(simulator.mean_reaction(beam.welds[k]), force, torque, 1e-11);
    }
  }
}

TEST(MergedReactions, OfATurningDumbbellAreCentripetal) {
  World world;
  world.set_gravity(Vec3::Zero());
  const double radius = 0.7, mass = 2, omega = 3;
  const auto ball = [&](double x) {
    return world.add_body({.mass = MassProperties::sphere(0.1, mass),
                           .pose = {Quat::Identity(), {x, 0, 0}},
                           .twist = {{0, 0, omega}, {0, omega * x, 0}}});
  };
  const BodyId left = ball(-radius), right = ball(radius);
  const BodyId rod =
      world.add_body({.mass = MassProperties::rod(1.4, 0.02, 1), .twist = {{0, 0, omega}, Vec3::Zero()}});
  const JointId to_right = world.add("right", Fixed::at(world, rod, right, Vec3(radius, 0, 0)));
  const JointId to_left = world.add("left", Fixed::at(world, left, rod, Vec3(-radius, 0, 0)));
  Simulator simulator(world, merging());
  const double pull = mass * omega * omega * radius;
  const auto check = [&](double tolerance) {
    const Vec3 out = world.pose(right).q * Vec3::UnitX();
    expect_near(simulator.reaction(to_right), -pull * out, Vec3::Zero(), tolerance);
    expect_near(simulator.reaction(to_left), -pull * out, Vec3::Zero(), tolerance);  // on the rod
  };
  check(1e-12);
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(simulator.step(0.01).exact());
  check(1e-10);
  // The chord of a step is shorter than its arc: of order h.
  const Reaction mean = simulator.mean_reaction(to_right);
  EXPECT_NEAR(mean.force.norm(), pull, 1e-3 * pull);
  EXPECT_LT(mean.torque.norm(), 1e-3 * pull);
}

/// Two groups with a hinge between them that hang from a ball joint, pulled at by a spring; with loops of
/// welds.
struct Mobile {
  World world;
  std::vector<BodyId> bodies;
  std::vector<JointId> welds;
  JointId hinge;

  Mobile(unsigned seed, bool loops) {
    Random random(seed);
    for (int i = 0; i < 8; ++i)
      bodies.push_back(world.add_body({.mass = random_mass(random),
                                       .pose = {random.rotation(), random.vector(1.5)},
                                       .twist = random.twist()}));
    const auto weld = [&](int a, int b) {
      welds.push_back(world.add("", Fixed::at(world, bodies[a], bodies[b], random.vector())));
    };
    world.add("", Ball::at(world, kGround, bodies[1], random.vector()));
    weld(0, 1), weld(2, 1), weld(1, 3);
    hinge = world.add("", Hinge::at(world, bodies[2], bodies[6], random.vector(), random.unit()));
    weld(4, 5), weld(6, 5), weld(7, 6);
    if (loops) weld(3, 2), weld(0, 2), weld(4, 6);
    world.add_force(SpringDamper(bodies[3], bodies[7], random.vector(), random.vector(), 30, 0.5, 0.4));
    world.add_force(PointForce(bodies[0], random.vector(), random.vector(4)));
  }
};

TEST(MergedReactions, AreThoseOfTheSolvedJoints) {
  for (const bool loops : {false, true}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      Mobile merged(seed, loops), solved(seed, loops);
      Simulator by_motion(merged.world, merging(Integrator::kRattle8)),
          by_joints(solved.world, solving(Integrator::kRattle8));
      for (int i = 0; i < 20; ++i) {
        ASSERT_TRUE(by_motion.step(0.005).exact());
        ASSERT_TRUE(by_joints.step(0.005).exact());
      }
      EXPECT_EQ(by_motion.merged_joints(), merged.welds);
      std::vector<JointId> joints = merged.welds;
      joints.push_back(merged.hinge);
      for (JointId joint : joints) {
        const Reaction expected = by_joints.reaction(joint);
        ASSERT_GT(expected.force.norm(), 1e-3);
        // States agree to 1e-8; with loops the factor's shift of 1e-8 is in the solved ones, too.
        expect_near(by_motion.reaction(joint), expected.force, expected.torque, (loops ? 1e-4 : 1e-5));
      }
    }
  }
}

TEST(MergedReactions, MeanOverAStepTendsToThatOfTheSolvedJoints) {
  double before = 0;
  for (int refinement = 0; refinement < 3; ++refinement) {
    const int steps = 50 << refinement;
    Mobile merged(3, false), solved(3, false);
    Simulator by_motion(merged.world, merging()), by_joints(solved.world, solving());
    for (int i = 0; i < steps; ++i) {
      ASSERT_TRUE(by_motion.step(0.1 / steps).exact());
      ASSERT_TRUE(by_joints.step(0.1 / steps).exact());
    }
    double worst = 0;
    for (JointId weld : merged.welds) {
      const Reaction a = by_motion.mean_reaction(weld), b = by_joints.mean_reaction(weld);
      worst = std::max({worst, (a.force - b.force).norm(), (a.torque - b.torque).norm()});
    }
    if (refinement > 0) {
      EXPECT_LT(worst, 0.65 * before);  // of order h at least
    }
    before = worst;
  }
  EXPECT_LT(before, 0.5);  // of forces around 50 N
}

TEST(MergedReactions, BalanceEveryMember) {
  // Newton's and Euler's equations of the members by differences of velocities.
  Mobile m(7, true);
  Simulator simulator(m.world, merging(Integrator::kRattle8));
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(simulator.step(0.005).exact());
  const State now = m.world.state();
  std::vector<Wrench> sum(now.poses.size());
  m.world.forces(now, sum);
  for (int j = 0; j < m.world.joint_count(); ++j) {
    const Joint& joint = m.world.joint(JointId{j});
    const Reaction reaction = simulator.reaction(JointId{j});
    const Vec3 p = now.poses[joint.b().index].point(joint.reaction_point_B());
    for (const auto& [body, sign] : {std::pair(joint.b(), 1.0), std::pair(joint.a(), -1.0)}) {
      Wrench& on = sum[body.index];
      on.force += sign * reaction.force;
      on.torque += sign * (reaction.torque + (p - now.poses[body.index].p).cross(reaction.force));
    }
  }
  const double h = 1e-5;
  World after = m.world;
  Simulator forward(after, merging(Integrator::kRattle8));
  ASSERT_TRUE(forward.step(h).exact());
  for (BodyId body : m.bodies) {
    const MassProperties& mass = m.world.mass_properties(body);
    const auto momentum = [&](const State& s) {
      const Twist& V = s.twists[body.index];
      const Mat3 R = s.poses[body.index].q.toRotationMatrix();
      return Wrench{R * mass.inertia_B() * R.transpose() * V.w, mass.mass() * V.v};
    };
    const Wrench rate = (1 / h) * (momentum(after.state()) - momentum(now));
    EXPECT_LT((rate.force - sum[body.index].force).norm(), 0.02);  // h/2 times a jerk of order 1000
    EXPECT_LT((rate.torque - sum[body.index].torque).norm(), 0.02);
  }
}

TEST(MergedReactions, OfAFrameAreSymmetric) {
  // A square of four welded bars that hangs at its top bar's middle: by symmetry both sides bear the same.
  World world;
  const auto bar = [&](const Vec3& size, const Vec3& at) {
    return world.add_body({.mass = MassProperties::box(size, 2), .pose = {Quat::Identity(), at}});
  };
  const BodyId top = bar({1, 0.1, 0.1}, {0, 0, 0.5}), bottom = bar({1, 0.1, 0.1}, {0, 0, -0.5});
  const BodyId left = bar({0.1, 0.1, 1}, {-0.5, 0, 0}), right = bar({0.1, 0.1, 1}, {0.5, 0, 0});
  world.add("pin", Ball::at(world, kGround, top, Vec3(0, 0, 0.5)));
  const JointId top_left = world.add("tl", Fixed::at(world, top, left, Vec3(-0.5, 0, 0.5)));
  const JointId top_right = world.add("tr", Fixed::at(world, top, right, Vec3(0.5, 0, 0.5)));
  const JointId low_left = world.add("ll", Fixed::at(world, left, bottom, Vec3(-0.5, 0, -0.5)));
  const JointId low_right = world.add("lr", Fixed::at(world, right, bottom, Vec3(0.5, 0, -0.5)));
  Simulator simulator(world, merging());
  ASSERT_TRUE(simulator.step(0.001).exact());
  EXPECT_EQ(simulator.merged_joints().size(), 4u);
  EXPECT_NEAR(simulator.reaction(top_left).force.z(), 3 * 9.81, 1e-9);
  EXPECT_NEAR(simulator.reaction(top_right).force.z(), 3 * 9.81, 1e-9);
  EXPECT_NEAR(simulator.reaction(low_left).force.z(), 9.81, 1e-9);
  EXPECT_NEAR(simulator.reaction(low_right).force.z(), 9.81, 1e-9);
  EXPECT_NEAR(simulator.reaction(top_left).force.x(), -simulator.reaction(top_right).force.x(), 1e-9);
  EXPECT_NEAR(simulator.reaction(low_left).torque.y(), -simulator.reaction(low_right).torque.y(), 1e-9);
}

TEST(MergedReactions, OfAnImpactAreItsMomentum) {
  // A welded tower falls flat on the ground: the weld stops what is above it within the step.
  World world;
  world.set_gravity(Vec3::Zero());
  world.add_shape(kGround, HalfSpace{});
  const BodyId low = world.add_body({.mass = MassProperties::box({1, 1, 1}, 2),
                                     .pose = {Quat::Identity(), {0, 0, 0.52}},
                                     .twist = {Vec3::Zero(), {0, 0, -3}}});
  const BodyId high = world.add_body({.mass = MassProperties::box({1, 1, 1}, 5),
                                      .pose = {Quat::Identity(), {0, 0, 1.52}},
                                      .twist = {Vec3::Zero(), {0, 0, -3}}});
  world.add_shape(low, Box{{1, 1, 1}});
  const JointId weld = world.add("weld", Fixed::at(world, low, high, Vec3(0, 0, 1.02)));
  Simulator simulator(world, merging());
  const double dt = 0.01;
  ASSERT_TRUE(simulator.step(dt).exact());
  EXPECT_NEAR(world.twist(high).v.z(), 0, 1e-9);
  expect_near(simulator.mean_reaction(weld), Vec3(0, 0, 5 * 3 / dt), Vec3::Zero(), 1e-6);
}

TEST(MergedReactions, OfTheLastStepOutliveChanges) {
  Cantilever beam(3);
  Simulator simulator(beam.world, merging());
  ASSERT_TRUE(simulator.step(0.01).exact());
  const double weight = 3 * Cantilever::kMass * 9.81;
  beam.world.set_gravity({0, 0, -1});
  EXPECT_NEAR(simulator.reaction(beam.welds[0]).force.z(), 9, 1e-12);
  EXPECT_NEAR(simulator.mean_reaction(beam.welds[0]).force.z(), weight, 1e-12);
  ASSERT_TRUE(simulator.step(0.01).exact());
  EXPECT_NEAR(simulator.mean_reaction(beam.welds[0]).force.z(), 9, 1e-12);
}

}  // namespace
}  // namespace taut::merged_reactions_test
