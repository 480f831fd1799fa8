#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "solvers/linear/aligned_vector.h"
#include "solvers/linear/assembly_tree.h"
#include "solvers/linear/factor.h"
#include "solvers/linear/front_kernels.h"

namespace taut {

/// Supernodal multifrontal Cholesky factorisation A = L Lᵀ for matrices of many small dense blocks.
///
/// The columns of L with (nearly) the same rows are eliminated together, in a dense front.  A front adds up
/// A's columns and the contributions of its children in the tree, factors its pivot columns and hands the
/// rest to its parent:
///
///     [ F₁₁  ·  ]   [ L₁₁  0 ] [ L₁₁ᵀ L₂₁ᵀ ]
///     [ F₂₁ F₂₂ ] = [ L₂₁  I ] [  0    C   ] ,      C = F₂₂ − L₂₁ L₂₁ᵀ .
///
/// analyze() finds the fronts and fixes every place: where L, the contributions and A's entries go, and how a
/// contribution's rows map to its parent's.  factorize() and solve() then run through lists of contiguous
/// runs; they do not search, allocate, call BLAS or start threads, and give the same bits run to run on one
/// machine.  They throw only where a long factorisation is interrupted (core/base/interruption.h).
class MultifrontalFactor final : public Factor {
 public:
  MultifrontalFactor();
  explicit MultifrontalFactor(const FrontKernels& kernels) : kernels_(&kernels) {}

  SymmetricMatrix::Triangle triangle() const override { return SymmetricMatrix::Triangle::kLower; }
  /// @throws std::invalid_argument if A holds its upper triangle or lacks a diagonal block.
  void analyze(const SymmetricMatrix& A) override;
  [[nodiscard]] int factorize(const SymmetricMatrix& A) override;
  void solve(std::span<double> x) override;
  std::span<const double> relative_pivots() const override { return pivots_; }

  std::string name() const override { return std::string("multifrontal ") + kernels_->name; }
  /// Includes the arithmetic with zeros that merged fronts hold.
  double flops() const override { return flops_; }
  std::int64_t nonzeros() const override { return nonzeros_; }

  /// One entry per front, children before parents, for reports and tests.
  struct Front {
    int pivots = 0;   ///< p
    int rows = 0;     ///< n
    int leading = 0;  ///< leading dimension of the panel
    int parent = -1;
    int first_column = 0;                ///< smallest column of A that is a pivot here
    std::int64_t panel = 0;              ///< place of the n×p panel in L
    std::int64_t contribution = 0;       ///< place of the (n−p)×(n−p) contribution in the stacks
    std::int64_t row_begin = 0;          ///< in rows_
    int child_begin = 0, child_end = 0;  ///< in children_
    int map_begin = 0, map_pivot_end = 0, map_end = 0;  ///< runs contribution → parent's front rows
    int column_begin = 0, column_end = 0;               ///< in columns_
  };
  const std::vector<Front>& fronts() const { return fronts_; }

 private:
  // A block column of A and its runs: `width` scalar columns, `length` numbers each, from `place` on.
  struct BlockColumn {
    int place = 0, length = 0, width = 0;
    int target = 0;  // first column in the panel
    int run_begin = 0, run_end = 0;
  };

  void plan_fronts(const SymmetricMatrix& A, const AssemblyTree& tree);
  void plan_contributions();
  void plan_runs(const SymmetricMatrix& A, const AssemblyTree& tree);
  void plan_map(const Front& parent, Front& child, const std::vector<int>& position);
  void plan_columns(const SymmetricMatrix& A, const AssemblyTree& tree, int f,
                    const std::vector<int>& position);

  int factorize_front(const Front& front, const SymmetricMatrix& A);
  void assemble(const Front& front, const SymmetricMatrix& A, double* panel) const;
  double* contribution_of(const Front& front) { return contributions_.data() + front.contribution; }
  static int contribution_leading(const Front& front) { return (front.rows - front.pivots + 3) & ~3; }

  const FrontKernels* kernels_;
  int size_ = 0;
  double flops_ = 0.0;
  std::int64_t nonzeros_ = 0;
  std::vector<Front> fronts_;
  std::vector<int> children_;
  std::vector<int> rows_;  // front rows → rows of A, padded to the leading dimension
  std::vector<BlockColumn> columns_;
  std::vector<RowRun> column_runs_;  // A's column → front rows
  std::vector<RowRun> map_runs_;     // contribution rows → parent's front rows
  AlignedVector<double> L_;          // panels, front after front
  AlignedVector<double> contributions_;
  AlignedVector<double> pack_;
  std::vector<double> pivots_;  // D_ii / A_ii of the last factorisation
  AlignedVector<double> y_;     // a front's part of x
};

}  // namespace taut
