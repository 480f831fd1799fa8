#pragma once

#include <cstdint>
#include <functional>

#include "core/base/interruption.h"
#include "core/base/thread_pool.h"

namespace taut::detail {

struct SharedLoopTuning {
  /// Items, of 50 to 200 ns each, from which on waking threads pays. Measured.
  static constexpr int kFrom = 4000;
  /// Ranges for each thread, so that a late one finds less to do.
  static constexpr int kRanges = 4;
};

/// Calls work(begin, end) for ranges that make up [0, count), on all threads of a pool.  What comes out must
/// not depend on the ranges.  It is short, and not interrupted.
template <typename Work>
void for_ranges(LazyPool& threads, int count, const Work& work) {
  ThreadPool& pool = threads.get();
  const int ranges = SharedLoopTuning::kRanges * pool.size();
  const auto begin = [&](int k) { return static_cast<int>(std::int64_t{count} * k / ranges); };
  const auto task = [&](int k, int) { work(begin(k), begin(k + 1)); };
  const InterruptScope scope(nullptr);
  pool.run(ranges, std::ref(task));
}

}  // namespace taut::detail
