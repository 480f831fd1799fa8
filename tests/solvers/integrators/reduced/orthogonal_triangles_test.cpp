#include "solvers/integrators/reduced/orthogonal_triangles.h"

#include <gtest/gtest.h>

#include <random>

namespace taut::orthogonal_triangles_test {
namespace {

SixColumns random_columns(int count, std::mt19937& random) {
  std::normal_distribution<double> number;
  SixColumns columns(6, count);
  for (double& value : columns.reshaped()) value = number(random);
  return columns;
}

TEST(OrthogonalTriangles, InvertRowsAndLeaveWhatTheyDoNotHold) {
  std::mt19937 random(7);
  for (int m = 1; m <= 6; ++m)
    for (int trial = 0; trial < 20; ++trial) {
      const SixColumns J = random_columns(m, random);
      Eigen::Matrix<double, 6, Eigen::Dynamic> inverse;
      SixColumns N;
      ASSERT_TRUE(invert_rows(J, inverse, &N));
      const double size = inverse.norm() * J.norm();  // at least the condition of J
      EXPECT_LE((J.transpose() * inverse - Eigen::MatrixXd::Identity(m, m)).norm(), 1e-14 * size);
      ASSERT_EQ(N.cols(), 6 - m);
      EXPECT_LE((J.transpose() * N).norm(), 1e-14 * J.norm());
      EXPECT_LE((N.transpose() * N - Eigen::MatrixXd::Identity(6 - m, 6 - m)).norm(), 1e-14);
      // Of all inverses that one whose columns are combinations of the rows.
      EXPECT_LE((N.transpose() * inverse).norm(), 1e-14 * inverse.norm());
    }
}

TEST(OrthogonalTriangles, RefuseRowsThatDependOnEachOther) {
  std::mt19937 random(8);
  for (int m = 2; m <= 6; ++m) {
    SixColumns J = random_columns(m, random);
    J.col(m - 1) = 2 * J.col(0) - 3 * J.col((m - 1) / 2);
    Eigen::Matrix<double, 6, Eigen::Dynamic> inverse = Eigen::Matrix<double, 6, Eigen::Dynamic>::Ones(6, 1);
    EXPECT_FALSE(invert_rows(J, inverse, nullptr)) << m;
    EXPECT_EQ(inverse.sum(), 6);
  }
}

}  // namespace
}  // namespace taut::orthogonal_triangles_test
