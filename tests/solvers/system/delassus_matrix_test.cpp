#include "solvers/system/delassus_matrix.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "solvers/linear/block_ordering.h"
#include "solvers/system/constraint_system.h"
#include "tests/solvers/complementarity/law_problems.h"

namespace taut::delassus_matrix_test {
namespace {

using namespace law_problems;

constexpr double kRoundOff = 1e-13;

/// A world of law_problems with a hinge, a universal and a fixed joint besides: blocks of 1 to 6 rows.
World mixed_world(std::mt19937& random) {
  World world = random_world(6, 8, 0.2, random);
  world.add("hinge", Hinge::at(world, {0}, {1}, {0.1, 0, 0}, Vec3::UnitY()));
  world.add("universal", Universal::at(world, {1}, {2}, {0, 0.2, 0}, Vec3::UnitX(), Vec3::UnitZ()));
  world.add("fixed", Fixed::at(world, {3}, kGround, {0, 0, 0.3}));
  return world;
}

/// J as one dense matrix, columns by body.
MatrixXd dense_jacobian(const Rows& rows, std::span<const double> J) {
  MatrixXd dense = MatrixXd::Zero(rows.row_count(), 6 * rows.body_count());
  for (const Rows::Side& side : rows.sides())
    for (int i = 0; i < side.row_count; ++i)
      dense.block<1, 6>(side.first_row + i, 6 * side.body) += Rows::block_row(side, J, i).transpose();
  return dense;
}

/// Both triangles, in the order of the joints' rows.
MatrixXd dense_of(const DelassusMatrix& system) {
  const SymmetricMatrix& A = system.matrix();
  const bool lower = A.triangle == SymmetricMatrix::Triangle::kLower;
  MatrixXd ordered = MatrixXd::Zero(A.size(), A.size());
  for (int c = 0; c < A.size(); ++c)
    for (int t = A.column_start[c]; t < A.column_start[c + 1]; ++t)
      if (const int r = A.row_index[t]; lower ? r >= c : r <= c) ordered(r, c) = ordered(c, r) = A.values[t];
  MatrixXd dense(A.size(), A.size());
  const std::span<const int> position = system.position_of_row();
  for (int r = 0; r < A.size(); ++r)
    for (int c = 0; c < A.size(); ++c) dense(r, c) = ordered(position[r], position[c]);
  return dense;
}

struct Assembled {
  World world;
  ConstraintSystem system;
  MatrixXd J, A, A_full;  // A: roots of M⁻¹, one block of six a body
  std::vector<InverseMassRoot> roots;
  std::vector<FullMassRoot> full;

  explicit Assembled(std::mt19937& random) : world(mixed_world(random)), system(system_of(world)) {
    const int bodies = system.rows().body_count();
    J = dense_jacobian(system.rows(), system.jacobian());
    A = A_full = MatrixXd::Zero(6 * bodies, 6 * bodies);
    full.resize(bodies);
    for (int b = 0; b < bodies; ++b) {
      roots.push_back(system.inverse_mass(b));
      if (!roots[b].moves()) continue;
      A.block<3, 3>(6 * b, 6 * b) = roots[b].rotation;
      A.block<3, 3>(6 * b + 3, 6 * b + 3) = roots[b].translation * Mat3::Identity();
      full[b].rotation = Mat3::NullaryExpr([&] { return uniform(random, -1, 1); });
      full[b].translation = Mat3::NullaryExpr([&] { return uniform(random, -1, 1); });
      A_full.block<3, 3>(6 * b, 6 * b) = full[b].rotation;
      A_full.block<3, 3>(6 * b + 3, 6 * b + 3) = full[b].translation;
    }
  }
  DelassusMatrix matrix(SymmetricMatrix::Triangle triangle) const {
    return {system.rows(), system.mass(), order_blocks(joint_graph(system.rows(), system.mass())), triangle};
  }
};

MatrixXd shifted(MatrixXd S, double shift) {
  S.diagonal() *= 1 + shift;
  return S;
}

class DelassusMatrixTest : public ::testing::TestWithParam<SymmetricMatrix::Triangle> {};

TEST_P(DelassusMatrixTest, IsTheDenseProductForBothRootsWithAndWithoutShift) {
  std::mt19937 random(5);
  for (int problem = 0; problem < 20; ++problem) {
    const Assembled at(random);
    DelassusMatrix S = at.matrix(GetParam());
    for (const double shift : {0.0, 0.25}) {
      const MatrixXd plain = shifted(at.J * at.A * at.A.transpose() * at.J.transpose(), shift);
      S.assemble<InverseMassRoot>(at.system.rows(), at.system.jacobian(), at.roots, shift);
      EXPECT_LT((dense_of(S) - plain).cwiseAbs().maxCoeff(), kRoundOff * plain.cwiseAbs().maxCoeff());
      const MatrixXd full = shifted(at.J * at.A_full * at.A_full.transpose() * at.J.transpose(), shift);
      S.assemble<FullMassRoot>(at.system.rows(), at.system.jacobian(), at.full, shift);
      EXPECT_LT((dense_of(S) - full).cwiseAbs().maxCoeff(), kRoundOff * full.cwiseAbs().maxCoeff());
    }
  }
}

TEST_P(DelassusMatrixTest, FromWItIsTheSameWithComplianceBeforeTheShiftAndOneWhereRowsAreMasked) {
  constexpr double kMasked = std::numeric_limits<double>::infinity();
  std::mt19937 random(6);
  for (int problem = 0; problem < 20; ++problem) {
    const Assembled at(random);
    const Rows& rows = at.system.rows();
    DelassusMatrix S = at.matrix(GetParam());
    std::vector<double> W(rows.whole_size()), states(rows.row_count(), 0.0);
    DelassusMatrix::mass_weight<InverseMassRoot>(rows, at.system.jacobian(), at.roots, W);
    MatrixXd dense_W = at.J * at.A;
    for (int r = 0; r < rows.row_count(); ++r) {
      if (r % 3 == 1) states[r] = 2.5;
      if (r % 3 == 2) states[r] = kMasked;
    }
    for (const Rows::Side& side : rows.sides())
      for (int i = 0; i < side.row_count; ++i)
        if (states[side.first_row + i] == kMasked)
          std::fill_n(W.begin() + side.whole + 6 * i, 6, 0.0), dense_W.row(side.first_row + i).setZero();
    MatrixXd expected = dense_W * dense_W.transpose();
    for (int r = 0; r < rows.row_count(); ++r) expected(r, r) += states[r] == kMasked ? 1 : states[r];
    expected = shifted(expected, 0.25);
    S.assemble(rows, W, 0.25, states);
    EXPECT_LT((dense_of(S) - expected).cwiseAbs().maxCoeff(), kRoundOff * expected.cwiseAbs().maxCoeff());
  }
}

/// A chain longer than a chunk, with some joints that reach far ahead.
TEST(ConstraintSystemPieces, linearizing_and_assembling_at_once_makes_the_same_bits) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> value(-1, 1);
  World world;
  constexpr int kBodies = 3 * Rows::kChunkSize;
  for (int b = 1; b <= kBodies; ++b) {
    BodySpec body{.mass = MassProperties::box({0.3, 0.2, 0.1}, 1 + 0.5 * value(random))};
    body.pose.p = Vec3(b, value(random), value(random));
    const BodyId next = world.add_body(body);
    if (b % 3 == 0)
      world.add("", Hinge::at(world, {b - 1}, next, body.pose.p, Vec3::UnitY()));
    else
      world.add("", Ball::at(world, {b - 1}, next, body.pose.p));
  }
  world.add("", Ball::at(world, {3}, {kBodies / 2}, Vec3::UnitZ()));
  world.add("", Ball::at(world, {5}, {kBodies - 2}, Vec3::UnitZ()));
  ConstraintSystem apart(world, FactorChoice::kAuto), at_once(world, FactorChoice::kAuto);
  StageTimes times;
  State state = world.state();
  for (int k = 0; k < 3; ++k) {
    for (Pose& pose : std::span(state.poses).subspan(1)) pose.p += 0.01 * Vec3(value(random), 0, 1);
    apart.linearize(state);
    apart.set_mass(state.poses);
    apart.factorize(times);
    at_once.linearize_and_assemble(state);
    at_once.factorize(times);
    EXPECT_EQ(at_once.matrix().values, apart.matrix().values);
    ASSERT_TRUE(at_once.usable());
    std::vector<double> x(apart.row_count(), 1.0), y = x;
    apart.solve(x);
    at_once.solve(y);
    EXPECT_EQ(x, y);
  }
  // What it made is not taken for S where something else has a part in S.
  for (ConstraintSystem* system : {&apart, &at_once}) system->set_compliance(0.1);
  at_once.linearize_and_assemble(state);
  at_once.factorize(times);
  apart.factorize(times);
  EXPECT_EQ(at_once.matrix().values, apart.matrix().values);
  for (ConstraintSystem* system : {&apart, &at_once}) system->set_compliance(0);
  at_once.linearize_and_assemble(state);
  at_once.change_jacobian()[0] *= 2;
  at_once.factorize(times);
  apart.change_jacobian()[0] *= 2;
  apart.factorize(times);
  EXPECT_EQ(at_once.matrix().values, apart.matrix().values);
}

INSTANTIATE_TEST_SUITE_P(Triangles, DelassusMatrixTest,
                         ::testing::Values(SymmetricMatrix::Triangle::kLower,
                                           SymmetricMatrix::Triangle::kUpper),
                         [](const auto& test) { return test.index == 0 ? "Lower" : "Upper"; });

}  // namespace
}  // namespace taut::delassus_matrix_test
