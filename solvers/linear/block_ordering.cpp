#include "solvers/linear/block_ordering.h"

#include <cholmod.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <new>
#include <optional>
#include <tuple>
#include <utility>

#include "solvers/linear/assembly_tree.h"

namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct OrderingTuning {
  /// Modelled time of a factorisation per block [ns] from which on a nested dissection is tried, measured: it
  /// takes 2 to 6 µs per block, as long as 3 to 6 factorisations. Half: nets of 20 × 20 are dissected, and
  /// stay as they are; twice: grids of 40 × 40 whose joints are shuffled factor 1.2 times as long.
  static constexpr double kDissectionFrom = 700;
  /// Graphs whose orders are remembered: a simulation of joints has one, or takes turns with another. Half:
  /// what takes turns is ordered anew each time; twice: nothing but memory.
  static constexpr std::size_t kRemembered = 2;
};

/// Flops and entries of L from the column counts of the block factor.  Rows below the diagonal block are
/// counted with the mean block size: exact where all blocks are alike, close enough elsewhere to choose a
/// method by.
void count_work(const BlockGraph& graph, const cholmod_factor& L, BlockOrdering& ordering) {
  const auto* column_count = static_cast<const int*>(L.ColCount);
  double rows = 0;
  for (int size : graph.block_size) rows += size;
  const double mean = graph.size() ? rows / graph.size() : 0;
  std::size_t blocks_below = 0;
  for (int k = 0; k < graph.size(); ++k) {
    blocks_below += column_count[k] - 1;
    const double below = (column_count[k] - 1) * mean;
    for (int i = 0; i < graph.block_size[ordering.node_at[k]]; ++i) {
      const double column = below + graph.block_size[ordering.node_at[k]] - i;
      ordering.flops += column * column;
      ordering.nonzeros += column;
    }
  }
  ordering.fills = 2 * blocks_below > graph.neighbour.size();
}

/// The order by a method of CHOLMOD; nothing where it lacks the method.
std::optional<BlockOrdering> order_by(int method, std::string_view name, const BlockGraph& graph) {
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  common.nmethods = 1;
  common.method[0].ordering = method;
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

  std::optional<BlockOrdering> ordering;
  cholmod_factor* L = cholmod_analyze(&pattern, &common);
  if (L) {
    const auto* permutation = static_cast<const int*>(L->Perm);
    ordering.emplace();
    ordering->node_at.assign(permutation, permutation + graph.size());
    ordering->method = name;
    count_work(graph, *L, *ordering);
    cholmod_free_factor(&L, &common);
  }
  const bool out_of_memory = common.status == CHOLMOD_OUT_OF_MEMORY;
  cholmod_finish(&common);
  if (out_of_memory) throw std::bad_alloc();
  return ordering;
}

/// METIS seeds rand() and draws from it. One dissection at a time gives the same order whatever other threads
/// dissect, and the numbers that the program draws stay its own where the C library lets us put them aside.
class RandomNumbersAside {
 public:
  RandomNumbersAside() : lock_(mutex()) {
#ifdef __GLIBC__
    theirs_ = initstate(1, ours_, sizeof ours_);
#endif
  }
  ~RandomNumbersAside() {
#ifdef __GLIBC__
    setstate(theirs_);
#endif
  }
  RandomNumbersAside(const RandomNumbersAside&) = delete;
  RandomNumbersAside& operator=(const RandomNumbersAside&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
#ifdef __GLIBC__
  char ours_[128];  // as many as rand() has by default
  char* theirs_;
#endif
};

/// The nodes of each component breadth first from one of its ends, of those met together the ones with the
/// fewest neighbours first [Cuthill1969]. Numbers of the nodes decide only between equals.
std::vector<int> breadth_first(const BlockGraph& graph) {
  const auto neighbours = [&](int node) { return graph.start[node + 1] - graph.start[node]; };
  std::vector<int> numbering;
  std::vector<int> last_sweep(graph.block_size.size(), 0);
  int sweep = 0;
  for (int node = 0; node < graph.size(); ++node) {
    if (last_sweep[node] > 0) continue;
    const std::size_t begin = numbering.size();
    // The node met last is further out than the first: begin there again, twice.
    for (int k = 0, root = node; k < 3; ++k, root = numbering.back()) {
      numbering.resize(begin);
      numbering.push_back(root);
      last_sweep[root] = ++sweep;
      for (std::size_t at = begin; at < numbering.size(); ++at) {
        const auto met = static_cast<std::ptrdiff_t>(numbering.size());
        for (int t = graph.start[numbering[at]]; t < graph.start[numbering[at] + 1]; ++t)
          if (std::exchange(last_sweep[graph.neighbour[t]], sweep) != sweep)
            numbering.push_back(graph.neighbour[t]);
        std::sort(numbering.begin() + met, numbering.end(),
                  [&](int a, int b) { return std::tuple(neighbours(a), a) < std::tuple(neighbours(b), b); });
      }
    }
  }
  return numbering;
}

/// What a factorisation in this order takes [ns]. In single precision, so that the order in which fronts are
/// summed does not decide between orders of equal cost.
float modelled_factorization(const BlockGraph& graph, const BlockOrdering& ordering) {
  const BlockPattern pattern = pattern_below_diagonal(graph, ordering.node_at);
  return static_cast<float>(modelled_time(build_assembly_tree(pattern), pattern));
}

}  // namespace

BlockGraph renumbered(const BlockGraph& graph, std::span<const int> numbering) {
  std::vector<int> number(numbering.size());
  for (std::size_t k = 0; k < numbering.size(); ++k) number[numbering[k]] = static_cast<int>(k);
  BlockGraph result;
  result.neighbour.reserve(graph.neighbour.size());
  for (int node : numbering) {
    const auto begin = static_cast<std::ptrdiff_t>(result.neighbour.size());
    for (int t = graph.start[node]; t < graph.start[node + 1]; ++t)
      result.neighbour.push_back(number[graph.neighbour[t]]);
    std::sort(result.neighbour.begin() + begin, result.neighbour.end());
    result.block_size.push_back(graph.block_size[node]);
    result.start.push_back(static_cast<int>(result.neighbour.size()));
  }
  return result;
}

BlockOrdering order_blocks(const BlockGraph& graph) {
  std::optional<BlockOrdering> ordering = order_by(CHOLMOD_AMD, "AMD", graph);
  if (!ordering) throw std::bad_alloc();
  return *std::move(ordering);
}

BlockOrdering cheapest_order(const BlockGraph& graph) {
  BlockOrdering best = order_blocks(graph);
  if (!best.fills) return best;  // chains, trees: no order has less to do
  float least = modelled_factorization(graph, best);
  const auto consider = [&](int method, std::string_view name, const std::vector<int>& numbering) {
    std::optional<BlockOrdering> other = order_by(method, name, renumbered(graph, numbering));
    if (!other) return;
    for (int& node : other->node_at) node = numbering[node];
    const float time = modelled_factorization(graph, *other);
    if (time >= least) return;
    least = time;
    best = *std::move(other);
  };
  const std::vector<int> forwards = breadth_first(graph);
  const std::vector<int> backwards(forwards.rbegin(), forwards.rend());
  consider(CHOLMOD_AMD, "AMD of a breadth-first numbering", forwards);
  consider(CHOLMOD_AMD, "AMD of a reversed breadth-first numbering", backwards);
  if (least >= OrderingTuning::kDissectionFrom * graph.size()) {
    const RandomNumbersAside aside;
    consider(CHOLMOD_NESDIS, "nested dissection", forwards);
  }
  return best;
}

const BlockOrdering& OrderMemory::order(BlockGraph graph) {
  const auto same = [&](const Known& known) { return known.graph == graph; };
  auto found = std::find_if(known_.begin(), known_.end(), same);
  if (found == known_.end()) {
    BlockOrdering ordering = cheapest_order(graph);
    if (known_.size() == OrderingTuning::kRemembered) known_.pop_back();
    found = known_.insert(known_.end(), {std::move(graph), std::move(ordering)});
  }
  std::rotate(known_.begin(), found, found + 1);
  return known_.front().ordering;
}

BlockOrdering order_blocks(BlockGraph graph, OrderMemory* memory) {
  return memory ? memory->order(std::move(graph)) : order_blocks(graph);
}

}  // namespace taut
