#pragma once

#include <span>
#include <vector>

#include "core/constraints/rows.h"
#include "solvers/linear/block_ordering.h"
#include "solvers/linear/factor.h"
#include "solvers/linear/front_kernels.h"
#include "solvers/system/inverse_mass_root.h"
#include "solvers/system/mass_matrix.h"

namespace taut {

/// One node per joint; joints are neighbours if they share a moving body.
BlockGraph joint_graph(const Rows& rows, const MassMatrix& mass);

/// S = W Wᵀ = J M⁻¹ Jᵀ with W = J A, M⁻¹ = A Aᵀ.  Pattern and slot map are made once; assemble() is then one
/// loop over the bodies and the pairs of sides that meet at each, which know where their blocks go: no
/// search, no allocation.  The W of a body is needed nowhere else, so that it need not leave the cache.
class DelassusMatrix {
 public:
  DelassusMatrix(const Rows& rows, const MassMatrix& mass, const BlockOrdering& ordering,
                 SymmetricMatrix::Triangle triangle);

  /// W from J and the roots A of M⁻¹, laid out like the Jacobian values.
  template <typename Root>
  static void mass_weight(const Rows& rows, std::span<const double> jacobian, std::span<const Root> roots,
                          std::span<double> weighted);
  /// Values of S from J and the roots A, then every diagonal entry times (1 + shift); `rows` are those that
  /// the pattern was made for.
  template <typename Root>
  void assemble(const Rows& rows, std::span<const double> jacobian, std::span<const Root> roots,
                double shift);
  /// The part of assemble() without a shift that the bodies from `begin` to `end` have, all of whose joints
  /// must be linearised; bodies in ascending order.
  void assemble(const Rows& rows, std::span<const double> jacobian, std::span<const InverseMassRoot> roots,
                int begin, int end);
  /// Values of S from W, then every diagonal entry times (1 + shift).  With `row_states` (one per row of the
  /// joints, see ConstraintSystem::set_row_states) Σ_r is added to S_rr before that, and masked rows, which
  /// the caller has zeroed in W, get the diagonal 1.
  void assemble(const Rows& rows, std::span<const double> weighted, double shift,
                std::span<const double> row_states = {});

  const SymmetricMatrix& matrix() const { return matrix_; }
  /// Where row r of the joints stands in the order of elimination.
  std::span<const int> position_of_row() const { return position_of_row_; }
  /// Index of diagonal entry i (order of elimination) in the values.
  std::span<const int> diagonal() const { return diagonal_; }

 private:
  /// Adds W_i W_jᵀ, of the sides at places i and j of a body's, to the block that starts at `slot` with
  /// columns `stride` apart.
  struct Product {
    int slot, stride;
    int i, j;
    bool first;  // the block's first product overwrites
  };
  struct BodyProduct {
    int body;
    Product product;
  };
  /// Sides at places i and j of a body's, the latter of the joint of a block column.
  struct Meeting {
    int block_row, body, i, j;
  };

  void build_pattern(const Rows& rows, const MassMatrix& mass, const BlockOrdering& ordering);
  void place_rows(const Rows& rows, std::span<const int> joints);
  void append_block_column(int k, std::span<const Meeting> meetings, std::vector<BodyProduct>& products);
  void sort_products(const Rows& rows, std::span<const BodyProduct> products);
  int height(int block) const { return matrix_.block_start[block + 1] - matrix_.block_start[block]; }
  bool is_stored(int block_row, int block_column) const {
    return matrix_.triangle == SymmetricMatrix::Triangle::kLower ? block_row >= block_column
                                                                 : block_row <= block_column;
  }
  void add_products(const Rows& rows, int body);
  template <typename Weigh>
  void assemble_bodies(const Rows& rows, int begin, int end, Weigh weigh);
  template <typename Root>
  void assemble_roots(const Rows& rows, std::span<const double> jacobian, std::span<const Root> roots,
                      int begin, int end);
  void shift_diagonal(double shift);

  const FrontKernels& kernels_ = front_kernels();
  SymmetricMatrix matrix_;
  std::vector<Product> products_;                // body by body
  std::vector<int> first_product_;               // of each body
  std::vector<double> own_weighted_;             // W of one body, by columns
  std::vector<const double*> weighted_of_side_;  // where it is, by side
  std::vector<int> position_of_row_, diagonal_;
};

}  // namespace taut
