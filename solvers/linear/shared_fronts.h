#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "solvers/linear/aligned_vector.h"
#include "solvers/linear/tree_cut.h"

namespace taut {

/// Which factorisations and solves are shared among threads.  No bit of a result depends on it.
struct SharingTuning {
  /// Modelled time of a factorisation (FrontCost) [ns] from which on waking a second thread pays, and half of
  /// it each further one.  Measured with two.
  double factor_from = 6e6;
  /// The same of bytes of L, which a solve reads twice.
  double solve_from = 16e6;
  /// Subtrees of a factorisation cost at most this part of a thread's share, so that shares even out: a study
  /// of nets found 8 to do.
  double subtrees_a_thread = 8;
  /// The longest path through the tree may be at most this part of the whole. Chosen.
  double longest_path = 0.8;
  /// Tasks for each thread, at most: where subtrees are more, each takes several.
  int tasks_a_thread = 32;
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

/// The same for solves.  Subtrees go first in forward and last in backward substitution, and one thread does
/// the fronts above.  What a subtree adds to rows outside it is kept aside, and added in the fronts'
/// postorder as by one thread alone: so that sums are the same to the last bit.
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
