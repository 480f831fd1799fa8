#include "solvers/friction/friction_problem.h"

#include "core/base/check.h"
#include "solvers/friction/scaled_friction.h"
#include "solvers/linear/sparse_lu.h"

namespace taut {
namespace {

void require_entries(const char* name, Eigen::Index is, Eigen::Index wanted) {
  if (is != wanted)
    fail(name, std::string("must have ").append(std::to_string(wanted)).append(" entries"), is);
}

void require_matrix(const char* name, const FrictionProblem::Matrix& A, Eigen::Index rows,
                    Eigen::Index columns) {
  if (A.rows() != rows || A.cols() != columns)
    fail(
        name,
        std::string("must be of ").append(std::to_string(rows)).append(" × ").append(std::to_string(columns)),
        std::to_string(A.rows()).append(" × ").append(std::to_string(A.cols())));
  for (int k = 0; k < A.outerSize(); ++k)
    for (FrictionProblem::Matrix::InnerIterator at(A, k); at; ++at) require_finite(name, at.value());
}

void require_friction(const Eigen::VectorXd& mu, int equalities) {
  if (equalities < 0) fail("equalities", "must not be negative", equalities);
  for (const double value : mu) require_not_negative("mu", value);
}

struct PseudoInverseTuning {
  /// ε, a part of the diagonal: ε² is round-off.
  static constexpr double kShift = 1e-9;
};

/// A⁺ b of positive semidefinite A, for b in its range: solved with A + ε diag A, which leaves O(ε), and from
/// there once more, which leaves O(ε²).
class PseudoInverse {
 public:
  using Columns = Eigen::SparseMatrix<double>;

  explicit PseudoInverse(const Columns& A) : A_(A) {
    Columns shifted = A;
    const Eigen::VectorXd diagonal = A.diagonal();
    const double largest = diagonal.cwiseAbs().maxCoeff();
    // Rows that move nothing ask for nothing.
    for (int i = 0; i < A.rows(); ++i)
      shifted.coeffRef(i, i) += diagonal[i] > 0 ? PseudoInverseTuning::kShift * diagonal[i]
                                : largest > 0   ? largest
                                                : 1;
    if (!factor_.factorize(shifted))
      fail("W", "must be positive semidefinite among equalities", factor_.error());
  }
  template <typename Right>
  Right of(const Right& b) const {
    const Right first = factor_.solve(b), left = b - A_ * first;
    return first + Right(factor_.solve(left));
  }

 private:
  Columns A_;
  SparseLu factor_;
};

}  // namespace

void FrictionProblem::require_valid() const {
  require_friction(mu, equalities);
  require_matrix("W", W, rows(), rows());
  require_entries("q", q.size(), rows());
  require_all_finite("q", q);
}

FrictionProblem FrictionProblem::without_equalities() const {
  require_valid();
  if (equalities == 0) return *this;
  using Columns = Eigen::SparseMatrix<double>;
  const int n = 3 * contacts();
  const Columns all = W;
  const Columns W_ee = all.topLeftCorner(equalities, equalities), W_ec = all.topRightCorner(equalities, n);
  const Matrix W_ce = W.bottomRows(n).leftCols(equalities);
  const PseudoInverse inverse(W_ee);
  FrictionProblem alone{.W = {}, .q = q.tail(n), .mu = mu};
  alone.W = Matrix(all.bottomRightCorner(n, n)) - Matrix(W_ce * inverse.of(W_ec));
  alone.q -= W_ce * inverse.of(Eigen::VectorXd(q.head(equalities)));
  return alone;
}

FrictionProblem GlobalFrictionProblem::condensed() const {
  require_friction(mu, equalities);
  const Eigen::Index m = M.rows(), n = equalities + 3 * mu.size();
  require_matrix("M", M, m, m);
  require_matrix("H", H, m, n);
  require_entries("f", f.size(), m);
  require_entries("b", b.size(), n);
  require_all_finite("f", f);
  require_all_finite("b", b);
  SparseLu factor;
  if (!factor.factorize(M)) fail("M", "must be invertible", factor.error());
  FrictionProblem problem{.W = {}, .q = b, .mu = mu, .equalities = equalities};
  const Eigen::SparseMatrix<double> by_columns = H, X = factor.solve(by_columns);
  problem.W = FrictionProblem::Matrix(H.transpose() * X);
  problem.W.prune(0.0, 0.0);
  if (m > 0) problem.q += H.transpose() * factor.solve(f);
  return problem;
}

FrictionErrors friction_errors(const FrictionProblem& problem, const Eigen::VectorXd& r) {
  problem.require_valid();
  require_entries("r", r.size(), problem.rows());
  require_all_finite("r", r);
  const ScaledFriction scaled(problem);
  FrictionErrors errors = scaled.errors(scaled.scale(r));
  // Tangents of contacts without friction are not among the unknowns.
  for (int k = 0; k < problem.contacts(); ++k)
    if (problem.mu[k] < ScaledFrictionTuning::kNoFriction)
      for (const int row : {problem.equalities + 3 * k + 1, problem.equalities + 3 * k + 2})
        if (r[row] != 0)
          errors.impulses = errors.rates = errors.map = std::numeric_limits<double>::infinity();
  return errors;
}

}  // namespace taut
