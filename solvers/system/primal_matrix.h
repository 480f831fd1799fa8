#pragma once

#include <span>
#include <vector>

#include "core/constraints/rows.h"
#include "solvers/linear/block_ordering.h"
#include "solvers/linear/factor.h"
#include "solvers/system/mass_matrix.h"

namespace taut {

/// One node of 6 per moving body that has rows, in ascending order of the bodies; bodies are neighbours if a
/// joint or contact couples them.  `body_of_node` is what the nodes are.
BlockGraph body_graph(const Rows& rows, const MassMatrix& mass, std::vector<int>& body_of_node);

/// P = 1 + Wᵀ Σ⁻¹ W with W = J A, M⁻¹ = A Aᵀ: the system of the bodies, from which follows that of the rows,
///
///     (S + Σ) λ = x   ⇔   P v = Wᵀ Σ⁻¹ x,   λ = Σ⁻¹ (x − W v),   v = Wᵀ λ.
///
/// It has six rows a body however many contacts there are, and a body that touches hundreds of others only
/// has hundreds of neighbours, where S has a dense block of all their rows.
/// (solvers/system, "Primal matrix")
class PrimalMatrix {
 public:
  PrimalMatrix(const Rows& rows, const MassMatrix& mass, SymmetricMatrix::Triangle triangle,
               const BlockOrdering& ordering, std::span<const int> body_of_node);

  /// Values of P from W and 1/Σ_r of each row, 0 for rows that are left out.  Slots are fixed: no search, no
  /// allocation.
  void assemble(std::span<const double> weighted, std::span<const double> inverse_compliance);
  const SymmetricMatrix& matrix() const { return matrix_; }
  /// First entry of a body in the order of elimination; −1 if it has none.
  std::span<const int> position_of_body() const { return position_; }

 private:
  /// Adds W_iᵀ Σ⁻¹ W_j, of one joint, to the block that starts at `slot`.
  struct Product {
    int slot, stride;
    int offset_i, offset_j;
    int first_row, row_count;
  };

  SymmetricMatrix matrix_;
  std::vector<Product> products_;
  std::vector<int> position_, diagonal_;
};

}  // namespace taut
