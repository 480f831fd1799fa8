#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>
#include <string>
#include <vector>

#include "solvers/linear/front_kernels.h"

namespace taut::block_products_test {
namespace {

using Mat3 = Eigen::Matrix3d;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;

constexpr int kMostRows = 13;  // more than three strips of four
constexpr double kUntouched = 7;
constexpr double kRoundOff = 1e-15;

class BlockProductsTest : public ::testing::TestWithParam<const FrontKernels*> {
 protected:
  void SetUp() override {
    if (GetParam() == nullptr) GTEST_SKIP() << "this processor runs the portable kernels only";
  }
  const FrontKernels& kernels() const { return *GetParam(); }

  RowMatrix random_rows(int rows) {
    return RowMatrix::NullaryExpr(rows, 6, [&] { return value_(random_); });
  }
  Mat3 random_block() {
    return Mat3::NullaryExpr([&] { return value_(random_); });
  }

  // Exactly as long as the kernel may write.
  std::vector<double> by_columns(const RowMatrix& J, const Mat3* A, const Mat3* T, double t) const {
    std::vector<double> W(6 * side_height(static_cast<int>(J.rows())));
    kernels().weigh(J.data(), static_cast<int>(J.rows()), A ? A->data() : nullptr, T ? T->data() : nullptr, t,
                    W.data());
    return W;
  }

  std::mt19937 random_{17};
  std::uniform_real_distribution<double> value_{-1, 1};
};

Eigen::Matrix<double, 6, 6> root_of(const Mat3& A, const Mat3& T) {
  Eigen::Matrix<double, 6, 6> root = Eigen::Matrix<double, 6, 6>::Zero();
  root.topLeftCorner<3, 3>() = A;
  root.bottomRightCorner<3, 3>() = T;
  return root;
}

TEST_P(BlockProductsTest, weigh_is_the_product_with_the_root) {
  for (int rows = 1; rows <= kMostRows; ++rows) {
    const RowMatrix J = random_rows(rows);
    const Mat3 A = random_block(), T = random_block();
    const double t = value_(random_);
    for (const bool full : {false, true}) {
      const RowMatrix expected = J * root_of(A, full ? T : Mat3(t * Mat3::Identity()));
      const std::vector<double> columns = by_columns(J, &A, full ? &T : nullptr, t);
      RowMatrix W(rows, 6);
      kernels().weigh_rows(J.data(), rows, A.data(), full ? T.data() : nullptr, t, W.data());
      EXPECT_LT((W - expected).cwiseAbs().maxCoeff(), 3 * kRoundOff) << rows;
      for (int i = 0; i < side_height(rows); ++i)
        for (int k = 0; k < 6; ++k)
          EXPECT_NEAR(columns[i + k * side_height(rows)], expected(std::min(i, rows - 1), k), 3 * kRoundOff);
    }
  }
}

TEST_P(BlockProductsTest, an_arm_is_weighed_like_its_block) {
  const Mat3 A = random_block(), T = random_block();
  const Eigen::Vector3d r = random_block().col(0);
  const double t = value_(random_);
  for (const double sign : {1.0, -1.0}) {
    RowMatrix J(3, 6);
    J << 0, r[2], -r[1], 1, 0, 0, -r[2], 0, r[0], 0, 1, 0, r[1], -r[0], 0, 0, 0, 1;
    J *= sign;
    for (const Mat3* full : {static_cast<const Mat3*>(nullptr), &T}) {
      std::vector<double> W(6 * side_height(3));
      const double* translation = full ? full->data() : nullptr;
      kernels().weigh_arm(r.data(), sign, A.data(), translation, t, W.data());
      EXPECT_EQ(W, by_columns(J, &A, full, t));
      RowMatrix rows(3, 6), expected(3, 6);
      kernels().weigh_arm_rows(r.data(), sign, A.data(), translation, t, rows.data());
      kernels().weigh_rows(J.data(), 3, A.data(), translation, t, expected.data());
      EXPECT_EQ(rows, expected);
    }
  }
}

TEST_P(BlockProductsTest, without_a_root_the_columns_are_those_of_j) {
  for (int rows = 1; rows <= kMostRows; ++rows) {
    const RowMatrix J = random_rows(rows);
    const std::vector<double> columns = by_columns(J, nullptr, nullptr, 1);
    for (int i = 0; i < rows; ++i)
      for (int k = 0; k < 6; ++k) EXPECT_EQ(columns[i + k * side_height(rows)], J(i, k));
  }
}

TEST_P(BlockProductsTest, products_of_all_sizes_overwrite_or_add_and_leave_the_rest_alone) {
  for (int rows = 1; rows <= kMostRows; ++rows) {
    for (int columns = 1; columns <= kMostRows; ++columns) {
      const RowMatrix J_i = random_rows(rows), J_j = random_rows(columns);
      const std::vector<double> W_i = by_columns(J_i, nullptr, nullptr, 1);
      const std::vector<double> W_j = by_columns(J_j, nullptr, nullptr, 1);
      const Eigen::MatrixXd expected = J_i * J_j.transpose();
      const int stride = rows + 2;
      for (const bool overwrite : {true, false}) {
        Eigen::MatrixXd C = Eigen::MatrixXd::Constant(stride, columns, kUntouched);
        kernels().multiply_sides(W_i.data(), rows, W_j.data(), columns, C.data(), stride, overwrite);
        const Eigen::MatrixXd made = C.topRows(rows).array() - (overwrite ? 0 : kUntouched);
        EXPECT_LT((made - expected).cwiseAbs().maxCoeff(), 20 * kRoundOff) << rows << " × " << columns;
        EXPECT_TRUE((C.bottomRows(2).array() == kUntouched).all()) << rows << " × " << columns;
      }
    }
  }
}

const FrontKernels* fast_kernels() {
  const FrontKernels& kernels = front_kernels();
  return &kernels == &portable_front_kernels() ? nullptr : &kernels;
}

INSTANTIATE_TEST_SUITE_P(Kernels, BlockProductsTest,
                         ::testing::Values(&portable_front_kernels(), fast_kernels()),
                         [](const auto& test) { return std::string(test.index == 0 ? "Portable" : "Fast"); });

}  // namespace
}  // namespace taut::block_products_test
