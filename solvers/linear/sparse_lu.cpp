#include "solvers/linear/sparse_lu.h"

#include <Eigen/SparseLU>

namespace taut {

struct SparseLu::Factor : Eigen::SparseLU<Columns> {};

SparseLu::SparseLu() : factor_(std::make_unique<Factor>()) {}
SparseLu::~SparseLu() = default;

bool SparseLu::factorize(const Columns& A) {
  factor_->compute(A);
  const bool regular = factor_->info() == Eigen::Success;
  error_ = regular ? "" : factor_->lastErrorMessage();
  return regular;
}

Eigen::VectorXd SparseLu::solve(const Eigen::VectorXd& B) const { return factor_->solve(B); }
SparseLu::Columns SparseLu::solve(const Columns& B) const { return factor_->solve(B); }

}  // namespace taut
