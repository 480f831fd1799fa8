#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "solvers/linear/aligned_vector.h"
#include "solvers/linear/tree_cut.h"

namespace taut {

struct SharingTuning {
  /// Modelled time of a factorisation (front_cost()) [ns] from which on waking a second thread pays, and half
  /// of it each further one.  Measured with two.
  static constexpr double kFactorFrom = 6e6;
  /// Bytes of L, which a solve reads twice, from which on that pays.  Measured.
  static constexpr double kSolveFrom = 16e6;
  /// A subtree of a factorisation costs at most this part of a thread's share, so that shares even out: a
  /// study of nets found 8 to do.  Measured.
  static constexpr double kSubtrees = 8;
  /// The longest path through the tree may be at most this part of the whole.  Chosen.
  static constexpr double kLongestPath = 0.8;
  /// Tasks for each thread, at most: where subtrees are more, each takes several.  Chosen.
  static constexpr int kTasks = 32;
};

/// Which factorisations and solves are shared among threads.  No bit of a result depends on it.
struct Sharing {
  double factor_from = SharingTuning::kFactorFrom, solve_from = SharingTuning::kSolveFrom;
  double subtrees_a_thread = SharingTuning::kSubtrees, longest_path = SharingTuning::kLongestPath;
  int tasks_a_thread = SharingTuning::kTasks;
};

/// Where a front is worked on.
struct FrontScratch {
  AlignedVector<double> contributions;  ///< of fronts within a subtree
  AlignedVector<double> pack;
  AlignedVector<double> y;  ///< a front's part of x
};

/// What threads need beside the plan of a factorisation to share it.
///
/// A thread takes subtrees, whose contributions are on stacks of its own but for that of the root.  Who
/// finishes the last child of a front above goes on with it.  Nobody waits for anybody.
struct SharedFactorization {
  TreeCut cut;
  int threads = 1;
  std::vector<std::atomic<int>> waiting;  ///< children that are not done yet
  std::atomic<int> failed;                ///< the first column
};

/// What threads share in solves.  Subtrees go first in forward and last in backward substitution, and one
/// thread does the fronts above.  What a subtree adds to rows outside it is kept aside, and added in the
/// fronts' postorder as by one thread alone: so that sums are the same to the last bit.
struct SharedPasses {
  TreeCut cut;
  int threads = 1;
  /// Rows of a front from `first` on are outside its subtree.
  struct Outside {
    int front, first;
    std::int64_t place;  ///< in `values`
  };
  std::vector<int> first_outside;  ///< row, of each front
  std::vector<Outside> outside;    ///< of fronts with such rows, in postorder
  std::vector<int> begin;          ///< in `outside`, of each subtree
  AlignedVector<double> values;
};

/// Empty cuts: not shared.
struct SharedFronts {
  detail::ThreadPool* pool = nullptr;
  std::vector<FrontScratch> scratch;  ///< of each worker that takes part in either
  SharedFactorization factorization;
  SharedPasses passes;
};

}  // namespace taut
