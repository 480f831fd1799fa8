#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <string>

namespace taut {

/// P A Q = L U of a sparse square matrix by Eigen's SparseLU, which is compiled here alone.
class SparseLu {
 public:
  using Columns = Eigen::SparseMatrix<double>;

  SparseLu();
  ~SparseLu();

  /// False if A is singular, with the reason in `error`; nothing may be solved then.
  [[nodiscard]] bool factorize(const Columns& A);
  const std::string& error() const { return error_; }
  /// A⁻¹ B
  Eigen::VectorXd solve(const Eigen::VectorXd& B) const;
  Columns solve(const Columns& B) const;

 private:
  struct Factor;
  std::unique_ptr<Factor> factor_;
  std::string error_;
};

}  // namespace taut
