#include "solvers/linear/block_ordering.h"

#include <cholmod.h>

#include <stdexcept>

namespace taut {
namespace {

/// Flops and entries of L from the column counts of the block factor.  Rows below the diagonal block are
/// counted with the mean block size: exact where all blocks are alike, close enough elsewhere to choose a
/// method by.
void count_work(const BlockGraph& graph, const cholmod_factor& L, BlockOrdering& ordering) {
  const auto* column_count = static_cast<const int*>(L.ColCount);
  double rows = 0;
  for (int size : graph.block_size) rows += size;
  const double mean = graph.size() ? rows / graph.size() : 0;
  for (int k = 0; k < graph.size(); ++k) {
    const double below = (column_count[k] - 1) * mean;
    for (int i = 0; i < graph.block_size[ordering.node_at[k]]; ++i) {
      const double column = below + graph.block_size[ordering.node_at[k]] - i;
      ordering.flops += column * column;
      ordering.nonzeros += column;
    }
  }
}

}  // namespace

BlockOrdering order_blocks(const BlockGraph& graph) {
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_AMD;
  common.postorder = true;
  common.supernodal = CHOLMOD_SIMPLICIAL;

  // A pattern with both triangles, of which CHOLMOD reads the upper one.
  cholmod_sparse pattern{};
  pattern.nrow = pattern.ncol = graph.size();
  pattern.nzmax = graph.neighbour.size();
  pattern.p = const_cast<int*>(graph.start.data());
  pattern.i = const_cast<int*>(graph.neighbour.data());
  pattern.stype = 1;
  pattern.itype = CHOLMOD_INT;
  pattern.xtype = CHOLMOD_PATTERN;
  pattern.dtype = CHOLMOD_DOUBLE;
  pattern.sorted = true;
  pattern.packed = true;

  BlockOrdering ordering;
  cholmod_factor* L = cholmod_analyze(&pattern, &common);
  if (L) {
    const auto* permutation = static_cast<const int*>(L->Perm);
    ordering.node_at.assign(permutation, permutation + graph.size());
    count_work(graph, *L, ordering);
    cholmod_free_factor(&L, &common);
  }
  cholmod_finish(&common);
  if (ordering.node_at.size() != static_cast<std::size_t>(graph.size())) throw std::bad_alloc();
  return ordering;
}

}  // namespace taut
