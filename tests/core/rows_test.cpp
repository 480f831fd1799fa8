#include "core/rows.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/joints.h"
#include "tests/core/random_state.h"

namespace taut {
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
      EXPECT_EQ(side.joint, j);
      EXPECT_EQ(side.body, expected_body[i]);
      EXPECT_EQ(side.first_row, joint.first_row);
      EXPECT_EQ(side.row_count, joint.row_count);
      EXPECT_EQ(side.offset, next_value);
      next_value += 6 * side.row_count;
    }
    for (int r = joint.first_row; r < next_row; ++r) EXPECT_EQ(rows.row(r).joint, j);
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
      EXPECT_GT(rows.sides()[side].joint, last_joint);
      last_joint = rows.sides()[side].joint;
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

TEST(Rows, OfAnEmptyWorldAreNone) {
  const Rows rows{World()};
  EXPECT_EQ(rows.row_count(), 0);
  EXPECT_EQ(rows.body_count(), 1);
  EXPECT_TRUE(rows.sides_of(0).empty());
}

}  // namespace
}  // namespace taut
