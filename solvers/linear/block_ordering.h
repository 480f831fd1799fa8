#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace taut {

/// Undirected graph of blocks: node k has block_size[k] rows and the neighbours
/// neighbour[start[k]] … neighbour[start[k + 1] − 1], ascending and without itself.
struct BlockGraph {
  std::vector<int> block_size;
  std::vector<int> start{0};
  std::vector<int> neighbour;

  int size() const { return static_cast<int>(block_size.size()); }
  friend bool operator==(const BlockGraph&, const BlockGraph&) = default;
};

/// The graph whose node k is node numbering[k].
BlockGraph renumbered(const BlockGraph& graph, std::span<const int> numbering);

/// An order of elimination and what it costs.
struct BlockOrdering {
  std::vector<int> node_at;   ///< node_at[position]
  std::string_view method{};  ///< how it was found, for reports
  double flops = 0;           ///< of one numeric factorisation
  double nonzeros = 0;        ///< of L
  bool fills = false;         ///< L has blocks where the matrix has none
};

/// Approximate minimum degree [Amestoy1996] on the blocks, then a postorder of the elimination tree. Ordering
/// blocks instead of rows finds the same fill several times faster (solvers/linear, "Ordering"). For patterns
/// that do not last: its fill depends on how the nodes are numbered, by up to a factor of four in flops.
BlockOrdering order_blocks(const BlockGraph& graph);

/// The order with the least modelled time of a factorisation (assembly_tree.h) among order_blocks(), the same
/// of numberings that hardly depend on that of the nodes, and nested dissection where that pays and CHOLMOD
/// has its Partition module. For patterns that last: the search takes as long as a few factorisations.
BlockOrdering cheapest_order(const BlockGraph& graph);

/// Orders found by cheapest_order(), of the latest graphs: a pattern that comes back costs no search. What it
/// gives depends on the graph alone.
class OrderMemory {
 public:
  /// That of this graph; valid until the next call.
  const BlockOrdering& order(BlockGraph graph);

 private:
  struct Known {
    BlockGraph graph;
    BlockOrdering ordering;
  };
  std::vector<Known> known_;  // the latest first
};

/// With a memory the cheapest order, without one order_blocks().
BlockOrdering order_blocks(BlockGraph graph, OrderMemory* memory);

}  // namespace taut
