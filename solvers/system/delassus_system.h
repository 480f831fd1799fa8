#pragma once

#include <memory>
#include <span>
#include <vector>

#include "solvers/common/settings.h"
#include "solvers/linear/factor.h"
#include "solvers/system/delassus_matrix.h"
#include "solvers/system/linearized_rows.h"
#include "solvers/system/make_factor.h"
#include "solvers/system/row_states.h"

namespace taut {

/// The Delassus matrix S + Σ + shift diag(S + Σ) of one pattern of rows, with its factor.  Masked rows have a
/// diagonal entry only.  (solvers/system, "Delassus matrix")
class DelassusSystem {
 public:
  /// Order, pattern and symbolic factor.
  DelassusSystem(const LinearizedRows& rows, FactorChoice choice, const FactorMeans& means = {});

  /// S of the bodies that a chunk settles, all rows free, no shift: assemble() has no more to do if neither J
  /// nor A changes after the last chunk.
  void assemble(const LinearizedRows& rows, const Rows::BodyChunk& chunk);
  /// The matrix for these states and this shift.
  void assemble(LinearizedRows& rows, const RowStates& states, double shift);
  /// Its factor.  False if there is none.
  [[nodiscard]] bool factorize() { return factor_->factorize(matrix_.matrix()) < 0; }
  /// x ← (that matrix)⁻¹ x, one entry per row.
  void solve(std::span<double> x);

  /// Pivots relative to the diagonal entries, in the order of elimination, and the row at each place of it.
  std::span<const double> relative_pivots() const { return factor_->relative_pivots(); }
  std::span<const int> row_at_position() const { return row_at_position_; }
  const SymmetricMatrix& matrix() const { return matrix_.matrix(); }
  const Factor& factor() const { return *factor_; }

 private:
  DelassusSystem(const LinearizedRows& rows, const BlockOrdering& ordering, FactorChoice choice,
                 const FactorMeans& means);
  std::span<const double> masked_weighted(LinearizedRows& rows, const RowStates& states);

  std::unique_ptr<Factor> factor_;
  DelassusMatrix matrix_;
  std::vector<int> row_at_position_;
  std::vector<double> ordered_, masked_weighted_;
  long assembled_version_ = -1;  // of the J and A whose S without states and shift the matrix is
};

}  // namespace taut
