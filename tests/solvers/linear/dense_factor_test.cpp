#include "solvers/linear/dense_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <limits>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"

/// The factor without sparsity against Eigen's.
namespace taut::dense_factor_test {
namespace {

/// All entries of the lower triangle, in one block; what lies above the diagonal may not be read.
SymmetricMatrix whole(const Eigen::MatrixXd& D) {
  SymmetricMatrix A;
  A.block_start.push_back(static_cast<int>(D.rows()));
  for (int c = 0; c < D.rows(); ++c) {
    for (int r = 0; r < D.rows(); ++r) {
      A.row_index.push_back(r);
      A.values.push_back(r < c ? std::numeric_limits<double>::quiet_NaN() : D(r, c));
    }
    A.column_start.push_back(static_cast<int>(A.values.size()));
  }
  return A;
}

Eigen::MatrixXd positive(int n) {
  const Eigen::MatrixXd G = Eigen::MatrixXd::Random(n, n);
  return G * G.transpose() + n * Eigen::MatrixXd::Identity(n, n);
}

TEST(DenseFactor, SolvesAndTellsItsPivots) {
  for (int n : {1, 2, 63, 64, 65, 130, 300}) {
    const Eigen::MatrixXd D = positive(n);
    DenseFactor factor;
    const SymmetricMatrix A = whole(D);
    factor.analyze(A);
    for (int times = 0; times < 2; ++times) ASSERT_EQ(factor.factorize(A), -1);
    Eigen::VectorXd x = Eigen::VectorXd::Random(n);
    const Eigen::VectorXd b = x;
    factor.solve({x.data(), static_cast<std::size_t>(n)});
    EXPECT_LT((D * x - b).norm(), 1e-12 * b.norm()) << n;
    const Eigen::MatrixXd L = D.llt().matrixL();
    for (int i = 0; i < n; ++i)
      EXPECT_NEAR(factor.relative_pivots()[i], L(i, i) * L(i, i) / D(i, i), 1e-12) << n << ' ' << i;
    EXPECT_EQ(factor.nonzeros(), n * (n + 1) / 2);
  }
}

TEST(DenseFactor, NamesTheFirstColumnThatFails) {
  for (int wrong : {0, 5, 63, 64, 129}) {
    Eigen::MatrixXd D = positive(130);
    D(wrong, wrong) = -1;
    DenseFactor factor;
    SymmetricMatrix A = whole(D);
    factor.analyze(A);
    EXPECT_EQ(factor.factorize(A), wrong);
    D(wrong, wrong) = std::numeric_limits<double>::quiet_NaN();
    A = whole(D);
    EXPECT_EQ(factor.factorize(A), wrong);
  }
}

/// More rows than it takes are refused by name before anything is allocated.
TEST(DenseFactor, RefusesWhatIsTooLarge) {
  World world;
  BodyId last = kGround;
  for (int i = 0; i <= kMostDenseRows / 3; ++i) {
    const BodyId body = world.add_body({.mass = {1, Vec3(1, 1, 1)}, .pose = {.p = Vec3(i + 0.5, 0, 0)}});
    world.add("", Ball::at(world, last, body, Vec3(i, 0, 0)));
    last = body;
  }
  Settings settings;
  settings.factor = FactorChoice::kDense;
  try {
    Simulator simulator(world, settings);
    (void)simulator.step(1e-3);
    FAIL() << "not refused";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("10000 rows"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace taut::dense_factor_test
