// The build gives this file -mavx2 -mfma on x86-64; without them it is empty.
#include "solvers/front_kernels.h"

#if defined(__AVX2__) && defined(__FMA__)

#include <immintrin.h>

namespace taut {
namespace {

using Vec = __m256d;
// 3×4 accumulators, 3 vectors of A and one of B fill the sixteen registers.
constexpr int kStrips = 3;
constexpr int kPackRows = 96;
constexpr int kPackSize = 3000;

inline Vec zero() { return _mm256_setzero_pd(); }
inline Vec load(const double* p) { return _mm256_loadu_pd(p); }
inline void store(double* p, Vec v) { _mm256_storeu_pd(p, v); }
inline Vec broadcast(const double* p) { return _mm256_broadcast_sd(p); }
inline Vec add(Vec a, Vec b) { return _mm256_add_pd(a, b); }
inline Vec multiply(Vec a, Vec b) { return _mm256_mul_pd(a, b); }
inline Vec minus_product(Vec a, Vec b, Vec c) { return _mm256_fnmadd_pd(a, b, c); }
inline Vec plus_product(Vec a, Vec b, Vec c) { return _mm256_fmadd_pd(a, b, c); }
inline double sum(Vec v) {
  const __m128d pairs = _mm_add_pd(_mm256_castpd256_pd128(v), _mm256_extractf128_pd(v, 1));
  return _mm_cvtsd_f64(_mm_add_sd(pairs, _mm_unpackhi_pd(pairs, pairs)));
}
inline void add_pair(double* to, const double* from) {
  _mm_storeu_pd(to, _mm_add_pd(_mm_loadu_pd(to), _mm_loadu_pd(from)));
}

}  // namespace
}  // namespace taut

#include "solvers/front_kernels_impl.h"

namespace taut {

const FrontKernels* avx2_front_kernels() {
  static constexpr FrontKernels kernels{"AVX2", factor_panel, contribution, extend_add, forward, backward};
  return &kernels;
}

}  // namespace taut

#else

namespace taut {
const FrontKernels* avx2_front_kernels() { return nullptr; }
}  // namespace taut

#endif
