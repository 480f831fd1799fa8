#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/linear/factor.h"

namespace taut {

/// L Lᵀ of the whole matrix, zeros and all: 8 n² bytes and n³/3 multiplications, however sparse it is.  What
/// methods without sparsity pay, to compare with.
class DenseFactor final : public Factor {
 public:
  SymmetricMatrix::Triangle triangle() const override { return SymmetricMatrix::Triangle::kLower; }
  void analyze(const SymmetricMatrix& A) override;
  [[nodiscard]] int factorize(const SymmetricMatrix& A) override;
  void solve(std::span<double> x) override;
  std::span<const double> relative_pivots() const override { return relative_pivots_; }
  std::string name() const override;
  double flops() const override;
  std::int64_t nonzeros() const override;

 private:
  int factorize_diagonal(int first, int count);

  Eigen::MatrixXd L_;  // its lower triangle
  std::vector<double> relative_pivots_;
};

}  // namespace taut
