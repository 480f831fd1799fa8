#pragma once

#include <unistd.h>

#include <cstdlib>

namespace taut::benchmarks {

/// OpenBLAS starts its threads when it is loaded, and they wait by spinning: an engine that calls LAPACK, or
/// only links it, would be charged for that, Siconos four times its work on matrices of 171 rows.  So a
/// program that is measured starts itself again with one thread.
inline void use_one_blas_thread(char** argv) {
  constexpr const char* kThreads = "OPENBLAS_NUM_THREADS";
  if (std::getenv(kThreads) || setenv(kThreads, "1", 0) != 0) return;
  execv("/proc/self/exe", argv);  // comes back only if it fails
}

}  // namespace taut::benchmarks
