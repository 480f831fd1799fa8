#include "solvers/linear/front_kernels.h"

namespace taut {
namespace {

// Two two-vectors, which every 64-bit processor has.
typedef double Pair __attribute__((vector_size(16)));
typedef double UnalignedPair __attribute__((vector_size(16), aligned(8), may_alias));
struct Vec {
  Pair low, high;
};
// 4×4 numbers are eight of the sixteen registers.
constexpr int kStrips = 1;
constexpr int kPackRows = 96;
constexpr int kPackSize = 3000;

inline Vec zero() { return {Pair{0.0, 0.0}, Pair{0.0, 0.0}}; }
inline Vec load(const double* p) {
  return {*reinterpret_cast<const UnalignedPair*>(p), *reinterpret_cast<const UnalignedPair*>(p + 2)};
}
inline void store(double* p, const Vec& v) {
  *reinterpret_cast<UnalignedPair*>(p) = v.low;
  *reinterpret_cast<UnalignedPair*>(p + 2) = v.high;
}
inline Vec splat(double a) { return {Pair{a, a}, Pair{a, a}}; }
inline Vec compose(double a, double b, double c, double d) { return {Pair{a, b}, Pair{c, d}}; }
inline Vec add(const Vec& a, const Vec& b) { return {a.low + b.low, a.high + b.high}; }
inline Vec multiply(const Vec& a, const Vec& b) { return {a.low * b.low, a.high * b.high}; }
inline Vec minus_product(const Vec& a, const Vec& b, const Vec& c) {
  return {c.low - a.low * b.low, c.high - a.high * b.high};
}
inline Vec plus_product(const Vec& a, const Vec& b, const Vec& c) {
  return {c.low + a.low * b.low, c.high + a.high * b.high};
}
inline double minus_product(double a, double b, double c) { return c - a * b; }
inline void sum_each(const Vec (&v)[4], double (&sums)[4]) {
  for (int k = 0; k < 4; ++k) sums[k] = (v[k].low[0] + v[k].high[0]) + (v[k].low[1] + v[k].high[1]);
}
inline void transpose(Vec (&v)[4]) {
  const Vec w[4] = {v[0], v[1], v[2], v[3]};
  v[0] = {Pair{w[0].low[0], w[1].low[0]}, Pair{w[2].low[0], w[3].low[0]}};
  v[1] = {Pair{w[0].low[1], w[1].low[1]}, Pair{w[2].low[1], w[3].low[1]}};
  v[2] = {Pair{w[0].high[0], w[1].high[0]}, Pair{w[2].high[0], w[3].high[0]}};
  v[3] = {Pair{w[0].high[1], w[1].high[1]}, Pair{w[2].high[1], w[3].high[1]}};
}
constexpr long long kLanes[8] = {-1, -1, -1, -1, 0, 0, 0, 0};
inline Vec first_lanes(int count) { return load(reinterpret_cast<const double*>(kLanes + 4 - count)); }
typedef long long Mask __attribute__((vector_size(16)));
inline Pair keep(Pair a, Pair mask) {
  return reinterpret_cast<Pair>(reinterpret_cast<Mask>(a) & reinterpret_cast<Mask>(mask));
}
inline Vec keep(const Vec& a, const Vec& mask) { return {keep(a.low, mask.low), keep(a.high, mask.high)}; }

}  // namespace
}  // namespace taut

#include "solvers/linear/block_products_impl.h"
#include "solvers/linear/front_kernels_impl.h"
#include "solvers/linear/front_solves_impl.h"

namespace taut {

const FrontKernels& portable_front_kernels() {
  static constexpr FrontKernels kernels{"portable", factor_panel, contribution,   extend_add,
                                        assemble,   forward,      backward,       weigh,
                                        weigh_rows, weigh_arm,    weigh_arm_rows, multiply_sides};
  return kernels;
}

const FrontKernels& front_kernels() {
#if defined(__x86_64__)
  static const bool fast = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (fast && avx2_front_kernels() != nullptr) return *avx2_front_kernels();
#endif
  return portable_front_kernels();
}

}  // namespace taut
