#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "solvers/linear/aligned_vector.h"
#include "solvers/linear/assembly_tree.h"
#include "solvers/linear/factor.h"
#include "solvers/linear/front_kernels.h"
#include "solvers/linear/shared_fronts.h"

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
/// machine.  They throw only where a long factorisation is interrupted, or a shared one between two subtrees
/// (core/base/interruption.h).
///
/// Given a pool, large factorisations and solves are shared among its threads, with the same bits as by one,
/// but for what a factorisation that failed leaves, which nobody reads.  No two calls may be made at a time,
/// not even of other factors with that pool.
class MultifrontalFactor final : public Factor {
 public:
  MultifrontalFactor();
  /// @param threads null: there is but the caller's.  Must outlive this.
  explicit MultifrontalFactor(const FrontKernels& kernels, detail::LazyPool* threads = nullptr,
                              const Sharing& sharing = {});
  explicit MultifrontalFactor(detail::LazyPool* threads);
  ~MultifrontalFactor() override;

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
  /// The panels of the fronts.
  std::span<const double> panels() const { return L_; }
  /// Room for contributions [numbers], of all threads.
  std::size_t contribution_room() const;
  /// The time of a factorisation by one thread over that by so many, as front_cost() and the tree of fronts
  /// say: threads neither disturb each other nor share a front.
  double modelled_gain(int threads) const;
  /// How threads share the work; null if they do not.
  const SharedFronts* shared() const { return shared_.get(); }

 private:
  // A block column of A and its runs: `width` scalar columns, `length` numbers each, from `place` on.
  struct BlockColumn {
    int place = 0, length = 0, width = 0;
    int target = 0;  // first column in the panel
    int run_begin = 0, run_end = 0;
  };

  void plan_fronts(const SymmetricMatrix& A, const AssemblyTree& tree);
  void plan_panels();
  void plan_contributions();
  std::int64_t stack_contributions(int begin, int end);
  void plan_runs(const SymmetricMatrix& A, const AssemblyTree& tree);
  void plan_map(const Front& parent, Front& child, const std::vector<int>& position);
  void plan_columns(const SymmetricMatrix& A, const AssemblyTree& tree, int f,
                    const std::vector<int>& position);

  // Threads.
  void plan_sharing();
  void plan_outside();
  void make_scratch(int most_rows);
  void plan_shared_contributions();
  int factorize_shared(const SymmetricMatrix& A);
  void factorize_subtree(const SymmetricMatrix& A, int number, FrontScratch& scratch);
  /// work(subtree, scratch) for each subtree of a cut, on so many threads.
  template <typename Work>
  void share(const TreeCut& cut, int threads, const Work& work);
  void solve_shared(std::span<double> x);
  void forward_subtree(int subtree, double* x, double* y);
  void forward_above(double* x, double* y);

  /// Where contributions begin, and room for packing.
  struct Places {
    double *of_children, *own, *pack;
  };
  int factorize_front(const Front& front, const SymmetricMatrix& A, const Places& places);
  void assemble(const Front& front, const SymmetricMatrix& A, double* panel) const;
  void forward(const Front& front, int rows, double* x, double* y) const;
  void backward(const Front& front, double* x, double* y) const;
  static int contribution_leading(const Front& front) { return (front.rows - front.pivots + 3) & ~3; }
  static std::int64_t contribution_area(const Front& front) {
    return std::int64_t{contribution_leading(front)} * (front.rows - front.pivots);
  }

  const FrontKernels* kernels_;
  detail::LazyPool* threads_ = nullptr;
  Sharing sharing_;
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
  std::unique_ptr<SharedFronts> shared_;  // null: one thread does all
  std::vector<double> pivots_;            // D_ii / A_ii of the last factorisation
  FrontScratch scratch_;                  // of the caller alone
};

}  // namespace taut
