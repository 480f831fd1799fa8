#include "solvers/linear/assembly_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/counting_sort.h"

namespace taut {
namespace {

BlockPattern pattern_below_diagonal(const SymmetricMatrix& A) {
  std::vector<int> block_of(static_cast<std::size_t>(A.size()));
  for (int b = 0; b < A.block_count(); ++b)
    std::fill(block_of.begin() + A.block_start[b], block_of.begin() + A.block_start[b + 1], b);
  BlockPattern pattern;
  for (int b = 0; b < A.block_count(); ++b) {
    const int column = A.block_start[b];
    pattern.width.push_back(A.block_start[b + 1] - column);
    for (int t = A.column_start[column]; t < A.column_start[column + 1];) {
      const int row = block_of[A.row_index[t]];
      if (row != b) pattern.rows.push_back(row);
      t += A.block_start[row + 1] - A.block_start[row];
    }
    pattern.start.push_back(static_cast<int>(pattern.rows.size()));
  }
  return pattern;
}

BlockPattern transposed(const BlockPattern& pattern) {
  std::vector<int> column_of(pattern.rows.size());
  const int count = static_cast<int>(pattern.start.size()) - 1;
  for (int j = 0; j < count; ++j)
    std::fill(column_of.begin() + pattern.start[j], column_of.begin() + pattern.start[j + 1], j);
  BlockPattern result;
  counting_sort(
      pattern.rows.size(), count, [&](std::size_t t) { return pattern.rows[t]; },
      [&](std::size_t t) { return column_of[t]; }, result.start, result.rows);
  return result;
}

// Liu's algorithm [Liu1990]: the parent of j is the first row below the diagonal of column j of L.  Row i of
// L is the subtree that hangs below i and has its leaves among the columns of row i of A; `ancestor` shortens
// the climbs.
std::vector<int> elimination_tree(const BlockPattern& pattern) {
  const BlockPattern by_row = transposed(pattern);
  const std::size_t count = pattern.start.size() - 1;
  std::vector<int> parent(count, -1), ancestor(count, -1);
  for (std::size_t i = 0; i < count; ++i) {
    for (int t = by_row.start[i]; t < by_row.start[i + 1]; ++t) {
      for (int j = by_row.rows[t]; j != -1 && j != static_cast<int>(i);) {
        const int next = ancestor[j];
        ancestor[j] = static_cast<int>(i);
        if (next == -1) parent[j] = static_cast<int>(i);
        j = next;
      }
    }
  }
  return parent;
}

// Children of each node as linked lists, ascending.
struct Children {
  std::vector<int> first, next;
  explicit Children(const std::vector<int>& parent) : first(parent.size(), -1), next(parent.size(), -1) {
    for (int j = static_cast<int>(parent.size()) - 1; j >= 0; --j) {
      if (parent[j] == -1) continue;
      next[j] = first[parent[j]];
      first[parent[j]] = j;
    }
  }
};

// The nodes in postorder; the identity if the tree is postordered already.
std::vector<int> postorder(const std::vector<int>& parent) {
  Children children(parent);
  std::vector<int> order, path;
  order.reserve(parent.size());
  for (std::size_t root = 0; root < parent.size(); ++root) {
    if (parent[root] != -1) continue;
    path.push_back(static_cast<int>(root));
    while (!path.empty()) {
      const int node = path.back();
      if (const int child = children.first[node]; child != -1) {
        children.first[node] = children.next[child];
        path.push_back(child);
      } else {
        order.push_back(node);
        path.pop_back();
      }
    }
  }
  return order;
}

// Supernodes: chains of columns with the same structure.  Nodes are named by their place in the postorder.
struct Supernodes {
  std::vector<int> first;            // first column; the last is the next supernode's first − 1
  std::vector<int> of;               // of column
  std::vector<int> row_start, rows;  // structure below the last column, ascending
  std::vector<int> row_end;
};

// Column j's structure is that of A's column and of its children, without j.  A column with a single child
// whose structure already holds A's column joins the child's (fundamental) supernode; all others merge their
// children's.
Supernodes find_supernodes(const BlockPattern& A, const std::vector<int>& order,
                           const std::vector<int>& place, const std::vector<int>& parent) {
  const int count = static_cast<int>(order.size());
  const Children children(parent);
  Supernodes s;
  s.of.resize(order.size());
  std::vector<int> mark(order.size(), -1);
  for (int j = 0; j < count; ++j) {
    const auto* begin = A.rows.data() + A.start[order[j]];
    const auto* end = A.rows.data() + A.start[order[j] + 1];
    const int current = static_cast<int>(s.first.size()) - 1;
    if (children.first[j] == j - 1 && j > 0 &&
        std::all_of(begin, end, [&](int row) { return mark[place[row]] == current; })) {
      s.of[j] = current;
      ++s.row_start[current];  // j was the first row
      continue;
    }
    const int id = current + 1;
    s.first.push_back(j);
    s.of[j] = id;
    s.row_start.push_back(static_cast<int>(s.rows.size()));
    const auto insert = [&](int row) {
      if (mark[row] == id || row == j) return;
      mark[row] = id;
      s.rows.push_back(row);
    };
    for (const auto* row = begin; row != end; ++row) insert(place[*row]);
    for (int child = children.first[j]; child != -1; child = children.next[child])
      for (int t = s.row_start[s.of[child]]; t < s.row_end[s.of[child]]; ++t) insert(s.rows[t]);
    std::sort(s.rows.begin() + s.row_start[id], s.rows.end());
    s.row_end.push_back(static_cast<int>(s.rows.size()));
  }
  return s;
}

// Relaxed amalgamation.  A parent, visited after its children, takes in those children whose merging lowers
// the modelled time, and then looks at the grandchildren that came with them.  Returns for each supernode the
// one that it was merged into, itself if none.
std::vector<int> amalgamate(const Supernodes& s, const std::vector<int>& columns,
                            const std::vector<int>& row_count, const std::vector<int>& parent) {
  std::vector<int> pivots = columns, into(parent.size());
  std::iota(into.begin(), into.end(), 0);
  Children children(parent);
  std::vector<int> candidates, kept;
  for (int p = 0; p < static_cast<int>(s.first.size()); ++p) {
    candidates.clear();
    kept.clear();
    for (int c = children.first[p]; c != -1; c = children.next[c]) candidates.push_back(c);
    // Largest contributions first: they bring the fewest zeros and save most.
    std::stable_sort(candidates.begin(), candidates.end(),
                     [&](int a, int b) { return row_count[a] > row_count[b]; });
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const int c = candidates[k];
      const double apart = front_cost(pivots[c], row_count[c]) + front_cost(pivots[p], row_count[p]);
      if (front_cost(pivots[c] + pivots[p], row_count[p]) < apart) {
        into[c] = p;
        pivots[p] += pivots[c];
        for (int g = children.first[c]; g != -1; g = children.next[g]) candidates.push_back(g);
      } else {
        kept.push_back(c);
      }
    }
    children.first[p] = -1;
    for (int c : kept) {
      children.next[c] = children.first[p];
      children.first[p] = c;
    }
  }
  return into;
}

}  // namespace

double front_cost(double p, double m) {
  const double tiles = std::ceil(0.25 * p), rows = 4.0 * std::ceil(0.25 * (p + m));
  // ½ Σ (n − j)² over the pivots j, n = p + m.
  const double multiplications = 0.5 * (p * m * m + p * p * m + p * p * p / 3.0);
  using Tuning = FrontTuning;
  return Tuning::kFront + Tuning::kTile * tiles + Tuning::kPanelEntry * p * rows +
         Tuning::kContributionEntry * 0.5 * m * m + Tuning::kMultiplication * multiplications;
}

BlockPattern pattern_below_diagonal(const BlockGraph& graph, std::span<const int> node_at) {
  std::vector<int> place(node_at.size());
  for (std::size_t k = 0; k < node_at.size(); ++k) place[node_at[k]] = static_cast<int>(k);
  BlockPattern pattern;
  pattern.rows.reserve(graph.neighbour.size() / 2);
  for (std::size_t k = 0; k < node_at.size(); ++k) {
    const int node = node_at[k];
    for (int t = graph.start[node]; t < graph.start[node + 1]; ++t)
      if (const int other = place[graph.neighbour[t]]; other > static_cast<int>(k))
        pattern.rows.push_back(other);
    pattern.width.push_back(graph.block_size[node]);
    pattern.start.push_back(static_cast<int>(pattern.rows.size()));
  }
  return pattern;
}

AssemblyTree build_assembly_tree(const SymmetricMatrix& A) {
  return build_assembly_tree(pattern_below_diagonal(A));
}

AssemblyTree build_assembly_tree(const BlockPattern& pattern) {
  const std::vector<int> tree = elimination_tree(pattern);
  const std::vector<int> order = postorder(tree);
  std::vector<int> place(order.size()), parent(order.size(), -1);
  for (std::size_t j = 0; j < order.size(); ++j) place[order[j]] = static_cast<int>(j);
  for (std::size_t j = 0; j < order.size(); ++j)
    if (tree[order[j]] != -1) parent[j] = place[tree[order[j]]];

  const Supernodes s = find_supernodes(pattern, order, place, parent);
  const int count = static_cast<int>(s.first.size());
  const auto width = [&](int node) { return pattern.width[order[node]]; };
  std::vector<int> columns(s.first.size(), 0), row_count(s.first.size(), 0), above(s.first.size(), -1);
  for (std::size_t j = 0; j < order.size(); ++j) columns[s.of[j]] += width(static_cast<int>(j));
  for (int f = 0; f < count; ++f) {
    for (int t = s.row_start[f]; t < s.row_end[f]; ++t) row_count[f] += width(s.rows[t]);
    if (s.row_start[f] < s.row_end[f]) above[f] = s.of[s.rows[s.row_start[f]]];
  }
  std::vector<int> into = amalgamate(s, columns, row_count, above);
  for (int f = count - 1; f >= 0; --f) into[f] = into[into[f]];  // parents have larger numbers

  // Fronts are the supernodes that were not merged; their order is still a postorder.
  AssemblyTree result;
  std::vector<int> front(s.first.size(), -1);
  int fronts = 0;
  for (int f = 0; f < count; ++f)
    if (into[f] == f) front[f] = fronts++;
  counting_sort(
      order.size(), fronts, [&](std::size_t j) { return front[into[s.of[j]]]; },
      [&](std::size_t j) { return order[j]; }, result.pivot_start, result.pivots);
  for (int f = 0; f < count; ++f) {
    if (into[f] != f) continue;
    for (int t = s.row_start[f]; t < s.row_end[f]; ++t) result.rows.push_back(order[s.rows[t]]);
    result.row_start.push_back(static_cast<int>(result.rows.size()));
    result.parent.push_back(above[f] == -1 ? -1 : front[into[above[f]]]);
  }
  return result;
}

double modelled_time(const AssemblyTree& tree, const BlockPattern& A) {
  const auto columns = [&](const std::vector<int>& blocks, int begin, int end) {
    int sum = 0;
    for (int t = begin; t < end; ++t) sum += A.width[blocks[t]];
    return sum;
  };
  double time = 0;
  for (int f = 0; f < tree.size(); ++f)
    time += front_cost(columns(tree.pivots, tree.pivot_start[f], tree.pivot_start[f + 1]),
                       columns(tree.rows, tree.row_start[f], tree.row_start[f + 1]));
  return time;
}

}  // namespace taut
