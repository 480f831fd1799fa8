#include "solvers/linear/tree_cut.h"

#include <algorithm>
#include <numeric>
#include <queue>
#include <utility>

namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct TreeCutTuning {
  /// Part of the time alone that a cut must come down to. Chosen.
  static constexpr double kWorthwhile = 0.8;
  /// Subtrees for each thread beyond which no better cut is looked for: their sizes even out long before.
  static constexpr int kMostSubtrees = 16;
};

/// Costs of the subtrees under each front.
std::vector<double> sums_of_subtrees(std::span<const int> parent, std::span<const double> cost) {
  std::vector<double> sum(cost.begin(), cost.end());
  for (std::size_t f = 0; f < parent.size(); ++f)
    if (parent[f] >= 0) sum[parent[f]] += sum[f];
  return sum;
}

/// How many fronts the subtrees have.
std::vector<int> sizes_of_subtrees(std::span<const int> parent) {
  std::vector<int> size(parent.size(), 1);
  for (std::size_t f = 0; f < parent.size(); ++f)
    if (parent[f] >= 0) size[parent[f]] += size[f];
  return size;
}

/// The cut under fronts that are above: those form the tops of the trees.
TreeCut cut_under(std::span<const int> parent, std::span<const char> is_above, std::span<const double> sum) {
  const std::vector<int> size = sizes_of_subtrees(parent);
  TreeCut cut;
  for (int f = 0; f < static_cast<int>(parent.size()); ++f) {
    if (is_above[f])
      cut.above.push_back(f);
    else if (parent[f] < 0 || is_above[parent[f]])
      cut.subtrees.push_back({f + 1 - size[f], f + 1});
  }
  cut.by_cost.resize(cut.subtrees.size());
  std::iota(cut.by_cost.begin(), cut.by_cost.end(), 0);
  std::stable_sort(cut.by_cost.begin(), cut.by_cost.end(),
                   [&](int a, int b) { return sum[cut.subtrees[a].root()] > sum[cut.subtrees[b].root()]; });
  return cut;
}

}  // namespace

TreeCut cut_below(std::span<const int> parent, std::span<const double> cost, double limit) {
  const std::vector<double> sum = sums_of_subtrees(parent, cost);
  std::vector<char> has_children(parent.size(), 0), above(parent.size(), 0);
  for (int p : parent)
    if (p >= 0) has_children[p] = 1;
  for (std::size_t f = 0; f < parent.size(); ++f) above[f] = sum[f] > limit && has_children[f];
  return cut_under(parent, above, sum);
}

/// The dearest subtree is opened again and again, its root put above. The best of all stages is kept.
TreeCut cut_for_passes(std::span<const int> parent, std::span<const double> cost, int threads) {
  const std::vector<double> sum = sums_of_subtrees(parent, cost);
  std::vector<std::vector<int>> children(parent.size());
  std::priority_queue<std::pair<double, int>> subtrees;
  double total = 0, alone = 0;
  for (int f = 0; f < static_cast<int>(parent.size()); ++f) {
    total += cost[f];
    if (parent[f] >= 0)
      children[parent[f]].push_back(f);
    else
      subtrees.emplace(sum[f], f);
  }
  std::vector<int> opened;
  std::size_t best_opened = 0;
  double best = total;
  const int most = TreeCutTuning::kMostSubtrees * threads;
  while (!subtrees.empty() && static_cast<int>(opened.size()) <= most) {
    const double time = alone + std::max(subtrees.top().first, (total - alone) / threads);
    if (time < best) {
      best = time;
      best_opened = opened.size();
    }
    const int root = subtrees.top().second;
    subtrees.pop();
    opened.push_back(root);
    alone += cost[root];
    for (int child : children[root]) subtrees.emplace(sum[child], child);
  }
  if (best > TreeCutTuning::kWorthwhile * total) return {};
  std::vector<char> above(parent.size(), 0);
  for (std::size_t k = 0; k < best_opened; ++k) above[opened[k]] = 1;
  return cut_under(parent, above, sum);
}

double listed_time(std::span<const int> parent, std::span<const double> cost, int threads) {
  std::vector<double> path(cost.begin(), cost.end());  // to the root
  std::vector<int> waiting(parent.size(), 0);          // for so many children
  for (std::size_t f = parent.size(); f-- > 0;)
    if (parent[f] >= 0) {
      path[f] += path[parent[f]];
      ++waiting[parent[f]];
    }
  std::priority_queue<std::pair<double, int>> ready;
  for (std::size_t f = 0; f < parent.size(); ++f)
    if (waiting[f] == 0) ready.emplace(path[f], static_cast<int>(f));
  std::priority_queue<std::pair<double, int>> running;  // −end, front
  double now = 0;
  while (!ready.empty() || !running.empty()) {
    for (; !ready.empty() && static_cast<int>(running.size()) < threads; ready.pop())
      running.emplace(-(now + cost[ready.top().second]), ready.top().second);
    const auto [end, front] = running.top();
    running.pop();
    now = -end;
    if (const int above = parent[front]; above >= 0 && --waiting[above] == 0)
      ready.emplace(path[above], above);
  }
  return now;
}

double longest_path(std::span<const int> parent, std::span<const double> cost) {
  std::vector<double> below(parent.size(), 0);
  double longest = 0;
  for (std::size_t f = 0; f < parent.size(); ++f) {
    const double path = below[f] + cost[f];
    if (parent[f] >= 0)
      below[parent[f]] = std::max(below[parent[f]], path);
    else
      longest = std::max(longest, path);
  }
  return longest;
}

}  // namespace taut
