#include "tests/allocation_counter.h"

#include <cstddef>

#ifdef TAUT_COUNTS_ALLOCATIONS
#include <atomic>

static std::atomic<long> counted{0};

extern "C" void* __libc_malloc(std::size_t);
extern "C" void* malloc(std::size_t size) {
  counted.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}

long taut::allocation_count() { return counted.load(); }
#endif
