#include "solvers/linear/dense_factor.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/base/interruption.h"

namespace taut {
namespace {

/// Columns that are eliminated before the rest is updated: so many that the update is a product of matrices.
constexpr int kDenseColumns = 64;

}  // namespace

void DenseFactor::analyze(const SymmetricMatrix& A) {
  L_.resize(A.size(), A.size());
  relative_pivots_.assign(A.size(), 0.0);
}

int DenseFactor::factorize(const SymmetricMatrix& A) {
  const int n = A.size();
  L_.setZero();
  for (int c = 0; c < n; ++c)
    for (int t = A.column_start[c]; t < A.column_start[c + 1]; ++t)
      if (A.row_index[t] >= c) L_(A.row_index[t], c) = A.values[t];
  for (int c = 0; c < n; ++c) relative_pivots_[c] = L_(c, c);
  for (int k = 0; k < n; k += kDenseColumns) {
    detail::poll_interrupt();
    const int count = std::min(kDenseColumns, n - k), below = n - k - count;
    if (const int failed = factorize_diagonal(k, count); failed >= 0) return failed;
    auto panel = L_.block(k + count, k, below, count);
    L_.block(k, k, count, count)
        .triangularView<Eigen::Lower>()
        .transpose()
        .solveInPlace<Eigen::OnTheRight>(panel);
    L_.bottomRightCorner(below, below).selfadjointView<Eigen::Lower>().rankUpdate(panel, -1);
  }
  for (int c = 0; c < n; ++c) relative_pivots_[c] = L_(c, c) * L_(c, c) / relative_pivots_[c];
  return -1;
}

/// L of a block on the diagonal.  −1, or the first column whose pivot is not positive.
int DenseFactor::factorize_diagonal(int first, int count) {
  auto block = L_.block(first, first, count, count);
  for (int c = 0; c < count; ++c) {
    const double pivot = block(c, c);
    if (!(pivot > 0) || !std::isfinite(pivot)) return first + c;
    const int below = count - c - 1;
    block(c, c) = std::sqrt(pivot);
    auto column = block.col(c).tail(below);
    column /= block(c, c);
    for (int d = 0; d < below; ++d)
      block.col(c + 1 + d).tail(below - d) -= column[d] * column.tail(below - d);
  }
  return -1;
}

void DenseFactor::solve(std::span<double> x) {
  Eigen::Map<Eigen::VectorXd> v(x.data(), static_cast<Eigen::Index>(x.size()));
  L_.triangularView<Eigen::Lower>().solveInPlace(v);
  L_.triangularView<Eigen::Lower>().transpose().solveInPlace(v);
}

std::string DenseFactor::name() const { return "dense L Lᵀ"; }

double DenseFactor::flops() const {
  const double n = static_cast<double>(L_.rows());
  return n * n * n / 3;
}

std::int64_t DenseFactor::nonzeros() const { return std::int64_t{L_.rows()} * (L_.rows() + 1) / 2; }

}  // namespace taut
