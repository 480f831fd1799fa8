// The symbolic half of MultifrontalFactor: from the assembly tree to places and runs.
#include <algorithm>
#include <stdexcept>
#include <string>

#include "solvers/multifrontal_factor.h"

namespace taut {
namespace {

// Appends a run to runs[begin ..], or lengthens the last one if it goes on where that ends, on both sides.
void append_run(std::vector<RowRun>& runs, std::size_t begin, RowRun run) {
  if (runs.size() > begin) {
    RowRun& last = runs.back();
    if (last.source + last.length == run.source && last.target + last.length == run.target) {
      last.length += run.length;
      return;
    }
  }
  runs.push_back(run);
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
  const AssemblyTree tree = build_assembly_tree(A);
  plan_fronts(A, tree);
  plan_contributions();
  plan_runs(A, tree);

  int rows = 0;
  for (const Front& front : fronts_) rows = std::max(rows, front.leading);
  y_.assign(static_cast<std::size_t>(rows), 0.0);
  pack_.assign(packed_size(rows), 0.0);
}

// Sizes, panels and children.
void MultifrontalFactor::plan_fronts(const SymmetricMatrix& A, const AssemblyTree& tree) {
  const auto width = [&](int block) { return A.block_start[block + 1] - A.block_start[block]; };
  fronts_.assign(static_cast<std::size_t>(tree.size()), {});
  flops_ = 0.0;
  nonzeros_ = 0;
  std::int64_t panels = 0;
  for (int f = 0; f < tree.size(); ++f) {
    Front& front = fronts_[f];
    for (int t = tree.pivot_start[f]; t < tree.pivot_start[f + 1]; ++t) front.pivots += width(tree.pivots[t]);
    front.rows = front.pivots;
    for (int t = tree.row_start[f]; t < tree.row_start[f + 1]; ++t) front.rows += width(tree.rows[t]);
    front.leading = (front.rows + 3) & ~3;
    front.parent = tree.parent[f];
    front.first_column = A.block_start[*std::min_element(tree.pivots.begin() + tree.pivot_start[f],
                                                         tree.pivots.begin() + tree.pivot_start[f + 1])];
    front.panel = panels;
    panels += std::int64_t{front.leading} * front.pivots;
    for (int j = 0; j < front.pivots; ++j) {
      const double below = front.rows - j;
      nonzeros_ += front.rows - j;
      flops_ += below * below;
    }
  }
  // The kernels read up to three numbers behind the last panel.
  L_.assign(static_cast<std::size_t>(panels) + 4, 0.0);

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

// Two stacks, one for the fronts of even depth and one for those of odd depth.  In postorder, a front's
// children lie on top of one stack when it is factored, and its own contribution goes on top of the other,
// above its elder brothers': so nothing is moved, and children and parent never overlap.  All places are
// known beforehand.
void MultifrontalFactor::plan_contributions() {
  std::vector<char> odd(fronts_.size(), 0);
  for (std::size_t f = fronts_.size(); f-- > 0;)
    if (fronts_[f].parent >= 0) odd[f] = !odd[fronts_[f].parent];
  const auto area = [](const Front& front) {
    return std::int64_t{contribution_leading(front)} * (front.rows - front.pivots);
  };
  std::int64_t top[2] = {0, 0}, height[2] = {0, 0};
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    Front& front = fronts_[f];
    for (int k = front.child_begin; k < front.child_end; ++k) top[!odd[f]] -= area(fronts_[children_[k]]);
    std::int64_t& own = top[static_cast<int>(odd[f])];
    front.contribution = own;
    own += area(front);
    height[static_cast<int>(odd[f])] = std::max(height[static_cast<int>(odd[f])], own);
  }
  for (std::size_t f = 0; f < fronts_.size(); ++f)
    if (odd[f]) fronts_[f].contribution += height[0];
  // As behind the panels, kernels read behind the last contribution.
  contributions_.assign(static_cast<std::size_t>(height[0] + height[1]) + 4, 0.0);
}

// The runs of x and of A's columns to front rows, and of the children's contributions to front rows.  A run
// never crosses from pivots to other rows, on either side.
void MultifrontalFactor::plan_runs(const SymmetricMatrix& A, const AssemblyTree& tree) {
  const auto width = [&](int block) { return A.block_start[block + 1] - A.block_start[block]; };
  std::vector<int> position(static_cast<std::size_t>(A.block_count()), 0);  // front row of block
  rows_.clear();
  map_runs_.clear();
  columns_.clear();
  column_runs_.clear();
  for (int f = 0; f < tree.size(); ++f) {
    Front& front = fronts_[f];
    front.row_begin = static_cast<std::int64_t>(rows_.size());
    const auto add_block = [&](int block) {
      position[block] = static_cast<int>(static_cast<std::int64_t>(rows_.size()) - front.row_begin);
      for (int r = A.block_start[block]; r < A.block_start[block + 1]; ++r) rows_.push_back(r);
    };
    for (int t = tree.pivot_start[f]; t < tree.pivot_start[f + 1]; ++t) add_block(tree.pivots[t]);
    for (int t = tree.row_start[f]; t < tree.row_start[f + 1]; ++t) add_block(tree.rows[t]);
    for (int i = front.rows; i < front.leading; ++i) rows_.push_back(rows_.back());

    for (int k = front.child_begin; k < front.child_end; ++k) {
      const int c = children_[k];
      Front& child = fronts_[c];
      child.map_begin = child.map_pivot_end = static_cast<int>(map_runs_.size());
      std::size_t first = map_runs_.size();
      int source = 0;
      for (int t = tree.row_start[c]; t < tree.row_start[c + 1]; ++t) {
        const int block = tree.rows[t], target = position[block];
        if (target >= front.pivots && child.map_pivot_end == child.map_begin) {
          child.map_pivot_end = static_cast<int>(map_runs_.size());
          first = map_runs_.size();
        }
        append_run(map_runs_, first, {source, target, width(block)});
        source += width(block);
      }
      child.map_end = static_cast<int>(map_runs_.size());
      // The first row below a child is a pivot of its parent, so an empty range means that all rows are.
      if (child.map_pivot_end == child.map_begin) child.map_pivot_end = child.map_end;
    }
    plan_columns(A, tree, f, position);
  }
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
    entry.target = position[block];
    entry.run_begin = static_cast<int>(column_runs_.size());
    for (int k = 0; k < entry.length;) {
      const int row = A.row_index[entry.place + k];
      const int row_block = static_cast<int>(
          std::upper_bound(A.block_start.begin(), A.block_start.end(), row) - A.block_start.begin() - 1);
      const int height = A.block_start[row_block + 1] - A.block_start[row_block];
      append_run(column_runs_, static_cast<std::size_t>(entry.run_begin), {k, position[row_block], height});
      k += height;
    }
    entry.run_end = static_cast<int>(column_runs_.size());
    columns_.push_back(entry);
  }
  front.column_end = static_cast<int>(columns_.size());
}

}  // namespace taut
