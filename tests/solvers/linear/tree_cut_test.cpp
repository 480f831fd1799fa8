#include "solvers/linear/tree_cut.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace taut::tree_cut_test {
namespace {

struct Tree {
  std::vector<int> parent;
  std::vector<double> cost;
};

/// In postorder: each front takes some of the roots that there are as its children.
Tree random_tree(int size, std::mt19937& random) {
  std::uniform_int_distribution<int> children(0, 3);
  std::exponential_distribution<double> cost(1);
  Tree tree;
  std::vector<int> roots;
  for (int f = 0; f < size; ++f) {
    for (int k = children(random); k > 0 && !roots.empty(); --k) {
      tree.parent[roots.back()] = f;
      roots.pop_back();
    }
    roots.push_back(f);
    tree.parent.push_back(-1);
    tree.cost.push_back(cost(random));
  }
  return tree;
}

double cost_of(const Tree& tree, const TreeCut::Subtree& subtree) {
  double sum = 0;
  for (int f = subtree.begin; f < subtree.end; ++f) sum += tree.cost[f];
  return sum;
}

/// Every front is in one subtree, or above; subtrees are whole, and what is above hangs together.
void expect_cut(const Tree& tree, const TreeCut& cut) {
  const int size = static_cast<int>(tree.parent.size());
  std::vector<int> subtree_of(tree.parent.size(), -1), times(tree.parent.size(), 0);
  for (std::size_t k = 0; k < cut.subtrees.size(); ++k)
    for (int f = cut.subtrees[k].begin; f < cut.subtrees[k].end; ++f) {
      ++times[f];
      subtree_of[f] = static_cast<int>(k);
    }
  for (int f : cut.above) ++times[f];
  for (int f = 0; f < size; ++f) {
    EXPECT_EQ(times[f], 1);
    const bool is_root = subtree_of[f] >= 0 && cut.subtrees[subtree_of[f]].root() == f;
    const int own = subtree_of[f] >= 0 && !is_root ? subtree_of[f] : -1;
    EXPECT_EQ(tree.parent[f] >= 0 ? subtree_of[tree.parent[f]] : -1, own);
  }
  ASSERT_EQ(cut.by_cost.size(), cut.subtrees.size());
  for (std::size_t k = 0; k + 1 < cut.by_cost.size(); ++k)
    EXPECT_GE(cost_of(tree, cut.subtrees[cut.by_cost[k]]) * (1 + 1e-12),
              cost_of(tree, cut.subtrees[cut.by_cost[k + 1]]));
}

TEST(TreeCut, HasEveryFrontOnce) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Tree tree = random_tree(1 + trial, random);
    for (const double limit : {0.0, 1.0, 5.0, 1e9}) {
      const TreeCut cut = cut_below(tree.parent, tree.cost, limit);
      expect_cut(tree, cut);
      for (const TreeCut::Subtree& subtree : cut.subtrees)
        EXPECT_TRUE(subtree.end - subtree.begin == 1 || cost_of(tree, subtree) <= limit * (1 + 1e-12));
    }
    for (const int threads : {2, 3, 16}) {
      const TreeCut cut = cut_for_passes(tree.parent, tree.cost, threads);
      if (!cut.subtrees.empty()) expect_cut(tree, cut);
    }
  }
}

/// A root with two equal halves, and a root that costs as much as both.
TEST(TreeCut, PassesAreCutWhereThatPays) {
  const std::vector<int> parent{2, 2, -1};
  const TreeCut halves = cut_for_passes(parent, std::vector<double>{10, 10, 1}, 2);
  ASSERT_EQ(halves.subtrees.size(), 2u);
  EXPECT_EQ(halves.above, std::vector<int>{2});
  EXPECT_TRUE(cut_for_passes(parent, std::vector<double>{10, 10, 100}, 2).subtrees.empty());
  EXPECT_TRUE(cut_for_passes(std::vector<int>{1, 2, -1}, std::vector<double>{1, 1, 1}, 2).subtrees.empty());
  EXPECT_TRUE(cut_for_passes({}, {}, 2).subtrees.empty());
}

/// A root above two halves, each a front above two leaves; and a chain, which no threads shorten.
TEST(TreeCut, ListedTimeIsThatOfAScheduleByHand) {
  const std::vector<int> parent{2, 2, 6, 5, 5, 6, -1};
  const std::vector<double> cost{3, 2, 4, 1, 1, 6, 5};
  EXPECT_EQ(listed_time(parent, cost, 1), 22);
  // Both of 1; at 1 those of 3 and of 6, at 4 that of 2, at 6 that of 4, at 10 the root.
  EXPECT_EQ(listed_time(parent, cost, 2), 15);
  EXPECT_EQ(longest_path(parent, cost), 12);
  EXPECT_EQ(listed_time(parent, cost, 4), 12);
  EXPECT_EQ(listed_time(std::vector<int>{1, 2, -1}, std::vector<double>{1, 2, 3}, 64), 6);
  EXPECT_EQ(listed_time({}, {}, 2), 0);
}

/// No thread is idle while a front is ready: at most the longest path more than an even share [Graham1969].
TEST(TreeCut, ListedTimeIsWithinItsBounds) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const Tree tree = random_tree(1 + trial, random);
    double total = 0;
    for (double cost : tree.cost) total += cost;
    const double path = longest_path(tree.parent, tree.cost);
    for (const int threads : {1, 2, 5, 64}) {
      const double time = listed_time(tree.parent, tree.cost, threads);
      EXPECT_GE(time, std::max(path, total / threads) * (1 - 1e-12));
      EXPECT_LE(time, (total / threads + path * (threads - 1) / threads) * (1 + 1e-12));
    }
  }
}

TEST(TreeCut, FindsTheLongestPath) {
  EXPECT_EQ(longest_path(std::vector<int>{2, 2, -1, -1}, std::vector<double>{1, 5, 2, 6}), 7);
}

}  // namespace
}  // namespace taut::tree_cut_test
