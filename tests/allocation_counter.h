#pragma once

#include <cstddef>  // defines __GLIBC__

#include "tests/sanitized.h"

/// Counts allocations of the whole program; operator new calls malloc.  A sanitizer has its own malloc, so
/// there are no such tests there.
#if defined(__GLIBC__) && !defined(TAUT_SANITIZED)
#define TAUT_COUNTS_ALLOCATIONS 1

namespace taut {
/// Calls of malloc, calloc, realloc, aligned_alloc and posix_memalign so far.
long allocation_count();
}  // namespace taut
#endif
