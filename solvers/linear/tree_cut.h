#pragma once

#include <span>
#include <vector>

namespace taut {

/// A tree of fronts in postorder, cut for threads: subtrees, each of which is the work of one of them, and
/// the fronts above.
struct TreeCut {
  struct Subtree {
    int begin = 0, end = 0;  ///< its fronts; the root is the last
    int root() const { return end - 1; }
  };
  std::vector<Subtree> subtrees;  ///< in postorder
  std::vector<int> above;         ///< fronts, ascending
  std::vector<int> by_cost;       ///< subtrees, the dearest first
};

/// The largest subtrees that cost no more than `limit`, and single leaves that cost more.
TreeCut cut_below(std::span<const int> parent, std::span<const double> cost, double limit);

/// The cut with which it takes the least time that threads do the subtrees, and one alone what is above.
/// Nothing is cut (no subtrees) where that saves less than a fifth.
TreeCut cut_for_passes(std::span<const int> parent, std::span<const double> cost, int threads);

/// What the tree takes so many threads, each front the work of one of them and after its children: of those
/// that are ready, the front whose path to the root is dearest is begun first [Graham1969].
double listed_time(std::span<const int> parent, std::span<const double> cost, int threads);

/// Cost of the dearest path from a leaf to a root: what a pass through the tree takes with any number of
/// threads.
double longest_path(std::span<const int> parent, std::span<const double> cost);

}  // namespace taut
