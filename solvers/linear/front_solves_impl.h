// The solves of front_kernels.h; included after front_kernels_impl.h, whose remarks apply.
#pragma once

#include "solvers/linear/front_kernels_impl.h"

namespace taut {
namespace {

// The solves read x through the front's list of rows, and keep in y, in the front's order, what vectors need.
// A vector is never loaded from where single numbers have just been stored, and z stays in registers: either
// would make each front wait for the one before it.

// Forward substitution of N columns at j.  y holds minus the products of the columns on the left with their
// solution; within the tile, z = U⁻¹(x + y) first and D^−½z then; the tile's product is taken off the rows
// below.
template <int N, bool kFirst>
TAUT_INLINE void forward_columns(const double* panel, Index ld, Index j, const int* rows, double* x,
                                 double* y) {
  const double* D = panel + j + j * ld;
  double z[N];
  for (int k = 0; k < N; ++k) z[k] = kFirst ? x[rows[j + k]] : x[rows[j + k]] + y[j + k];
  for (int k = 0; k < N; ++k)
    for (int i = k + 1; i < N; ++i) z[i] = minus_product(D[i + k * ld], z[k], z[i]);
  for (int k = 0; k < N; ++k) {
    z[k] *= D[k + k * ld];
    x[rows[j + k]] = z[k];
  }
  Vec v[N];
  for (int k = 0; k < N; ++k) v[k] = splat(z[k]);
  const double* X = panel + j * ld;
  for (Index i = N < 4 ? j : j + 4; i < ld; i += 4) {
    Vec r = kFirst ? zero() : load(y + i);
    for (int k = 0; k < N; ++k) r = minus_product(load(X + i + k * ld), v[k], r);
    store(y + i, r);
  }
}

void forward(const double* panel, int ld, int n, int p, const int* rows, double* x, double* y) {
  const Index last = p & ~3;
  if (last > 0) forward_columns<4, true>(panel, ld, 0, rows, x, y);
  for (Index j = 4; j < last; j += 4) forward_columns<4, false>(panel, ld, j, rows, x, y);
  switch (p - last + (last > 0 ? 4 : 0)) {
    case 1:
      forward_columns<1, true>(panel, ld, last, rows, x, y);
      break;
    case 2:
      forward_columns<2, true>(panel, ld, last, rows, x, y);
      break;
    case 3:
      forward_columns<3, true>(panel, ld, last, rows, x, y);
      break;
    case 5:
      forward_columns<1, false>(panel, ld, last, rows, x, y);
      break;
    case 6:
      forward_columns<2, false>(panel, ld, last, rows, x, y);
      break;
    case 7:
      forward_columns<3, false>(panel, ld, last, rows, x, y);
      break;
    default:
      break;
  }
  for (int i = p; i < n; ++i) x[rows[i]] += y[i];
}

// N dot products with the rows below, then backward substitution within the tile: z = U⁻ᵀ D^−½ (x − sums).
template <int N>
TAUT_INLINE void backward_columns(const double* panel, Index ld, Index j, const int* rows, double* x,
                                  double* y) {
  const double* D = panel + j + j * ld;
  const double* X = panel + j * ld;
  Vec sums[4];
  for (int k = 0; k < 4; ++k) sums[k] = zero();
  Index i = j + 4;
  if (i + 16 <= ld) {
    Vec more[N];
    for (int k = 0; k < N; ++k) more[k] = zero();
    for (; i + 8 <= ld; i += 8) {
      const Vec r = load(y + i), r_next = load(y + i + 4);
      for (int k = 0; k < N; ++k) {
        sums[k] = plus_product(load(X + i + k * ld), r, sums[k]);
        more[k] = plus_product(load(X + i + 4 + k * ld), r_next, more[k]);
      }
    }
    for (int k = 0; k < N; ++k) sums[k] = add(sums[k], more[k]);
  }
  for (; i < ld; i += 4) {
    const Vec r = load(y + i);
    for (int k = 0; k < N; ++k) sums[k] = plus_product(load(X + i + k * ld), r, sums[k]);
  }
  double z[4];
  sum_each(sums, z);
  for (int k = 0; k < N; ++k) {
    z[k] = x[rows[j + k]] - z[k];
    for (int l = N; l < 4; ++l) z[k] = minus_product(D[l + k * ld], x[rows[j + l]], z[k]);
    z[k] *= D[k + k * ld];
  }
  for (int k = N - 1; k >= 0; --k)
    for (int l = 0; l < k; ++l) z[l] = minus_product(D[k + l * ld], z[k], z[l]);
  for (int k = 0; k < N; ++k) x[rows[j + k]] = z[k];
  for (int k = N; k < 4; ++k) z[k] = x[rows[j + k]];
  store(y + j, compose(z[0], z[1], z[2], z[3]));
}

void backward(const double* panel, int ld, int p, const int* rows, double* x, double* y) {
  for (Index i = (p + 3) & ~3; i < ld; i += 4)
    store(y + i, compose(x[rows[i]], x[rows[i + 1]], x[rows[i + 2]], x[rows[i + 3]]));
  Index j = p & ~3;
  switch (p - j) {
    case 1:
      backward_columns<1>(panel, ld, j, rows, x, y);
      break;
    case 2:
      backward_columns<2>(panel, ld, j, rows, x, y);
      break;
    case 3:
      backward_columns<3>(panel, ld, j, rows, x, y);
      break;
    default:
      break;
  }
  for (j -= 4; j >= 0; j -= 4) backward_columns<4>(panel, ld, j, rows, x, y);
}

}  // namespace
}  // namespace taut
