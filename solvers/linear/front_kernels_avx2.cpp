// The build gives this file -mavx2 -mfma on x86-64; without them it is empty.
#include "solvers/linear/front_kernels.h"

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
inline Vec splat(double a) { return _mm256_set1_pd(a); }
inline Vec compose(double a, double b, double c, double d) { return _mm256_set_pd(d, c, b, a); }
inline Vec add(Vec a, Vec b) { return _mm256_add_pd(a, b); }
inline Vec multiply(Vec a, Vec b) { return _mm256_mul_pd(a, b); }
inline Vec minus_product(Vec a, Vec b, Vec c) { return _mm256_fnmadd_pd(a, b, c); }
inline Vec plus_product(Vec a, Vec b, Vec c) { return _mm256_fmadd_pd(a, b, c); }
inline double minus_product(double a, double b, double c) { return __builtin_fma(-a, b, c); }
inline void sum_each(const Vec (&v)[4], double (&sums)[4]) {
  const Vec low = _mm256_hadd_pd(v[0], v[1]), high = _mm256_hadd_pd(v[2], v[3]);
  const Vec crossed = _mm256_permute2f128_pd(low, high, 0x21), straight = _mm256_blend_pd(low, high, 0xC);
  store(sums, _mm256_add_pd(crossed, straight));
}
inline void transpose(Vec (&v)[4]) {
  const Vec a = _mm256_unpacklo_pd(v[0], v[1]), b = _mm256_unpackhi_pd(v[0], v[1]);
  const Vec c = _mm256_unpacklo_pd(v[2], v[3]), d = _mm256_unpackhi_pd(v[2], v[3]);
  v[0] = _mm256_permute2f128_pd(a, c, 0x20);
  v[1] = _mm256_permute2f128_pd(b, d, 0x20);
  v[2] = _mm256_permute2f128_pd(a, c, 0x31);
  v[3] = _mm256_permute2f128_pd(b, d, 0x31);
}
alignas(32) constexpr long long kLanes[8] = {-1, -1, -1, -1, 0, 0, 0, 0};
inline Vec first_lanes(int count) {
  return _mm256_loadu_pd(reinterpret_cast<const double*>(kLanes + 4 - count));
}
inline Vec keep(Vec a, Vec mask) { return _mm256_and_pd(a, mask); }

}  // namespace
}  // namespace taut

#include "solvers/linear/block_products_impl.h"
#include "solvers/linear/front_kernels_impl.h"
#include "solvers/linear/front_solves_impl.h"

namespace taut {

const FrontKernels* avx2_front_kernels() {
  static constexpr FrontKernels kernels{"AVX2",     factor_panel, contribution,   extend_add,
                                        assemble,   forward,      backward,       weigh,
                                        weigh_rows, weigh_arm,    weigh_arm_rows, multiply_sides};
  return &kernels;
}

}  // namespace taut

#else

namespace taut {
const FrontKernels* avx2_front_kernels() { return nullptr; }
}  // namespace taut

#endif
