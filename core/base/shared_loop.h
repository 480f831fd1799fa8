#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>

#include "core/base/interruption.h"
#include "core/base/loop_threads.h"
#include "core/base/thread_pool.h"

namespace taut::detail {

struct SharedLoopTuning {
  /// Bodies that move from which on a thread more pays: their loops take 50 to 200 ns each.  Measured with
  /// two threads.
  static constexpr int kBodiesOfAThread = 3000;
  /// Ranges for each thread, so that a late one finds less to do.
  static constexpr int kRanges = 4;
};

/// For loops over so many bodies that move. @param pool may be null
inline LoopThreads loop_threads(LazyPool* pool, int bodies) {
  return {pool, pool ? std::min(pool->wanted(), bodies / SharedLoopTuning::kBodiesOfAThread) : 1};
}

/// Calls work(begin, end) for ranges that make up [0, count), on these threads.  What comes out must not
/// depend on the ranges.  It is short, and not interrupted.
template <typename Work>
void for_ranges(const LoopThreads& threads, int count, const Work& work) {
  const int ranges = std::min(SharedLoopTuning::kRanges * threads.count, count);
  const auto begin = [&](int k) { return static_cast<int>(std::int64_t{count} * k / ranges); };
  const auto task = [&](int k, int) { work(begin(k), begin(k + 1)); };
  const InterruptScope scope(nullptr);
  threads.pool->get().run(ranges, std::ref(task), threads.count);
}

}  // namespace taut::detail
