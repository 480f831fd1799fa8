#pragma once

namespace taut {

/// Calls of malloc, calloc, realloc, aligned_alloc and posix_memalign by the whole program so far; operator
/// new calls malloc.  0 where nothing counts: with a sanitizer, which has a malloc of its own, and without
/// glibc.
long allocation_count();

}  // namespace taut
