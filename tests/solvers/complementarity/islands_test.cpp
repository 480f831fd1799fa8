#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "core/state/same_state.h"
#include "core/world/diagnostics.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/complementarity/law_problems.h"

// Islands: what nothing connects is solved by itself.
namespace taut::islands_test {
namespace {

constexpr double kStep = 1.0 / 240;
const Vec3 kBrick(0.4, 0.2, 0.2);

World with_floor() {
  World world;
  world.add_shape(kGround, HalfSpace{});
  return world;
}

/// n rows of n bricks on a floor, each moving a little at random if `speed` is not 0.
void add_wall(World& world, int n, const Vec3& at, double speed, unsigned seed) {
  std::mt19937 random(seed);
  for (int row = 0; row < n; ++row)
    for (int k = 0; k < n; ++k) {
      const Vec3 p = at + Vec3(kBrick.x() * (k + 0.5 * (row % 2)), 0, kBrick.z() * (row + 0.5));
      const BodyId brick =
          world.add_body({.mass = MassProperties::box(kBrick, 20),
                          .pose = {Quat::Identity(), p},
                          .twist = {Vec3::Zero(), speed * law_problems::random_vector(random)}});
      world.add_shape(brick, Box{kBrick}, {}, {.static_friction = 0.5, .dynamic_friction = 0.4});
    }
}

struct Course {
  State state;
  int analyses_at_the_end = 0;
  double residual = 0, gap = 0;
};

Course course(World& world, int steps, int threads = 0) {
  Settings settings;
  settings.threads = threads;
  Simulator simulator(world, settings);
  Course course;
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulator.step(kStep);
    EXPECT_TRUE(report.exact()) << "step " << i << ": " << report.message;
    course.analyses_at_the_end = report.counts.analyses;
    course.residual = std::max(course.residual, report.complementarity_residual);
    course.gap = std::max({course.gap, report.gap.metres, report.gap.radians});
  }
  course.state = world.state();
  return course;
}

/// S of some rows alone is the block of those rows in S.
TEST(Islands, a_part_of_a_system_is_its_block) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const World world = law_problems::random_world(8, 12, 0.1, random);
    ConstraintSystem whole = law_problems::system_of(world);
    SystemPart part;
    for (int j = 0; j < world.joint_count(); ++j) {
      if (law_problems::integer(random, 0, 1) == 0) continue;
      part.joints.push_back(j);
      const Rows::JointRows& joint = whole.rows().joints()[j];
      for (int r = 0; r < joint.row_count; ++r) part.rows.push_back(joint.first_row + r);
      for (BodyId body : world.joint(JointId{j}).bodies()) part.bodies.push_back(body.index);
    }
    if (part.rows.empty()) continue;
    std::sort(part.bodies.begin(), part.bodies.end());
    part.bodies.erase(std::unique(part.bodies.begin(), part.bodies.end()), part.bodies.end());
    std::vector<int> scratch;
    ConstraintSystem alone(whole, part, scratch);
    alone.take_values(whole, part);
    const int n = static_cast<int>(part.rows.size());
    ASSERT_EQ(alone.row_count(), n);
    const Eigen::MatrixXd S = law_problems::dense_system(world)(part.rows, part.rows);
    const Eigen::VectorXd x = Eigen::VectorXd::Random(n);
    Eigen::VectorXd y(n), inertia(n);
    alone.multiply({x.data(), x.data() + n}, {y.data(), y.data() + n});
    alone.effective_masses({inertia.data(), inertia.data() + n});
    EXPECT_LE((y - S * x).norm(), 1e-12 * S.norm() * x.norm());
    EXPECT_LE((inertia.cwiseProduct(S.diagonal()) - Eigen::VectorXd::Ones(n)).norm(), 1e-12);

    // (1 + Wᵀ D W) v = f has v = f − Wᵀ (D⁻¹ + S)⁻¹ W f.
    std::vector<double> v(6 * part.bodies.size()), weights(n);
    for (double& weight : weights) weight = law_problems::uniform(random, 0.1, 10);
    for (double& value : v) value = law_problems::uniform(random, -1, 1);
    for (std::size_t b = 0; b < part.bodies.size(); ++b)
      if (alone.mass()[b].fixed) std::fill_n(v.begin() + 6 * b, 6, 0.0);
    Eigen::VectorXd Wf(n);
    alone.apply_W(v, {Wf.data(), Wf.data() + n});
    Eigen::MatrixXd A = S;
    for (int r = 0; r < n; ++r) A(r, r) += 1 / weights[r];
    const Eigen::VectorXd change = A.ldlt().solve(Wf);
    std::vector<double> expected(v.size());
    alone.apply_Wt({change.data(), change.data() + n}, expected);
    for (std::size_t i = 0; i < v.size(); ++i) expected[i] = v[i] - expected[i];
    StageTimes times;
    ASSERT_TRUE(alone.factorize_bodies(alone.weighted(), weights, times));
    alone.solve_bodies(v);
    for (std::size_t i = 0; i < v.size(); ++i) EXPECT_NEAR(v[i], expected[i], 1e-9);
  }
}

TEST(Islands, move_as_they_do_alone) {
  constexpr int kWalls = 3, kRows = 5, kSteps = 40;
  World all = with_floor();
  for (int i = 0; i < kWalls; ++i) add_wall(all, kRows, {0, 20.0 * i, 0}, 0.01, 1 + i);
  const Course together = course(all, kSteps);
  for (int i = 0; i < kWalls; ++i) {
    World one = with_floor();
    add_wall(one, kRows, {0, 20.0 * i, 0}, 0.01, 1 + i);
    const Course alone = course(one, kSteps);
    const int bricks = one.moving_body_count();
    for (int b = 0; b < bricks; ++b) {
      const Pose &X = alone.state.poses[1 + b], &Y = together.state.poses[1 + i * bricks + b];
      EXPECT_LE((X.p - Y.p).norm(), 1e-8) << "wall " << i << " brick " << b;
      EXPECT_LE((X.q.coeffs() - Y.q.coeffs()).norm(), 1e-8) << "wall " << i << " brick " << b;
    }
  }
}

TEST(Islands, have_the_same_bits_with_any_number_of_threads) {
  State first;
  for (const int threads : {1, 2, 5}) {
    World world = with_floor();
    for (int i = 0; i < 6; ++i) add_wall(world, 3 + i % 3, {0, 3.0 * i, 0}, 0.02, i);
    const Course now = course(world, 30, threads);
    EXPECT_LE(now.residual, 1e-8);
    if (threads == 1) first = now.state;
    EXPECT_TRUE(same(first, now.state)) << threads << " threads";
  }
}

/// Two lattices of boxes without friction meet in free space: two islands, then one.
TEST(Islands, that_meet_are_one_and_momenta_stay) {
  World world;
  world.set_gravity(Vec3::Zero());
  constexpr double kSide = 0.2, kPitch = 0.201;
  for (const double side : {-1, 1})
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < 2; ++k) {
          const Vec3 p(side * (0.45 + kPitch * i), kPitch * j + 0.03 * side, kPitch * k);
          const BodyId box = world.add_body({.mass = MassProperties::box(Vec3::Constant(kSide), 1 + i),
                                             .pose = {Quat::Identity(), p},
                                             .twist = {Vec3::Zero(), Vec3(-side, 0, 0)}});
          world.add_shape(box, Box{Vec3::Constant(kSide)}, {},
                          {.restitution = 0.3, .static_friction = 0.2, .dynamic_friction = 0.2});
        }
  Simulator simulator(world);
  ASSERT_TRUE(simulator.step(kStep).exact());
  const StepReport start = simulator.report();
  bool met = false;
  for (int i = 0; i < 120; ++i) {
    const double before = simulator.report().kinetic_energy;
    const StepReport& report = simulator.step(kStep);
    ASSERT_TRUE(report.exact()) << report.message;
    EXPECT_LE(report.complementarity_residual, 1e-8);
    EXPECT_LE((report.linear_momentum - start.linear_momentum).norm(), 1e-9);
    EXPECT_LE((report.angular_momentum - start.angular_momentum).norm(), 1e-9);
    EXPECT_LE(report.kinetic_energy, before + 1e-9);
    met = met || report.kinetic_energy < 0.8 * start.kinetic_energy;
  }
  EXPECT_TRUE(met);
}

/// Forty pairs of boxes with a hinge fall on a floor: islands of joints, contacts and friction.
TEST(Islands, of_mechanisms_keep_their_joints_closed) {
  World world = with_floor();
  std::mt19937 random(5);
  const Vec3 box(0.3, 0.2, 0.1);
  for (int i = 0; i < 40; ++i) {
    const Vec3 at(1.5 * (i % 8), 1.5 * (i / 8), 0.3);
    BodyId bodies[2];
    for (int side : {0, 1}) {
      bodies[side] = world.add_body({.mass = MassProperties::box(box, 2),
                                     .pose = {Quat::Identity(), at + Vec3(0.35 * side, 0, 0)},
                                     .twist = {0.5 * law_problems::random_vector(random), Vec3::Zero()}});
      world.add_shape(bodies[side], Box{box}, {}, {.static_friction = 0.6, .dynamic_friction = 0.5});
    }
    const Vec3 axis = (Vec3::UnitY() + 0.2 * law_problems::random_vector(random)).normalized();
    world.add("", Hinge::at(world, bodies[0], bodies[1], at + Vec3(0.175, 0, 0), axis));
    State state = world.state();  // both turn about the hinge's axis only
    state.twists[bodies[1].index] = state.twists[bodies[0].index];
    state.twists[bodies[1].index].v += state.twists[bodies[0].index].w.cross(Vec3(0.35, 0, 0));
    world.set_state(state);
  }
  const Course now = course(world, 360);
  EXPECT_LE(now.gap, 1e-9);
  EXPECT_LE(now.residual, 1e-8);
  EXPECT_EQ(now.analyses_at_the_end, 0);  // at rest
}

}  // namespace
}  // namespace taut::islands_test
