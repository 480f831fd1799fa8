#include "core/constraints/rows.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/constraints/row_products.h"
#include "core/joints/joints.h"
#include "tests/core/random_state.h"

namespace taut::rows_test {
namespace {

using testing::Random;

/// Ground – a – b – c with a loop back to the ground and joints of all widths.
struct Linkage {
  Random random{51};
  World world;
  BodyId a, b, c;

  Linkage() {
    a = world.add_body({.pose = random.pose(), .twist = random.twist()});
    b = world.add_body({.pose = random.pose(), .twist = random.twist()});
    c = world.add_body({.pose = random.pose(), .twist = random.twist()});
    world.add("first", Hinge::at(world, kGround, a, random.vector(), random.unit()));
    world.add("second", Distance::between(world, a, b, random.vector(), random.vector()));
    world.add("third", Slider::at(world, c, b, random.vector(), random.unit()));
    world.add("fourth", Ball::at(world, c, kGround, random.vector()));
  }
};

TEST(Rows, JointsAndSidesTileTheArrays) {
  const Linkage s;
  const Rows rows(s.world);
  EXPECT_EQ(rows.row_count(), 5 + 1 + 5 + 3);
  EXPECT_EQ(rows.jacobian_size(), 2 * 6 * rows.row_count());
  int next_row = 0, next_value = 0;
  for (int j = 0; j < s.world.joint_count(); ++j) {
    const Rows::JointRows& joint = rows.joints()[j];
    EXPECT_EQ(joint.first_row, next_row);
    next_row += joint.row_count;
    const int expected_body[] = {s.world.joint(JointId{j}).a().index, s.world.joint(JointId{j}).b().index};
    ASSERT_EQ(joint.side_count, 2);
    for (int i : {0, 1}) {
      const Rows::Side& side = rows.sides()[joint.first_side + i];
      EXPECT_EQ(side.block, j);
      EXPECT_EQ(side.body, expected_body[i]);
      EXPECT_EQ(side.first_row, joint.first_row);
      EXPECT_EQ(side.row_count, joint.row_count);
      EXPECT_EQ(side.offset, next_value);
      next_value += 6 * side.row_count;
    }
    for (int r = joint.first_row; r < next_row; ++r) EXPECT_EQ(rows.joint_of(r), JointId{j});
  }
  EXPECT_EQ(next_row, rows.row_count());
  EXPECT_EQ(next_value, rows.jacobian_size());
}

TEST(Rows, EachBodyKnowsItsSidesInTheOrderOfTheJoints) {
  const Linkage s;
  const Rows rows(s.world);
  ASSERT_EQ(rows.body_count(), s.world.body_count());
  std::size_t sides = 0;
  for (int body = 0; body < rows.body_count(); ++body) {
    int last_joint = -1;
    for (int side : rows.sides_of(body)) {
      EXPECT_EQ(rows.sides()[side].body, body);
      EXPECT_GT(rows.sides()[side].block, last_joint);
      last_joint = rows.sides()[side].block;
      ++sides;
    }
  }
  EXPECT_EQ(sides, rows.sides().size());
}

/// J V and Jᵀλ against the dense matrix.
TEST(Rows, ProductsAreThoseOfTheDenseJacobian) {
  Linkage s;
  const Rows rows(s.world);
  const int n = rows.row_count(), bodies = rows.body_count();
  std::vector<double> values(rows.jacobian_size());
  rows.jacobian(s.world.state().poses, values);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, 6 * bodies);
  for (const Rows::Side& side : rows.sides())
    for (int i = 0; i < side.row_count; ++i)
      for (int k = 0; k < 6; ++k) J(side.first_row + i, 6 * side.body + k) = values[side.offset + 6 * i + k];

  Eigen::VectorXd V(6 * bodies);
  for (int body = 0; body < bodies; ++body)
    V.segment<6>(6 * body) << s.world.twist(BodyId{body}).w, s.world.twist(BodyId{body}).v;
  std::vector<double> JV(n, 99);  // must be overwritten
  rows.apply(values, s.world.state().twists, JV);
  EXPECT_LT((Eigen::Map<Eigen::VectorXd>(JV.data(), n) - J * V).norm(), 1e-13);

  const std::vector<double> lambda = s.random.multipliers(n);
  const Eigen::VectorXd expected = J.transpose() * Eigen::Map<const Eigen::VectorXd>(lambda.data(), n);
  std::vector<Wrench> wrenches(bodies, {Vec3(9, 9, 9), Vec3(9, 9, 9)});  // must be overwritten
  rows.apply_transpose(values, lambda, wrenches);
  for (int body = 0; body < bodies; ++body) {
    EXPECT_LT((wrenches[body].torque - expected.segment<3>(6 * body)).norm(), 1e-13);
    EXPECT_LT((wrenches[body].force - expected.segment<3>(6 * body + 3)).norm(), 1e-13);
  }
}

TEST(Rows, ArmsStandForTheBlocksOfBallJoints) {
  Linkage s;
  const JointId soft = s.world.add("soft", Ball::at(s.world, s.a, s.c, s.random.vector()));
  s.world.set_compliance(soft, JointCompliance{.translation = 1e-6});
  const Rows whole(s.world), arms(s.world, Rows::AxisRows::kIncluded, {}, Rows::Joints::kAll,
                                  Springs::kLeftOut, Rows::Blocks::kLeverArms);
  ASSERT_EQ(arms.whole_size(), whole.jacobian_size());
  EXPECT_EQ(arms.jacobian_size(), whole.jacobian_size() - 2 * 15);  // "fourth" alone
  std::vector<double> J(whole.jacobian_size()), r(arms.jacobian_size());
  whole.jacobian(s.world.state(), J);
  arms.jacobian(s.world.state(), r);
  for (std::size_t i = 0; i < whole.sides().size(); ++i) {
    EXPECT_EQ(arms.sides()[i].whole, whole.sides()[i].offset);
    for (int row = 0; row < whole.sides()[i].row_count; ++row)
      EXPECT_EQ(Rows::block_row(arms.sides()[i], r, row), Rows::block_row(whole.sides()[i], J, row));
  }
  const int n = whole.row_count(), bodies = whole.body_count();
  const std::vector<double> lambda = s.random.multipliers(n);
  std::vector<double> rates(n), rates_of_arms(n, 99);
  whole.apply(J, s.world.state().twists, rates);
  arms.apply(r, s.world.state().twists, rates_of_arms);
  EXPECT_EQ(rates, rates_of_arms);
  for (int body = 0; body < bodies; ++body) {
    const Wrench expected = detail::wrench_on(whole, body, J, lambda),
                 wrench = detail::wrench_on(arms, body, r, lambda);
    EXPECT_EQ(wrench.torque, expected.torque);
    EXPECT_EQ(wrench.force, expected.force);
  }
}

/// Joints of several kinds in no order, and chunks that have to wait for each other.
TEST(Rows, PiecesMakeTheSameAndSettledBodiesHaveAllOfIt) {
  Random random(52);
  World world;
  const int bodies = 3 * Rows::kChunkSize;
  for (int b = 1; b < bodies; ++b) world.add_body({.pose = random.pose()});
  for (int j = 0; j < bodies; ++j) {
    const int a = static_cast<int>(random.uniform(0, bodies - 1));
    const int reach = j % 7 == 0 ? bodies - 1 - a : std::min(20, bodies - 1 - a);
    const BodyId from{a}, to{a + 1 + static_cast<int>(random.uniform(0, reach - 0.5))};
    if (j % 2 == 0)
      world.add("", Ball::at(world, from, to, random.vector()));
    else
      world.add("", Hinge::at(world, to, from, random.vector(), random.unit()));
  }
  const Rows rows(world);
  const State& state = world.state();
  constexpr double kUnwritten = 1e9;
  std::vector<double> J(rows.jacobian_size()), phi(rows.row_count());
  std::vector<double> J_pieces(J.size(), kUnwritten), phi_pieces(phi.size(), kUnwritten);
  const std::vector<double> lambda = random.multipliers(rows.row_count());
  std::vector<StiffnessBlocks> K(bodies), K_pieces(bodies);
  rows.jacobian(state, J);
  rows.residual(state, phi);
  rows.stiffness(state, lambda, K);
  int begin = 0, settled = 0;
  for (const Rows::BodyChunk& chunk : rows.chunks()) {
    EXPECT_EQ(chunk.begin, begin);
    EXPECT_EQ(chunk.settled_begin, settled);
    begin = chunk.end, settled = chunk.settled_end;
    ASSERT_LE(settled, begin);
    // Nothing of later bodies is read.
    State known = state;
    for (int b = chunk.end; b < bodies; ++b) known.poses[b].p.setConstant(std::nan(""));
    rows.jacobian(known, J_pieces, chunk);
    rows.residual(known, phi_pieces, chunk);
    rows.stiffness(known, lambda, K_pieces, chunk);
    for (int b = 0; b < settled; ++b) {
      for (int s : rows.sides_of(b)) {
        const Rows::Side& side = rows.sides()[s];
        for (int i = side.offset; i < side.offset + 6 * side.row_count; ++i) ASSERT_EQ(J_pieces[i], J[i]);
      }
      const double size = K[b].rotation.norm();
      EXPECT_LE((K_pieces[b].rotation - K[b].rotation).norm(), 1e-13 * size);
    }
  }
  EXPECT_EQ(begin, bodies);
  EXPECT_EQ(settled, bodies);
  EXPECT_EQ(J_pieces, J);
  EXPECT_EQ(phi_pieces, phi);
}

TEST(Rows, OfAnEmptyWorldAreNone) {
  const Rows rows{World()};
  EXPECT_EQ(rows.row_count(), 0);
  EXPECT_EQ(rows.body_count(), 1);
  EXPECT_TRUE(rows.sides_of(0).empty());
}

}  // namespace
}  // namespace taut::rows_test
