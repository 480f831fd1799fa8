#include "tests/allocation_counter.h"

#include <cstddef>

#if defined(__GLIBC__) && !TAUT_CHECKED
#include <atomic>
#include <cerrno>

static std::atomic<long> counted{0};

// glibc's own, behind the names that this program takes over; new and CHOLMOD use those.
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* __libc_calloc(std::size_t, std::size_t);
extern "C" void* __libc_realloc(void*, std::size_t);
extern "C" void* __libc_memalign(std::size_t, std::size_t);

static void count() { counted.fetch_add(1, std::memory_order_relaxed); }

extern "C" void* malloc(std::size_t size) noexcept {
  count();
  return __libc_malloc(size);
}

extern "C" void* calloc(std::size_t number, std::size_t size) noexcept {
  count();
  return __libc_calloc(number, size);
}

extern "C" void* realloc(void* old, std::size_t size) noexcept {
  count();
  return __libc_realloc(old, size);
}

extern "C" void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  count();
  return __libc_memalign(alignment, size);
}

extern "C" int posix_memalign(void** result, std::size_t alignment, std::size_t size) noexcept {
  count();
  *result = __libc_memalign(alignment, size);
  return *result ? 0 : ENOMEM;
}

long taut::allocation_count() { return counted.load(); }
#else
long taut::allocation_count() { return 0; }
#endif
