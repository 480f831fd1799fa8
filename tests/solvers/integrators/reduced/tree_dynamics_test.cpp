#include "solvers/integrators/reduced/tree_dynamics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"
#include "solvers/system/mass_matrix.h"
#include "tests/core/random_state.h"

namespace taut::tree_dynamics_test {
namespace {

using testing::Random;

constexpr double kG = 9.81;

/// A tree with every second body on its predecessor and the others anywhere, with joints of all kinds; one
/// body hangs on nothing.
World random_tree(unsigned seed, int bodies) {
  Random random(seed);
  World world;
  for (int b = 1; b <= bodies; ++b) {
    const MassProperties mass(random.uniform(0.5, 2), Vec3(random.uniform(0.5, 2) * Vec3(0.2, 0.3, 0.4)));
    const Pose pose = random.pose();
    const BodyId body = world.add_body({.mass = mass, .pose = pose, .twist = random.twist()});
    world.add_force(PointForce(body, random.vector(3), random.vector()));
    if (b == bodies) break;
    const BodyId parent{b % 2 == 0 ? b - 1 : static_cast<int>(random.uniform(0, b - 1e-9))};
    const Vec3 point = random.vector(2), axis = random.unit();
    const bool turned = b % 3 == 0;  // the child is A
    const BodyId A = turned ? body : parent, B = turned ? parent : body;
    switch (b % 7) {
      case 0:
        world.add("", Ball::at(world, A, B, point));
        break;
      case 1:
        world.add("", Hinge::at(world, A, B, point, axis));
        break;
      case 2:
        world.add("", Slider::at(world, A, B, point, axis));
        break;
      case 3:
        world.add("", Cylindrical::at(world, A, B, point, axis));
        break;
      case 4:
        world.add("", Planar::at(world, A, B, point, axis, axis.unitOrthogonal()));
        break;
      case 5:
        world.add("", PointOnLine::at(world, A, B, point, axis));
        break;
      default:
        world.add("", Fixed::at(world, A, B, point));
    }
  }
  return world;
}

struct Tree {
  explicit Tree(const World& its) : world(its) { dynamics.linearize(world.state()); }
  int freedoms() const { return dynamics.freedoms(); }
  std::vector<Twist> recursive() { return accelerations(TreeDynamics::Method::kRecursive); }
  std::vector<Twist> lagrangian() { return accelerations(TreeDynamics::Method::kLagrangian); }
  std::vector<Twist> accelerations(TreeDynamics::Method method) {
    std::vector<Wrench> forces(world.body_count());
    std::vector<Twist> result(world.body_count());
    world.forces(world.state(), forces);
    dynamics.accelerate(world.state(), forces, method, result);
    lambda.clear();
    for (int j = 0; j < world.joint_count(); ++j) {
      const auto its = dynamics.multipliers(JointId{j});
      lambda.insert(lambda.end(), its.begin(), its.end());
    }
    return result;
  }

  const World& world;
  TreeDynamics dynamics{world};
  std::vector<double> lambda;
};

/// The same by multipliers, dense: M a − Jᵀ λ = f − ω × Iω, J a = −γ.
std::vector<Twist> by_multipliers(const World& world, std::vector<double>& lambda) {
  const Rows rows(world, Rows::AxisRows::kLeftOut);
  const MassMatrix mass(world);
  const State& state = world.state();
  const int bodies = world.body_count(), n = 6 * bodies, m = rows.row_count();
  std::vector<double> values(rows.jacobian_size()), gamma(m);
  rows.jacobian(Configuration(state), values);
  rows.bias(Configuration(state), state.twists, gamma);
  std::vector<Wrench> forces(bodies);
  world.forces(state, forces);
  Eigen::MatrixXd K = Eigen::MatrixXd::Identity(n + m, n + m);
  K.bottomRightCorner(m, m).setZero();
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n + m);
  for (int b = 1; b < bodies; ++b) {
    const Mat3 R = mass.principal_axes(b, state.poses[b]);
    K.block<3, 3>(6 * b, 6 * b) = R * mass.inertia(b).moments.asDiagonal() * R.transpose();
    K.block<3, 3>(6 * b + 3, 6 * b + 3) = mass.inertia(b).mass * Mat3::Identity();
    const Vec3& w = state.twists[b].w;
    right.segment<3>(6 * b) = forces[b].torque - w.cross(K.block<3, 3>(6 * b, 6 * b) * w);
    right.segment<3>(6 * b + 3) = forces[b].force;
  }
  for (const Rows::Side& side : rows.sides()) {
    if (mass[side.body].fixed) continue;
    for (int i = 0; i < side.row_count; ++i)
      for (int k = 0; k < 6; ++k) {
        const double J = values[side.offset + 6 * i + k];
        K(n + side.first_row + i, 6 * side.body + k) = J;
        K(6 * side.body + k, n + side.first_row + i) = -J;
      }
  }
  for (int r = 0; r < m; ++r) right[n + r] = -gamma[r];
  const Eigen::VectorXd x = K.fullPivLu().solve(right);
  std::vector<Twist> result(bodies);
  for (int b = 1; b < bodies; ++b) result[b] = {x.segment<3>(6 * b), x.segment<3>(6 * b + 3)};
  lambda.assign(x.data() + n, x.data() + n + m);
  return result;
}

void expect_equal(const std::vector<Twist>& a, const std::vector<Twist>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  double scale = 1;
  for (const Twist& twist : b) scale = std::max({scale, twist.w.norm(), twist.v.norm()});
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_LE((a[k].w - b[k].w).norm(), tolerance * scale) << "body " << k;
    EXPECT_LE((a[k].v - b[k].v).norm(), tolerance * scale) << "body " << k;
  }
}

/// Accelerations and λ by both methods.
void expect_as_by_multipliers(const World& world, double tolerance) {
  Tree tree(world);
  std::vector<double> lambda;
  const std::vector<Twist> reference = by_multipliers(world, lambda);
  double largest = 1;
  for (double l : lambda) largest = std::max(largest, std::abs(l));
  for (const auto method : {TreeDynamics::Method::kRecursive, TreeDynamics::Method::kLagrangian}) {
    expect_equal(tree.accelerations(method), reference, tolerance);
    ASSERT_EQ(tree.lambda.size(), lambda.size());
    for (std::size_t r = 0; r < lambda.size(); ++r)
      EXPECT_NEAR(tree.lambda[r], lambda[r], tolerance * largest) << "row " << r;
  }
}

TEST(TreeDynamics, RecursionLagrangeAndMultipliersAgree) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const World world = random_tree(seed, 12);
    expect_as_by_multipliers(world, 1e-9);  // round-off times the condition of random lever arms
  }
}

/// Two uniform rods, level and at rest: α₁ = −9/7 g/L, α₂ = 3/7 g/L.
TEST(TreeDynamics, DoublePendulumAsInTextbooks) {
  World world;
  const auto rod = [&](double x) {
    return world.add_body(
        {.mass = MassProperties(2, Vec3(1e-3, 2.0 / 12, 2.0 / 12)), .pose = {.p = Vec3(x, 0, 0)}});
  };
  const BodyId first = rod(0.5), second = rod(1.5);
  world.add("", Hinge::at(world, kGround, first, Vec3::Zero(), -Vec3::UnitY()));
  world.add("", Hinge::at(world, first, second, Vec3::UnitX(), -Vec3::UnitY()));
  Tree tree(world);
  EXPECT_EQ(tree.freedoms(), 2);
  for (const auto& a : {tree.recursive(), tree.lagrangian()}) {
    EXPECT_NEAR(-a[1].w.y(), -9.0 / 7 * kG, 1e-12);
    EXPECT_NEAR(-a[2].w.y(), 3.0 / 7 * kG, 1e-12);
    EXPECT_NEAR(a[1].v.z(), -0.5 * 9.0 / 7 * kG, 1e-12);
  }
}

TEST(TreeDynamics, LongChainsByRecursion) {
  Scene scene = build_scene("chain", {{"n", 300}});
  Tree tree(scene.world);
  EXPECT_EQ(tree.freedoms(), 900);
  expect_equal(tree.recursive(), tree.lagrangian(), 1e-8);
}

/// The velocities of a run change as reduced coordinates say, up to the square of the step.
TEST(TreeDynamics, SimulationsFollowIt) {
  const auto off = [](double h) {
    Scene scene = build_scene("chain", {{"n", 5}});
    scene.settings.position_tolerance = 1e-14;  // which moves accelerations by 1e-14 / h²
    Simulator simulator(scene.world, scene.settings);
    for (int i = 0; i < std::lround(0.2 / h) - 1; ++i) EXPECT_TRUE(simulator.step(h).exact());
    const State before = scene.world.state();
    EXPECT_TRUE(simulator.step(h).exact());
    const std::vector<Twist> a = Tree(scene.world).recursive();
    EXPECT_TRUE(simulator.step(h).exact());
    const State& after = scene.world.state();
    double largest = 0;
    for (int b = 1; b < scene.world.body_count(); ++b)
      largest = std::max(largest, ((after.twists[b].w - before.twists[b].w) / (2 * h) - a[b].w).norm());
    return largest;
  };
  const double coarse = off(2e-4), fine = off(1e-4);
  EXPECT_LE(fine, 1e-3);
  EXPECT_NEAR(coarse / fine, 4, 0.1);
}

/// A ball joint and a rod that close loops, a gear, and a rod to a second body that does not move.
TEST(TreeDynamics, LoopsAsByMultipliers) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    World world = random_tree(seed, 12);
    Random random(100 + seed);
    const BodyId wall = world.add_body({.pose = random.pose(), .fixed = true});
    world.add("", Ball::at(world, BodyId{12}, BodyId{9}, random.vector(2)));
    world.add("", Distance::between(world, BodyId{11}, BodyId{5}, random.vector(2), random.vector(2)));
    world.add("", Distance::between(world, wall, BodyId{10}, random.vector(2), random.vector(2)));
    std::vector<AxisId> angles;
    for (int j = 0; j < world.joint_count(); ++j)
      for (int k = 0; k < world.axis_count({j}); ++k)
        if (world.axis_info({{j}, k}).name == "angle") angles.push_back({{j}, k});
    ASSERT_GE(angles.size(), 2u);
    world.add("", Gear(world, angles[0], angles[1], 1.7));
    expect_as_by_multipliers(world, 1e-7);
  }
}

TEST(TreeDynamics, MultipliersOfWhatIsNoJoint) {
  const World world = random_tree(1, 3);
  const Tree tree(world);
  EXPECT_NO_THROW((void)tree.dynamics.multipliers(JointId{1}));
  EXPECT_THROW((void)tree.dynamics.multipliers(JointId{2}), std::invalid_argument);
  EXPECT_THROW((void)tree.dynamics.multipliers(JointId{}), std::invalid_argument);
}

/// Two hinges of one door are one joint, of which five rows say nothing new.
TEST(TreeDynamics, SeveralJointsOfTwoBodiesAreOne) {
  World world, single;
  for (World* its : {&world, &single}) {
    const BodyId door = its->add_body(
        {.mass = MassProperties(8, Vec3(1, 0.4, 0.7)), .pose = {.p = Vec3(0.5, 0.2, 0)}, .twist = {}});
    its->add("low", Hinge::at(*its, kGround, door, Vec3(0, 0, -1), Vec3(0.1, 0, 1).normalized()));
  }
  world.add("high", Hinge::at(world, kGround, BodyId{1}, Vec3(0.1, 0, 0), Vec3(0.1, 0, 1).normalized()));
  Tree both(world), one(single);
  EXPECT_EQ(both.freedoms(), 1);
  expect_equal(both.recursive(), one.recursive(), 1e-12);
}

}  // namespace
}  // namespace taut::tree_dynamics_test
