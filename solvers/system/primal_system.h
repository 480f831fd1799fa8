#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/linear/block_ordering.h"
#include "solvers/linear/factor.h"
#include "solvers/system/linearized_rows.h"
#include "solvers/system/make_factor.h"
#include "solvers/system/primal_matrix.h"
#include "solvers/system/row_states.h"

namespace taut {

/// The primal matrix P = 1 + Wᵀ D W, six rows a body, with its factor: for D of a Newton's method, or with
/// D = Σ⁻¹ for the rows themselves.  Order, pattern and symbolic factor are made when they are first wanted.
/// (solvers/system, "Primal matrix")
class PrimalSystem {
 public:
  explicit PrimalSystem(FactorChoice choice, const FactorMeans& means = {})
      : choice_(choice), means_(means) {}
  /// The rows have another pattern: order and analysis are to be made anew.
  void forget_pattern();
  /// The order of elimination.
  const BlockOrdering& order(const LinearizedRows& rows);
  /// Pattern and symbolic factor.
  void analyze(const LinearizedRows& rows);
  bool analyzed() const { return matrix_ != nullptr; }

  /// P of this W and D ≥ 0, one number per row, and its factor.  False for values that are not finite.
  [[nodiscard]] bool factorize(std::span<const double> weighted, std::span<const double> D,
                               StageTimes& times);
  /// v ← P⁻¹ v, six numbers a body.
  void solve(std::span<double> v);
  /// Grows with every factor.
  long version() const { return version_; }
  const Factor& factor() const { return *factor_; }

  /// D = 1 / (Σ_r + shift (S_rr + Σ_r)), 0 on masked rows, kept for solve_rows().
  std::span<const double> regularize(LinearizedRows& rows, const RowStates& states, double shift);
  /// x ← (S + D⁻¹)⁻¹ x, one entry per row, with the factor of that D:  v = P⁻¹ Wᵀ D x, λ = D (x − W v).
  void solve_rows(LinearizedRows& rows, std::span<double> x);

 private:
  FactorChoice choice_;
  FactorMeans means_;
  std::optional<BlockOrdering> ordering_;
  std::vector<int> body_of_node_;
  std::unique_ptr<Factor> factor_;
  std::unique_ptr<PrimalMatrix> matrix_;
  std::vector<double> ordered_;
  std::vector<double> inverse_compliance_;   // D of the rows
  std::vector<double> body_values_, rates_;  // six numbers a body; one a row
  long version_ = 0;
};

}  // namespace taut
