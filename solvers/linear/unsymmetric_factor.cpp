#include "solvers/linear/unsymmetric_factor.h"

#include "solvers/linear/sparse_lu.h"

namespace taut {

struct UnsymmetricFactor::Parts {
  Eigen::SparseMatrix<double> matrix;
  SparseLu factor;
};

UnsymmetricFactor::UnsymmetricFactor() : parts_(std::make_unique<Parts>()) {}
UnsymmetricFactor::~UnsymmetricFactor() = default;

bool UnsymmetricFactor::factorize(const RowMatrix& A) {
  using RowMajor = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  if (A.size() == 0) return false;
  parts_->matrix = Eigen::Map<const RowMajor>(A.size(), A.size(), static_cast<Eigen::Index>(A.values.size()),
                                              A.row_start.data(), A.column.data(), A.values.data());
  return parts_->factor.factorize(parts_->matrix);
}

bool UnsymmetricFactor::solve(std::span<const double> b, std::span<double> x) const {
  const Eigen::Map<const Eigen::VectorXd> right(b.data(), static_cast<Eigen::Index>(b.size()));
  Eigen::Map<Eigen::VectorXd> solution(x.data(), static_cast<Eigen::Index>(x.size()));
  solution = parts_->factor.solve(right);
  const Eigen::VectorXd left = right - parts_->matrix * solution;
  solution += parts_->factor.solve(left);
  return solution.allFinite();
}

}  // namespace taut
