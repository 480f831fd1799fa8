// The products that S is made of; included after front_kernels_impl.h, whose remarks apply.
#pragma once

#include "solvers/linear/front_kernels_impl.h"

namespace taut {
namespace {

constexpr int kSix = 6;  // columns of J and W

template <int N>
TAUT_INLINE void store_first(double* p, const Vec& v) {
  if constexpr (N == 4) {
    store(p, v);
  } else {
    double lanes[4];
    store(lanes, v);
    for (int i = 0; i < N; ++i) p[i] = lanes[i];
  }
}

// W of four rows of a side, which are columns of `c` here: out + k·ld for column k of W.
TAUT_INLINE void weigh_strip(const Vec (&c)[kSix], const double* A, const double* T, double t, double* out,
                             Index ld) {
  const auto combine = [](const Vec* v, const double* a) {
    return plus_product(v[2], splat(a[2]), plus_product(v[1], splat(a[1]), multiply(v[0], splat(a[0]))));
  };
  for (int k = 0; k < 3; ++k) {
    store(out + k * ld, combine(c, A + 3 * k));
    store(out + (k + 3) * ld, T != nullptr ? combine(c + 3, T + 3 * k) : multiply(c[k + 3], splat(t)));
  }
}

template <int kRows>
TAUT_INLINE void weigh_side(const double* J, int rows, const double* A, const double* T, double t,
                            double* W) {
  const int n = kRows > 0 ? kRows : rows;
  const Index ld = side_height(n);
  for (int i = 0; i < n; i += 4) {
    Vec left[4], right[4];  // columns 0…3 and 2…5
    for (int r = 0; r < 4; ++r) {
      const double* row = J + kSix * (i + r < n ? i + r : n - 1);
      left[r] = load(row);
      right[r] = load(row + 2);
    }
    transpose(left);
    transpose(right);
    const Vec c[kSix] = {left[0], left[1], left[2], right[1], right[2], right[3]};
    if (A != nullptr) {
      weigh_strip(c, A, T, t, W + i, ld);
    } else {
      for (int k = 0; k < kSix; ++k) store(W + i + k * ld, c[k]);
    }
  }
}

void weigh(const double* J, int rows, const double* A, const double* T, double t, double* W) {
  if (rows == 3)
    weigh_side<3>(J, 3, A, T, t, W);
  else if (rows == 5)
    weigh_side<5>(J, 5, A, T, t, W);
  else
    weigh_side<0>(J, rows, A, T, t, W);
}

void weigh_rows(const double* J, int rows, const double* A, const double* T, double t, double* W) {
  const auto row_of = [](const double* M, int m) { return compose(M[m], M[3 + m], M[6 + m], 0.0); };
  const Vec a[3] = {row_of(A, 0), row_of(A, 1), row_of(A, 2)};
  const Vec b[3] = {T != nullptr ? row_of(T, 0) : compose(t, 0.0, 0.0, 0.0),
                    T != nullptr ? row_of(T, 1) : compose(0.0, t, 0.0, 0.0),
                    T != nullptr ? row_of(T, 2) : compose(0.0, 0.0, t, 0.0)};
  const auto combine = [](const double* v, const Vec(&m)[3]) {
    return plus_product(splat(v[2]), m[2], plus_product(splat(v[1]), m[1], multiply(splat(v[0]), m[0])));
  };
  for (int i = 0; i < rows; ++i, J += kSix, W += kSix) {
    store(W, combine(J, a));
    store_first<3>(W + 3, combine(J + 3, b));
  }
}

// The columns of J; the fourth row repeats the third.
void weigh_arm(const double* arm, double sign, const double* A, const double* T, double t, double* W) {
  const double x = sign * arm[0], y = sign * arm[1], z = sign * arm[2];
  const Vec c[kSix] = {compose(0, -z, y, y),   compose(z, 0, -x, -x),  compose(-y, x, 0, 0),
                       compose(sign, 0, 0, 0), compose(0, sign, 0, 0), compose(0, 0, sign, sign)};
  weigh_strip(c, A, T, t, W, side_height(3));
}

void weigh_arm_rows(const double* arm, double sign, const double* A, const double* T, double t, double* W) {
  const double x = sign * arm[0], y = sign * arm[1], z = sign * arm[2];
  const double J[3 * kSix] = {0, z, -y, sign, 0, 0, -z, 0, x, 0, sign, 0, y, -x, 0, 0, 0, sign};
  weigh_rows(J, 3, A, T, t, W);
}

// N ≤ 4 rows of C, all columns.
template <int N, bool kOverwrite>
TAUT_INLINE void product_strip(const double* W_i, Index ld_i, const double* W_j, Index ld_j, int columns,
                               double* C, Index stride) {
  Vec a[kSix];
  for (int k = 0; k < kSix; ++k) a[k] = load(W_i + k * ld_i);
  for (int c = 0; c < columns; ++c, ++W_j, C += stride) {
    Vec sum = multiply(a[0], splat(W_j[0]));
    for (int k = 1; k < kSix; ++k) sum = plus_product(a[k], splat(W_j[k * ld_j]), sum);
    if constexpr (!kOverwrite) {
      double old[4] = {};
      for (int i = 0; i < N; ++i) old[i] = C[i];
      sum = add(sum, N == 4 ? load(C) : compose(old[0], old[1], old[2], old[3]));
    }
    store_first<N>(C, sum);
  }
}

// Of sizes that the compiler knows, if not 0.
template <int kRows, int kColumns, bool kOverwrite>
TAUT_INLINE void product(const double* W_i, int rows_i, const double* W_j, int rows_j, double* C,
                         Index stride) {
  int rows = kRows > 0 ? kRows : rows_i;
  const int columns = kColumns > 0 ? kColumns : rows_j;
  const Index ld_i = side_height(rows), ld_j = side_height(columns);
  for (; rows >= 4; rows -= 4, W_i += 4, C += 4)
    product_strip<4, kOverwrite>(W_i, ld_i, W_j, ld_j, columns, C, stride);
  if (rows == 1) product_strip<1, kOverwrite>(W_i, ld_i, W_j, ld_j, columns, C, stride);
  if (rows == 2) product_strip<2, kOverwrite>(W_i, ld_i, W_j, ld_j, columns, C, stride);
  if (rows == 3) product_strip<3, kOverwrite>(W_i, ld_i, W_j, ld_j, columns, C, stride);
}

template <bool kOverwrite>
TAUT_INLINE void product_of(const double* W_i, int rows, const double* W_j, int columns, double* C,
                            Index stride) {
  if (rows == 3 && columns == 3)
    product<3, 3, kOverwrite>(W_i, 3, W_j, 3, C, stride);
  else if (rows == 5 && columns == 5)
    product<5, 5, kOverwrite>(W_i, 5, W_j, 5, C, stride);
  else
    product<0, 0, kOverwrite>(W_i, rows, W_j, columns, C, stride);
}

void multiply_sides(const double* W_i, int rows, const double* W_j, int columns, double* C, int stride,
                    bool overwrite) {
  if (overwrite)
    product_of<true>(W_i, rows, W_j, columns, C, stride);
  else
    product_of<false>(W_i, rows, W_j, columns, C, stride);
}

}  // namespace
}  // namespace taut
