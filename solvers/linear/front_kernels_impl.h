// The kernels of front_kernels.h, written once over a vector of four doubles.  Included by
// front_kernels_portable.cpp and front_kernels_avx2.cpp, which define Vec, zero(), load(), store(), splat(),
// compose(), transpose(), multiply(), add(), first_lanes(), keep(), minus_product(a, b, c) = c − ab,
// plus_product(a, b, c) = c + ab, sum_each() and kStrips, the height in vectors of a register tile.
// Everything is in an unnamed namespace and nothing of the standard library is instantiated: the two copies,
// compiled for different processors, must not be merged by the linker.
#pragma once

#include "solvers/linear/front_kernels.h"

namespace taut {
namespace {

using Index = std::ptrdiff_t;

#define TAUT_INLINE inline __attribute__((always_inline))

// Rows of a matrix in strips of four: row 4s + r of column k is base[s·strip + k·column + r].  Describes a
// column-major matrix (strip = 4, column = ld) as well as a packed one, whose strips lie one after the other
// (strip = 4K, column = 4).
struct Strips {
  const double* base;
  Index strip;
  Index column;
};

// c ← c − A Bᵀ, with S strips of A, N ≤ 4 rows of B and K columns of both.  The S×N vectors of c stay in
// registers.
template <int S, int N>
TAUT_INLINE void accumulate(Vec (&c)[S][N], const double* a, Index a_strip, Index a_column, const double* b,
                            Index b_column, int K) {
  for (int k = 0; k < K; ++k) {
    Vec column[S];
    for (int s = 0; s < S; ++s) column[s] = load(a + s * a_strip);
    for (int j = 0; j < N; ++j) {
      const Vec b_j = splat(b[j]);
      for (int s = 0; s < S; ++s) c[s][j] = minus_product(column[s], b_j, c[s][j]);
    }
    a += a_column;
    b += b_column;
  }
}

template <int S, int N>
TAUT_INLINE void load_tile(Vec (&c)[S][N], const double* C, Index ldc) {
  for (int j = 0; j < N; ++j)
    for (int s = 0; s < S; ++s) c[s][j] = load(C + 4 * s + j * ldc);
}

template <int S, int N>
TAUT_INLINE void store_tile(const Vec (&c)[S][N], double* C, Index ldc) {
  for (int j = 0; j < N; ++j)
    for (int s = 0; s < S; ++s) store(C + 4 * s + j * ldc, c[s][j]);
}

// C ← −A Bᵀ or C − A Bᵀ on one tile; B's rows are one strip of the same matrix.
template <bool kOverwrite, int S, int N>
TAUT_INLINE void update_tile(double* C, Index ldc, const Strips& X, Index row_strip, Index column_strip,
                             int K) {
  Vec c[S][N];
  if constexpr (kOverwrite) {
    for (int j = 0; j < N; ++j)
      for (int s = 0; s < S; ++s) c[s][j] = zero();
  } else {
    load_tile<S, N>(c, C, ldc);
  }
  accumulate<S, N>(c, X.base + row_strip * X.strip, X.strip, X.column, X.base + column_strip * X.strip,
                   X.column, K);
  store_tile<S, N>(c, C, ldc);
}

template <bool kOverwrite, int S>
TAUT_INLINE void update_tile_n(double* C, Index ldc, const Strips& X, Index row_strip, Index column_strip,
                               int N, int K) {
  switch (N) {
    case 1:
      return update_tile<kOverwrite, S, 1>(C, ldc, X, row_strip, column_strip, K);
    case 2:
      return update_tile<kOverwrite, S, 2>(C, ldc, X, row_strip, column_strip, K);
    case 3:
      return update_tile<kOverwrite, S, 3>(C, ldc, X, row_strip, column_strip, K);
    default:
      return update_tile<kOverwrite, S, 4>(C, ldc, X, row_strip, column_strip, K);
  }
}

// Lower trapezoid of C (rows × columns, columns ≤ rows) ← −X Xᵀ or C − X Xᵀ.  The outer loop takes as many
// strips of rows as fit into registers, the inner one runs along the rows' columns up to the diagonal; so the
// strips stay in the first-level cache while the rest of X streams by, once per tile row.  False if `stop`
// had it given up.
template <bool kOverwrite>
bool update_trapezoid(double* C, Index ldc, int rows, int columns, const Strips& X, int K, bool (*stop)()) {
  const int strips = (rows + 3) / 4, column_strips = (columns + 3) / 4;
  for (int s = 0; s < strips; s += kStrips) {
    if (stop && stop()) return false;
    const int height = strips - s < kStrips ? strips - s : kStrips;
    const int last = column_strips < s + height ? column_strips : s + height;
    for (int j = 0; j < last; ++j) {
      const int N = columns - 4 * j < 4 ? columns - 4 * j : 4;
      const int top = j > s ? j : s;  // strips above the diagonal are left out
      double* tile = C + 4 * top + 4 * j * ldc;
      switch (s + height - top) {
        case 1:
          update_tile_n<kOverwrite, 1>(tile, ldc, X, top, j, N, K);
          break;
        case 2:
          update_tile_n<kOverwrite, 2 <= kStrips ? 2 : 1>(tile, ldc, X, top, j, N, K);
          break;
        default:
          update_tile_n<kOverwrite, kStrips>(tile, ldc, X, top, j, N, K);
          break;
      }
    }
  }
  return true;
}

// Packs `rows` rows (up to three more are read) of K columns into strips.
Strips pack_strips(const double* X, Index ld, int rows, int K, double* pack) {
  const int strips = (rows + 3) / 4;
  for (int k = 0; k < K; ++k) {
    const double* from = X + k * ld;
    double* to = pack + 4 * k;
    for (int s = 0; s < strips; ++s) store(to + Index{4} * K * s, load(from + 4 * s));
  }
  return {pack, Index{4} * K, 4};
}

// Packing costs one pass over X and pays where X would not stay in the first-level cache or is used often.
TAUT_INLINE Strips strips_of(const double* X, Index ld, int rows, int K, double* pack) {
  if (rows < kPackRows || rows * ld < kPackSize / K) return {X, 4, ld};
  return pack_strips(X, ld, rows, K, pack);
}

// Cholesky of an N×N tile and of the tile's rows N..3, in t[column][row].  The triangle is kept as L = U D^½
// with U unit lower triangular: the strictly lower part holds U, the diagonal 1/L_jj = d_j^−½.  In the
// recurrences of the solves that leaves one product between a row and the next; and here the square roots
// come off the path from pivot to pivot.
template <int N>
TAUT_INLINE int factor_tile(double (&t)[N][4]) {
  double inverse[N];
  for (int j = 0; j < N; ++j) {
    const double d = t[j][j];
    if (!(d > 0.0 && d <= __DBL_MAX__)) return j;
    inverse[j] = 1.0 / d;
    for (int k = j + 1; k < N; ++k) {
      const double u = t[j][k] * inverse[j];
      for (int i = k; i < 4; ++i) t[k][i] = minus_product(t[j][i], u, t[k][i]);
    }
  }
  for (int j = 0; j < N; ++j) {
    const double r = __builtin_sqrt(inverse[j]);
    t[j][j] = r;
    for (int i = 0; i < j; ++i) t[j][i] = 0.0;
    for (int i = j + 1; i < 4; ++i) t[j][i] *= i < N ? inverse[j] : r;
  }
  return -1;
}

// S strips of N columns: update with the columns on the left, then X ← X U⁻ᵀ D^−½ with the factored tile; in
// registers.
template <int S, int N>
TAUT_INLINE void finish_strips(double* X, Index ld, const double* left, const double* left_pivots, int K,
                               const double (&t)[N][4]) {
  Vec c[S][N];
  load_tile<S, N>(c, X, ld);
  accumulate<S, N>(c, left, 4, ld, left_pivots, ld, K);
  for (int k = 0; k < N; ++k) {
    for (int j = k + 1; j < N; ++j) {
      const Vec u = splat(t[k][j]);
      for (int s = 0; s < S; ++s) c[s][j] = minus_product(c[s][k], u, c[s][j]);
    }
  }
  for (int j = 0; j < N; ++j) {
    const Vec r = splat(t[j][j]);
    for (int s = 0; s < S; ++s) c[s][j] = multiply(c[s][j], r);
  }
  store_tile<S, N>(c, X, ld);
}

// Columns j..j+N−1 of a panel whose columns on the left are done (left-looking).  D points to the panel's
// diagonal, rows is a multiple of four.
template <int N>
int factor_columns(double* D, Index ld, int rows, int j) {
  double t[N][4];
  {
    Vec c[1][N];
    load_tile<1, N>(c, D + j + j * ld, ld);
    accumulate<1, N>(c, D + j, 4, ld, D + j, ld, j);
    for (int k = 0; k < N; ++k) store(t[k], c[0][k]);
  }
  const int failed = factor_tile<N>(t);
  if (failed >= 0) return j + failed;
  for (int k = 0; k < N; ++k) store(D + j + (j + k) * ld, load(t[k]));
  double* X = D + j * ld;
  int i = j + 4;
  for (; i + 4 * kStrips <= rows; i += 4 * kStrips) finish_strips<kStrips, N>(X + i, ld, D + i, D + j, j, t);
  if constexpr (kStrips > 2) {
    if (i + 8 <= rows) finish_strips<2, N>(X + i, ld, D + i, D + j, j, t), i += 8;
  }
  for (; i < rows; i += 4) finish_strips<1, N>(X + i, ld, D + i, D + j, j, t);
  return -1;
}

int factor_columns_n(double* D, Index ld, int rows, int j, int N) {
  switch (N) {
    case 1:
      return factor_columns<1>(D, ld, rows, j);
    case 2:
      return factor_columns<2>(D, ld, rows, j);
    case 3:
      return factor_columns<3>(D, ld, rows, j);
    default:
      return factor_columns<4>(D, ld, rows, j);
  }
}

// Right-looking over blocks of kPanelWidth columns, left-looking over four columns within a block.
int factor_panel(double* panel, int ld, int n, int p, double* pack, bool (*stop)()) {
  (void)n;  // the padding is computed with the rows, and stays zero
  for (int begin = 0; begin < p; begin += kPanelWidth) {
    const int end = p - begin < kPanelWidth ? p : begin + kPanelWidth;
    double* D = panel + begin + Index{begin} * ld;
    for (int j = 0; j < end - begin; j += 4) {
      const int failed = factor_columns_n(D, ld, ld - begin, j, end - begin - j);
      if (failed >= 0) return begin + failed;
    }
    if (end == p) break;
    const Strips X = strips_of(panel + end + Index{begin} * ld, ld, ld - end, end - begin, pack);
    if (!update_trapezoid<false>(panel + end + Index{end} * ld, ld, ld - end, p - end, X, end - begin, stop))
      return kStopped;
  }
  return -1;
}

bool contribution(double* C, int ldc, const double* L21, int ld, int m, int p, double* pack, bool (*stop)()) {
  for (int begin = 0; begin < p; begin += kContributionDepth) {
    const int K = p - begin < kContributionDepth ? p - begin : kContributionDepth;
    const Strips X = strips_of(L21 + Index{begin} * ld, ld, m, K, pack);
    const bool done = begin == 0 ? update_trapezoid<true>(C, ldc, m, m, X, K, stop)
                                 : update_trapezoid<false>(C, ldc, m, m, X, K, stop);
    if (!done) return false;
  }
  return true;
}

// Adds up to four rows as one vector, whose last lanes add zero: `mask` keeps the first lanes.
TAUT_INLINE void add_masked(double* to, const double* from, Vec mask) {
  store(to, add(load(to), keep(load(from), mask)));
}

TAUT_INLINE void add_rows(double* to, const double* from, int length) {
  int i = 0;
  for (; i + 4 <= length; i += 4) store(to + i, add(load(to + i), load(from + i)));
  if (i < length) add_masked(to + i, from + i, first_lanes(length - i));
}

// For pairs of runs (a, b), a's columns times b's rows.  Most runs are one or two blocks; a run of up to four
// rows is one masked vector per column.
void extend_add(double* target, int ldt, const double* source, int lds, const RowRun* runs, int first,
                int last, int count) {
  for (int a = first; a < last; ++a) {
    const int width = runs[a].length;
    double* to = target + Index{runs[a].target} * ldt;
    const double* from = source + Index{runs[a].source} * lds;
    for (int j = 0; j < width; ++j)
      add_rows(to + runs[a].target + j + Index{j} * ldt, from + runs[a].source + j + Index{j} * lds,
               width - j);
    for (int b = a + 1; b < count; ++b) {
      double* to_b = to + runs[b].target;
      const double* from_b = from + runs[b].source;
      const int length = runs[b].length;
      if (length <= 4) {
        const Vec mask = first_lanes(length);
        for (int j = 0; j < width; ++j, to_b += ldt, from_b += lds) add_masked(to_b, from_b, mask);
      } else {
        for (int j = 0; j < width; ++j, to_b += ldt, from_b += lds) add_rows(to_b, from_b, length);
      }
    }
  }
}

TAUT_INLINE void copy_rows(double* to, const double* from, int length) {
  int i = 0;
  for (; i + 4 <= length; i += 4) store(to + i, load(from + i));
  for (; i < length; ++i) to[i] = from[i];
}

// The first run of a block column starts at the diagonal block's first row; what is above the diagonal is
// left out.
void assemble(double* panel, int ld, const double* values, int length, int width, const RowRun* runs,
              int count) {
  for (int j = 0; j < width; ++j) {
    copy_rows(panel + runs[0].target + j, values + runs[0].source + j, runs[0].length - j);
    for (int r = 1; r < count; ++r)
      copy_rows(panel + runs[r].target, values + runs[r].source, runs[r].length);
    panel += ld;
    values += length;
  }
}

}  // namespace
}  // namespace taut
