#pragma once

#include <span>
#include <vector>

#include "solvers/linear/block_ordering.h"
#include "solvers/linear/factor.h"

namespace taut {

/// Pattern of a symmetric matrix of blocks: block column j has width[j] columns, and below its diagonal block
/// the blocks rows[start[j] .. start[j + 1]).
struct BlockPattern {
  std::vector<int> width;
  std::vector<int> start{0};
  std::vector<int> rows;
};

/// That of a matrix with a block for each node, and for each edge, with node node_at[k] in place k.
BlockPattern pattern_below_diagonal(const BlockGraph& graph, std::span<const int> node_at);

/// The tree of fronts of a Cholesky factorisation, in blocks of the matrix.  Front f eliminates the blocks
/// pivots[pivot_start[f] .. pivot_start[f+1]) and updates the blocks rows[row_start[f] .. row_start[f+1]),
/// all of which belong to ancestors of f.  Both lists have the order in which the blocks are eliminated.
///
/// Fronts are in postorder: children come before their parent, and a subtree is a range of fronts.  Where the
/// matrix is not postordered, or where brothers were merged, the order of elimination differs from the
/// matrix's by exchanges of independent blocks only; the factor is then the same up to that permutation.
struct AssemblyTree {
  std::vector<int> pivot_start{0};
  std::vector<int> pivots;
  std::vector<int> row_start{0};
  std::vector<int> rows;
  std::vector<int> parent;  ///< −1 for a root

  int size() const { return static_cast<int>(parent.size()); }
};

/// Modelled times [ns], fitted to measured ones.  For merging only ratios matter; thresholds of orders and of
/// threads are in these units.
struct FrontTuning {
  /// Of each front.
  static constexpr double kFront = 60;
  /// Of four pivots, which wait for each other.
  static constexpr double kTile = 50;
  /// Of an entry of a panel: zeroing and assembly, and reading in the solves that follow.
  static constexpr double kPanelEntry = 1.5;
  /// Of an entry of a contribution: writing, and extend-add into the parent.
  static constexpr double kContributionEntry = 0.5;
  static constexpr double kMultiplication = 0.1;  ///< of a multiplication and its addition
};

/// Modelled time [ns] of a front with p pivots and m more rows: merging a child with its parent costs
/// arithmetic with zeros, and saves the child's overhead and the passing on of its contribution.
double front_cost(double p, double m);

/// @pre A holds its lower triangle, with every diagonal block.
AssemblyTree build_assembly_tree(const SymmetricMatrix& A);
/// Of a matrix of which the pattern alone is known.
AssemblyTree build_assembly_tree(const BlockPattern& A);

/// Modelled time of a factorisation [ns], that of all fronts of the tree of A.
double modelled_time(const AssemblyTree& tree, const BlockPattern& A);

}  // namespace taut
