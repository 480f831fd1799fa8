#include "core/world/diagnostics.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "tests/core/random_state.h"

namespace taut::diagnostics_test {
namespace {

using testing::Random;

/// Five bodies, one of them fixed, with full inertia tensors, in random states.
World random_world(Random& random) {
  World world;
  for (int i = 0; i < 5; ++i) {
    const Vec3 s(random.uniform(0.1, 2), random.uniform(0.1, 2), random.uniform(0.1, 2));
    const Mat3 R = random.rotation().toRotationMatrix();
    const Mat3 inertia = R * Vec3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y()).asDiagonal() * R.transpose();
    BodySpec body{.mass = {random.uniform(0.5, 3), inertia}, .pose = random.pose(), .fixed = i == 2};
    if (!body.fixed) body.twist = random.twist();
    world.add_body(body);
  }
  return world;
}

/// A moving body as a cloud of point masses with the same mass and inertia: six points at ±a_k along the
/// principal axes, where the second moment along axis k is 2 m_p a_k².
struct Cloud {
  double point_mass;
  Vec3 x[6], v[6];

  Cloud(const MassProperties& mass, const Pose& pose, const Twist& V) : point_mass(mass.mass() / 6) {
    const Vec3 I = mass.principal_moments(), second = Vec3::Constant(I.sum() / 2) - I;
    for (int k = 0; k < 3; ++k)
      for (int side : {0, 1}) {
        const double a = (side ? -1 : 1) * std::sqrt(second[k] / (2 * point_mass));
        const Vec3 r = pose.q * (mass.q_BP() * Vec3(a * Vec3::Unit(k)));
        x[2 * k + side] = pose.p + r;
        v[2 * k + side] = V.at(r);
      }
  }
};

template <typename Visit>
void for_each_point(const World& world, Visit&& visit) {
  for (int b = 0; b < world.body_count(); ++b) {
    const BodyId id{b};
    if (world.is_fixed(id)) continue;
    const Cloud cloud(world.mass_properties(id), world.pose(id), world.twist(id));
    for (int i = 0; i < 6; ++i) visit(cloud.point_mass, cloud.x[i], cloud.v[i]);
  }
}

/// Sums of some dozens of terms of order ten.
constexpr double kRoundOff = 1e-12;

TEST(Diagnostics, EnergiesAndMomentaAreThoseOfPointMasses) {
  Random random(41);
  for (int trial = 0; trial < 20; ++trial) {
    const World world = random_world(random);
    const State& state = world.state();
    const Vec3 about = random.vector(3);
    double kinetic = 0, potential = 0;
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
    for_each_point(world, [&](double m, const Vec3& x, const Vec3& v) {
      kinetic += 0.5 * m * v.squaredNorm();
      potential += m * 9.81 * x.z();
      linear += m * v;
      angular += (x - about).cross(m * v);
    });
    EXPECT_NEAR(kinetic_energy(world, state), kinetic, kRoundOff * kinetic);
    EXPECT_NEAR(total_energy(world, state), kinetic + potential, kRoundOff * 100);
    EXPECT_LT((linear_momentum(world, state) - linear).norm(), kRoundOff);
    EXPECT_LT((angular_momentum(world, state, about) - angular).norm(), kRoundOff * 100);
  }
}

TEST(Diagnostics, AngularMomentumShiftsWithTheReferencePoint) {
  Random random(42);
  const World world = random_world(random);
  const Vec3 shift = random.vector(3), P = linear_momentum(world, world.state());
  const Vec3 L = angular_momentum(world, world.state());
  EXPECT_LT((angular_momentum(world, world.state(), shift) - (L - shift.cross(P))).norm(), kRoundOff);
  // Without net momentum it is the same about every point.
  State still = world.state();
  double mass = 0;
  for (int b = 1; b < world.body_count(); ++b)
    if (!world.is_fixed(BodyId{b})) mass += world.mass_properties(BodyId{b}).mass();
  for (int b = 1; b < world.body_count(); ++b) still.twists[b].v -= P / mass;
  EXPECT_LT((angular_momentum(world, still, shift) - angular_momentum(world, still)).norm(), kRoundOff);
}

TEST(Diagnostics, EnergiesDoNotDependOnTheFrame) {
  Random random(43);
  World world = random_world(random);
  world.set_gravity(Vec3::Zero());
  const Quat R = random.rotation();
  State turned = world.state();
  for (int b = 1; b < world.body_count(); ++b) {
    turned.poses[b] = testing::transformed(R, Vec3(1, 2, 3), turned.poses[b]);
    turned.twists[b] = {R * turned.twists[b].w, R * turned.twists[b].v};
  }
  const double energy = total_energy(world, world.state());
  EXPECT_NEAR(total_energy(world, turned), energy, kRoundOff * energy);
  EXPECT_LT((linear_momentum(world, turned) - R * linear_momentum(world, world.state())).norm(), kRoundOff);
}

TEST(Diagnostics, FixedBodiesCarryNothing) {
  World world;
  world.add_body({.pose = {Quat::Identity(), Vec3(0, 0, 5)}, .fixed = true});
  EXPECT_EQ(total_energy(world, world.state()), 0);
  EXPECT_EQ(linear_momentum(world, world.state()), Vec3::Zero());
}

/// A hinge and a ball on one body, with residuals of the test's choice.
struct Gaps {
  World world;
  Rows rows;
  Gaps() : rows(build(world)) {}
  static const World& build(World& world) {
    const BodyId body = world.add_body({});
    world.add("ball", Ball::at(world, kGround, body, Vec3::Zero()));
    world.add("hinge", Hinge::at(world, kGround, body, Vec3::Zero(), Vec3::UnitZ()));
    return world;
  }
};

TEST(Gaps, AreNormsOfTranslationsAndRotationsApart) {
  const Gaps s;
  const std::vector<double> phi{3, 0, 4, 2, 3, 6, 5, 12};
  const std::vector<Gap> gaps = joint_gaps(s.rows, phi);
  ASSERT_EQ(gaps.size(), 2u);
  EXPECT_EQ(gaps[0].metres, 5);
  EXPECT_EQ(gaps[0].radians, 0);
  EXPECT_EQ(gaps[1].metres, 7);
  EXPECT_EQ(gaps[1].radians, 13);
  const Gap worst = max_gap(s.rows, phi);
  EXPECT_EQ(worst.metres, 7);
  EXPECT_EQ(worst.radians, 13);
}

TEST(Gaps, ShowANotANumberWhereverItStands) {
  const Gaps s;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (int row = 0; row < 8; ++row) {
    std::vector<double> phi{9, 9, 9, 1, 1, 1, 1, 1};
    phi[row] = kNan;
    const Gap worst = max_gap(s.rows, phi);
    const bool angular = row >= 6;
    EXPECT_EQ(std::isnan(worst.metres), !angular) << row;
    EXPECT_EQ(std::isnan(worst.radians), angular) << row;
    const Gap own = joint_gaps(s.rows, phi)[row < 3 ? 0 : 1];
    EXPECT_TRUE(std::isnan(angular ? own.radians : own.metres)) << row;
  }
}

}  // namespace
}  // namespace taut::diagnostics_test
