#pragma once

namespace taut::detail {

class LazyPool;

/// So many threads of a pool for loops (core/base/shared_loop.h); one: they are not shared.
struct LoopThreads {
  LazyPool* pool = nullptr;
  int count = 1;

  explicit operator bool() const { return count > 1; }
};

}  // namespace taut::detail
