#include "solvers/linear/multifrontal_factor.h"

#include <algorithm>
#include <cassert>

#include "core/base/interruption.h"

namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct MultifrontalTuning {
  /// Fronts with fewer rows are done within some milliseconds, and ask nobody whether to give up.
  static constexpr int kLongFront = 512;
};

}  // namespace

MultifrontalFactor::MultifrontalFactor() : MultifrontalFactor(front_kernels()) {}

MultifrontalFactor::MultifrontalFactor(detail::LazyPool* threads)
    : MultifrontalFactor(front_kernels(), threads) {}

MultifrontalFactor::MultifrontalFactor(const FrontKernels& kernels, detail::LazyPool* threads,
                                       const Sharing& sharing)
    : kernels_(&kernels), threads_(threads), sharing_(sharing) {}

MultifrontalFactor::~MultifrontalFactor() = default;

std::size_t MultifrontalFactor::contribution_room() const {
  std::size_t room = contributions_.size();
  if (shared_)
    for (const FrontScratch& scratch : shared_->scratch) room += scratch.contributions.size();
  return room;
}

// The first column that fails in the matrix's order need not be the first met, where the fronts' order
// differs from it. So fronts with earlier columns are still factored after a failure; what failed below them
// can only spoil columns that come after the one already found.
int MultifrontalFactor::factorize(const SymmetricMatrix& A) {
  assert(A.size() == size_);
  if (shared_ && !shared_->factorization.cut.subtrees.empty()) return factorize_shared(A);
  int failed = -1;
  const Places places{contributions_.data(), contributions_.data(), scratch_.pack.data()};
  for (const Front& front : fronts_) {
    if (failed >= 0 && front.first_column > failed) continue;
    const int column = factorize_front(front, A, places);
    if (column >= 0 && (failed < 0 || column < failed)) failed = column;
  }
  return failed;
}

// The children's contributions to the pivot columns come before the factorisation, those to the parent's own
// contribution after it: so the latter is written once by −L₂₁L₂₁ᵀ and need not be set to zero.
int MultifrontalFactor::factorize_front(const Front& front, const SymmetricMatrix& A, const Places& places) {
  double* panel = L_.data() + front.panel;
  assemble(front, A, panel);
  const auto diagonal = [&](int k) { return panel[k * (std::ptrdiff_t{front.leading} + 1)]; };
  for (int k = 0; k < front.pivots; ++k) pivots_[rows_[front.row_begin + k]] = diagonal(k);
  for (int k = front.child_begin; k < front.child_end; ++k) {
    const Front& child = fronts_[children_[k]];
    kernels_->extend_add(panel, front.leading, places.of_children + child.contribution,
                         contribution_leading(child), map_runs_.data() + child.map_begin, 0,
                         child.map_pivot_end - child.map_begin, child.map_end - child.map_begin);
  }
  const auto stop = front.rows >= MultifrontalTuning::kLongFront ? &detail::interrupted : nullptr;
  const int failed =
      kernels_->factor_panel(panel, front.leading, front.rows, front.pivots, places.pack, stop);
  if (failed == kStopped) throw detail::Interrupted{};
  if (failed >= 0) return rows_[front.row_begin + failed];
  for (int k = 0; k < front.pivots; ++k) {  // while they are near
    double& pivot = pivots_[rows_[front.row_begin + k]];
    pivot = 1.0 / (diagonal(k) * diagonal(k)) / pivot;
  }

  const int m = front.rows - front.pivots, ldc = contribution_leading(front);
  if (m == 0) return -1;
  double* C = places.own + front.contribution;
  if (!kernels_->contribution(C, ldc, panel + front.pivots, front.leading, m, front.pivots, places.pack,
                              stop))
    throw detail::Interrupted{};
  // The maps count front rows; C begins at the front's row and column p.
  double* origin = C - front.pivots - std::ptrdiff_t{front.pivots} * ldc;
  for (int k = front.child_begin; k < front.child_end; ++k) {
    const Front& child = fronts_[children_[k]];
    kernels_->extend_add(origin, ldc, places.of_children + child.contribution, contribution_leading(child),
                         map_runs_.data() + child.map_begin, child.map_pivot_end - child.map_begin,
                         child.map_end - child.map_begin, child.map_end - child.map_begin);
  }
  return -1;
}

void MultifrontalFactor::assemble(const Front& front, const SymmetricMatrix& A, double* panel) const {
  std::fill_n(panel, std::ptrdiff_t{front.leading} * front.pivots, 0.0);
  for (int b = front.column_begin; b < front.column_end; ++b) {
    const BlockColumn& block = columns_[b];
    kernels_->assemble(panel + std::ptrdiff_t{block.target} * front.leading, front.leading,
                       A.values.data() + block.place, block.length, block.width,
                       column_runs_.data() + block.run_begin, block.run_end - block.run_begin);
  }
}

// Forward substitution from the leaves up, backward from the roots down.
void MultifrontalFactor::solve(std::span<double> x) {
  assert(static_cast<int>(x.size()) == size_);
  if (shared_ && !shared_->passes.cut.subtrees.empty()) return solve_shared(x);
  double* y = scratch_.y.data();
  for (const Front& front : fronts_) forward(front, front.rows, x.data(), y);
  for (auto front = fronts_.rbegin(); front != fronts_.rend(); ++front) backward(*front, x.data(), y);
}

// What it adds to its first `rows` rows; for those behind, it is left in y.
void MultifrontalFactor::forward(const Front& front, int rows, double* x, double* y) const {
  kernels_->forward(L_.data() + front.panel, front.leading, rows, front.pivots,
                    rows_.data() + front.row_begin, x, y);
}

void MultifrontalFactor::backward(const Front& front, double* x, double* y) const {
  kernels_->backward(L_.data() + front.panel, front.leading, front.pivots, rows_.data() + front.row_begin, x,
                     y);
}

}  // namespace taut
