// The symbolic half of MultifrontalFactor: from the assembly tree to places and runs.
#include <algorithm>
#include <stdexcept>
#include <string>

#include "solvers/linear/multifrontal_factor.h"

namespace taut {
namespace {

// Appends a row to runs[begin ..]: to the last run if it goes on where that ends, on both sides.
void append_row(std::vector<RowRun>& runs, std::size_t begin, int source, int target) {
  if (runs.size() > begin) {
    RowRun& last = runs.back();
    if (last.source + last.length == source && last.target + last.length == target) {
      ++last.length;
      return;
    }
  }
  runs.push_back({source, target, 1});
}

void check(const SymmetricMatrix& A) {
  if (A.triangle != SymmetricMatrix::Triangle::kLower)
    throw std::invalid_argument("MultifrontalFactor: the matrix holds its upper triangle, not its lower one");
  for (int b = 0; b < A.block_count(); ++b) {
    for (int c = A.block_start[b]; c < A.block_start[b + 1]; ++c) {
      if (A.column_start[c] == A.column_start[c + 1] || A.row_index[A.column_start[c]] != A.block_start[b])
        throw std::invalid_argument("MultifrontalFactor: column " + std::to_string(c) +
                                    " does not start with its diagonal block");
    }
  }
}

}  // namespace

void MultifrontalFactor::analyze(const SymmetricMatrix& A) {
  check(A);
  size_ = A.size();
  pivots_.assign(size_, 0.0);
  const AssemblyTree tree = build_assembly_tree(A);
  plan_fronts(A, tree);
  plan_sharing();
  plan_panels();
  plan_contributions();
  plan_runs(A, tree);
  plan_outside();

  int rows = 0;
  for (const Front& front : fronts_) rows = std::max(rows, front.leading);
  make_scratch(rows);
}

// Sizes and children.
void MultifrontalFactor::plan_fronts(const SymmetricMatrix& A, const AssemblyTree& tree) {
  const auto width = [&](int block) { return A.block_start[block + 1] - A.block_start[block]; };
  fronts_.assign(static_cast<std::size_t>(tree.size()), {});
  flops_ = 0.0;
  nonzeros_ = 0;
  for (int f = 0; f < tree.size(); ++f) {
    Front& front = fronts_[f];
    for (int t = tree.pivot_start[f]; t < tree.pivot_start[f + 1]; ++t) front.pivots += width(tree.pivots[t]);
    front.rows = front.pivots;
    for (int t = tree.row_start[f]; t < tree.row_start[f + 1]; ++t) front.rows += width(tree.rows[t]);
    front.leading = (front.rows + 3) & ~3;
    front.parent = tree.parent[f];
    front.first_column = A.block_start[*std::min_element(tree.pivots.begin() + tree.pivot_start[f],
                                                         tree.pivots.begin() + tree.pivot_start[f + 1])];
    for (int j = 0; j < front.pivots; ++j) {
      const double below = front.rows - j;
      nonzeros_ += front.rows - j;
      flops_ += below * below;
    }
  }
  children_.clear();
  std::vector<std::vector<int>> children(fronts_.size());
  for (int f = 0; f < tree.size(); ++f)
    if (fronts_[f].parent >= 0) children[fronts_[f].parent].push_back(f);
  for (int f = 0; f < tree.size(); ++f) {
    fronts_[f].child_begin = static_cast<int>(children_.size());
    children_.insert(children_.end(), children[f].begin(), children[f].end());
    fronts_[f].child_end = static_cast<int>(children_.size());
  }
}

// Front after front.  The kernels read, and write back, up to three numbers behind a panel: what another
// thread may be working on begins farther away.
void MultifrontalFactor::plan_panels() {
  std::vector<char> ends_task(fronts_.size(), 0);
  if (shared_) {
    for (const TreeCut::Subtree& subtree : shared_->factorization.cut.subtrees) ends_task[subtree.root()] = 1;
    for (int f : shared_->factorization.cut.above) ends_task[f] = 1;
  }
  std::int64_t panels = 0;
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    fronts_[f].panel = panels;
    panels += std::int64_t{fronts_[f].leading} * fronts_[f].pivots + (ends_task[f] ? 4 : 0);
  }
  L_.assign(static_cast<std::size_t>(panels) + 4, 0.0);
}

void MultifrontalFactor::plan_contributions() {
  if (shared_ && !shared_->factorization.cut.subtrees.empty()) return plan_shared_contributions();
  const std::int64_t room = stack_contributions(0, static_cast<int>(fronts_.size()));
  // As behind the panels, kernels read behind the last contribution.
  contributions_.assign(static_cast<std::size_t>(room) + 4, 0.0);
}

// Two stacks for fronts that are a subtree with or without its root, one for those of even depth and one for
// those of odd depth.  In postorder, a front's children lie on top of one stack when it is factored, and its
// own contribution goes on top of the other, above its elder brothers': so nothing is moved, and children and
// parent never overlap.  All places are known beforehand.
std::int64_t MultifrontalFactor::stack_contributions(int begin, int end) {
  std::vector<char> odd(static_cast<std::size_t>(end - begin), 0);
  for (int f = end; f-- > begin;)
    if (const int parent = fronts_[f].parent; parent >= 0 && parent < end)
      odd[f - begin] = !odd[parent - begin];
  std::int64_t top[2] = {0, 0}, height[2] = {0, 0};
  for (int f = begin; f < end; ++f) {
    Front& front = fronts_[f];
    const int side = odd[f - begin] ? 1 : 0;
    for (int k = front.child_begin; k < front.child_end; ++k)
      top[1 - side] -= contribution_area(fronts_[children_[k]]);
    front.contribution = top[side];
    top[side] += contribution_area(front);
    height[side] = std::max(height[side], top[side]);
  }
  for (int f = begin; f < end; ++f)
    if (odd[f - begin]) fronts_[f].contribution += height[0];
  return height[0] + height[1];
}

// The fronts' rows, and the runs of A's columns and of the children's contributions to front rows.
void MultifrontalFactor::plan_runs(const SymmetricMatrix& A, const AssemblyTree& tree) {
  std::vector<int> position(static_cast<std::size_t>(A.size()), 0);  // front row of A's row
  rows_.clear();
  map_runs_.clear();
  columns_.clear();
  column_runs_.clear();
  for (int f = 0; f < tree.size(); ++f) {
    Front& front = fronts_[f];
    front.row_begin = static_cast<std::int64_t>(rows_.size());
    int count = 0;
    const auto add_block = [&](int block) {
      for (int r = A.block_start[block]; r < A.block_start[block + 1]; ++r) {
        position[r] = count++;
        rows_.push_back(r);
      }
    };
    for (int t = tree.pivot_start[f]; t < tree.pivot_start[f + 1]; ++t) add_block(tree.pivots[t]);
    for (int t = tree.row_start[f]; t < tree.row_start[f + 1]; ++t) add_block(tree.rows[t]);
    for (int i = front.rows; i < front.leading; ++i) rows_.push_back(rows_.back());

    for (int k = front.child_begin; k < front.child_end; ++k)
      plan_map(front, fronts_[children_[k]], position);
    plan_columns(A, tree, f, position);
  }
}

// The child's rows that are pivots of its parent come first, and no run goes beyond them: they are added to
// the panel, the others to the parent's contribution.
void MultifrontalFactor::plan_map(const Front& parent, Front& child, const std::vector<int>& position) {
  child.map_begin = static_cast<int>(map_runs_.size());
  const int* rows = rows_.data() + child.row_begin + child.pivots;
  const int count = child.rows - child.pivots;
  int i = 0;
  for (; i < count && position[rows[i]] < parent.pivots; ++i)
    append_row(map_runs_, static_cast<std::size_t>(child.map_begin), i, position[rows[i]]);
  child.map_pivot_end = static_cast<int>(map_runs_.size());
  for (; i < count; ++i)
    append_row(map_runs_, static_cast<std::size_t>(child.map_pivot_end), i, position[rows[i]]);
  child.map_end = static_cast<int>(map_runs_.size());
}

void MultifrontalFactor::plan_columns(const SymmetricMatrix& A, const AssemblyTree& tree, int f,
                                      const std::vector<int>& position) {
  Front& front = fronts_[f];
  front.column_begin = static_cast<int>(columns_.size());
  for (int t = tree.pivot_start[f]; t < tree.pivot_start[f + 1]; ++t) {
    const int block = tree.pivots[t], column = A.block_start[block];
    BlockColumn entry;
    entry.place = A.column_start[column];
    entry.length = A.column_start[column + 1] - A.column_start[column];
    entry.width = A.block_start[block + 1] - column;
    entry.target = position[column];
    entry.run_begin = static_cast<int>(column_runs_.size());
    for (int k = 0; k < entry.length; ++k)
      append_row(column_runs_, static_cast<std::size_t>(entry.run_begin), k,
                 position[A.row_index[entry.place + k]]);
    entry.run_end = static_cast<int>(column_runs_.size());
    columns_.push_back(entry);
  }
  front.column_end = static_cast<int>(columns_.size());
}

}  // namespace taut
