#pragma once

#include <cstddef>  // defines __GLIBC__

/// Counts allocations of the whole program; operator new calls malloc.  A sanitizer has its own malloc, so
/// there are no such tests there.
#if defined(__has_feature)  // clang's way to say so
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define TAUT_SANITIZED 1
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TAUT_SANITIZED 1
#endif
#if defined(__GLIBC__) && !defined(TAUT_SANITIZED)
#define TAUT_COUNTS_ALLOCATIONS 1

namespace taut {
/// Calls of malloc, calloc, realloc, aligned_alloc and posix_memalign so far.
long allocation_count();
}  // namespace taut
#endif
