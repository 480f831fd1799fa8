#pragma once

#include <vector>

namespace taut {

/// Undirected graph of blocks: node k has block_size[k] rows and the neighbours
/// neighbour[start[k]] … neighbour[start[k + 1] − 1], ascending and without itself.
struct BlockGraph {
  std::vector<int> block_size;
  std::vector<int> start{0};
  std::vector<int> neighbour;

  int size() const { return static_cast<int>(block_size.size()); }
};

/// An order of elimination and what it costs.
struct BlockOrdering {
  std::vector<int> node_at;  ///< node_at[position]
  double flops = 0;          ///< of one numeric factorisation
  double nonzeros = 0;       ///< of L
};

/// Approximate minimum degree [Amestoy1996] on the blocks, then a postorder of the elimination tree. Ordering
/// blocks instead of rows finds the same fill several times faster (solvers/linear, "Ordering").
BlockOrdering order_blocks(const BlockGraph& graph);

}  // namespace taut
