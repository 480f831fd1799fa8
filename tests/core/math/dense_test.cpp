#include "core/math/dense.h"

#include <gtest/gtest.h>

#include "tests/core/random_state.h"

namespace taut::dense_test {

using dense::Matrix;
using dense::Vector;

Matrix random_matrix(int rows, int columns, unsigned seed) {
  testing::Random random(seed);
  Matrix A(rows, columns);
  for (double& a : A.reshaped()) a = random.uniform(-1, 1);
  return A;
}

TEST(Dense, EigenpairsSolveTheirEquation) {
  for (const int n : {1, 2, 3, 7, 20}) {
    const Matrix B = random_matrix(n, n, 1), A = B + B.transpose();
    const auto [values, vectors] = dense::symmetric_eigenpairs(A);
    EXPECT_LE((A * vectors - vectors * values.asDiagonal()).norm(), 1e-13 * n) << n;
    EXPECT_LE((vectors.transpose() * vectors - Matrix::Identity(n, n)).norm(), 1e-13 * n) << n;
    for (int i = 1; i < n; ++i) EXPECT_LE(values[i - 1], values[i]);
  }
}

TEST(Dense, EigenpairsOfThreeRowsAreThoseOfAnySize) {
  const Mat3 B = random_matrix(3, 3, 2), A = B + B.transpose();
  const auto [values, vectors] = dense::symmetric_eigenpairs3(A);
  EXPECT_LE((A * vectors - vectors * values.asDiagonal()).norm(), 1e-14);
  EXPECT_LE((values - dense::symmetric_eigenpairs(A).values).norm(), 1e-14);
  EXPECT_LE((values - dense::symmetric_eigenvalues3(A)).norm(), 1e-14);
}

TEST(Dense, GeneralizedEigenpairsSolveTheirEquation) {
  const int n = 9;
  const Matrix B = random_matrix(n, n, 3), C = random_matrix(n, n, 4);
  const Matrix K = B + B.transpose(), M = C * C.transpose() + Matrix::Identity(n, n);
  const auto [values, vectors] = dense::generalized_eigenpairs(K, M);
  EXPECT_LE((K * vectors - M * vectors * values.asDiagonal()).norm(), 1e-12);
  EXPECT_LE((vectors.transpose() * M * vectors - Matrix::Identity(n, n)).norm(), 1e-12);
}

/// Of wide, tall and square matrices of every rank.
TEST(Dense, SingularValuesGiveRankAndWhatIsMappedToZero) {
  for (const auto& [rows, columns] : {std::pair{4, 6}, {6, 4}, {5, 5}, {1, 6}})
    for (int rank = 1; rank <= std::min(rows, columns); ++rank) {
      const Matrix A = random_matrix(rows, rank, 5) * random_matrix(rank, columns, 6);
      const dense::SingularValues svd = dense::singular_values(A);
      EXPECT_EQ(svd.rank, rank);
      EXPECT_EQ(svd.V.cols(), columns);
      EXPECT_LE((svd.U * svd.values.asDiagonal() * svd.V.leftCols(svd.values.size()).transpose() - A).norm(),
                1e-13);
      EXPECT_LE((A * svd.V.rightCols(columns - rank)).norm(), 1e-13);
    }
}

/// The four equations of Penrose hold for A⁺ alone.
TEST(Dense, PseudoInverseMeetsItsFourEquations) {
  for (const auto& [rows, columns, rank] : {std::tuple{4, 6, 4}, {6, 4, 3}, {5, 5, 2}, {3, 6, 1}}) {
    const Matrix A = random_matrix(rows, rank, 7) * random_matrix(rank, columns, 8);
    const Matrix P = dense::pseudo_inverse(dense::singular_values(A));
    EXPECT_LE((A * P * A - A).norm(), 1e-12);
    EXPECT_LE((P * A * P - P).norm(), 1e-12 * P.norm());
    EXPECT_LE((A * P - (A * P).transpose()).norm(), 1e-12);
    EXPECT_LE((P * A - (P * A).transpose()).norm(), 1e-12);
  }
}

TEST(Dense, SystemsAreSolved) {
  const Matrix A = random_matrix(8, 8, 9), B = random_matrix(8, 3, 10);
  EXPECT_LE((A * dense::solve(A, B) - B).norm(), 1e-12);
  const Matrix positive = dense::product(A, A.transpose()) + Matrix::Identity(8, 8);
  const Vector b = B.col(0);
  const Mat3 small = positive.topLeftCorner<3, 3>();
  const Vec3 right = b.head<3>();
  EXPECT_LE((small * dense::solve_symmetric3(small, right) - right).norm(), 1e-13);
}

}  // namespace taut::dense_test
