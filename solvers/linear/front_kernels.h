#pragma once

#include <cstddef>

namespace taut {

/// `length` consecutive rows: from row `source` of one matrix to row `target` of another.
struct RowRun {
  int source = 0;
  int target = 0;
  int length = 0;
};

/// Dense kernels of assembly and of one front of a multifrontal Cholesky factorisation.  A front has n rows,
/// the first p of which are pivots.  Its panel [L₁₁; L₂₁] is n×p, column-major, with a leading dimension that
/// is a multiple of four; the rows from n to there are padding and hold zeros.  Its contribution C = −L₂₁L₂₁ᵀ
/// is m×m with m = n − p, column-major, lower triangle only.
///
/// The kernels exist twice, for AVX2 with FMA and portably; front_kernels() picks once, by the processor, so
/// that one machine always computes the same bits.  None of them allocates, throws or starts a thread.
struct FrontKernels {
  const char* name;

  /// Panel ← its Cholesky factor, with the reciprocals 1/L_jj on the diagonal.  Returns −1, or the first
  /// column whose pivot is not a positive number.  `pack` holds packed_size(n) numbers.  `stop`, if not null,
  /// is asked now and then whether to give up, which leaves anything in the panel and returns kStopped.
  int (*factor_panel)(double* panel, int ld, int n, int p, double* pack, bool (*stop)());

  /// C ← −L₂₁L₂₁ᵀ.  Reads up to three numbers behind the last column of L₂₁, and writes up to three rows of
  /// padding.  False if `stop` had it given up.
  bool (*contribution)(double* C, int ldc, const double* L21, int ld, int m, int p, double* pack,
                       bool (*stop)());

  /// Adds the columns of runs [first, last) of a child's contribution, rows from the diagonal down, to the
  /// parent's matrix: target(t_i, t_j) += source(s_i, s_j).  Reads
  /// up to three numbers behind both matrices, and writes back those behind the target.
  void (*extend_add)(double* target, int ldt, const double* source, int lds, const RowRun* runs, int first,
                     int last, int count);

  /// Copies a block column of A, `width` columns of `length` numbers each, into the columns of a panel, from
  /// the diagonal down.
  void (*assemble)(double* panel, int ld, const double* values, int length, int width, const RowRun* runs,
                   int count);

  /// Forward substitution with a front: x₁ ← L₁₁⁻¹x₁, x₂ ← x₂ − L₂₁x₁, where row i of the front is
  /// x[rows[i]].  `rows` has ld entries, those of the padding being any of the others; y is scratch of ld
  /// numbers.
  void (*forward)(const double* panel, int ld, int n, int p, const int* rows, double* x, double* y);

  /// Backward substitution with a front: x₁ ← L₁₁⁻ᵀ(x₁ − L₂₁ᵀx₂).
  void (*backward)(const double* panel, int ld, int p, const int* rows, double* x, double* y);

  /// W = J A by columns, for products: J is `rows`×6, row after row, A = diag(rotation, translation) has 3×3
  /// blocks, column-major, and a translation that is null means `scale` 1₃.  Column k is W + k ld with ld =
  /// side_height(rows); what is behind the last row repeats it.  A rotation that is null means A = 1₆.
  void (*weigh)(const double* J, int rows, const double* rotation, const double* translation, double scale,
                double* W);

  /// weigh() with W laid out like J.
  void (*weigh_rows)(const double* J, int rows, const double* rotation, const double* translation,
                     double scale, double* W);

  /// Both for J = sign (−[arm]×, 1), which has three rows.
  void (*weigh_arm)(const double* arm, double sign, const double* rotation, const double* translation,
                    double scale, double* W);
  void (*weigh_arm_rows)(const double* arm, double sign, const double* rotation, const double* translation,
                         double scale, double* W);

  /// C ← W_i W_jᵀ, or C + W_i W_jᵀ, of W by columns; the columns of C are `stride` apart.
  void (*multiply_sides)(const double* W_i, int rows, const double* W_j, int columns, double* C, int stride,
                         bool overwrite);
};

/// Leading dimension of W by columns.
static constexpr int side_height(int rows) { return (rows + 3) & ~3; }

/// What factor_panel() returns when it was told to give up.
constexpr int kStopped = -2;

/// Columns that the blocked kernels take at a time.
constexpr int kPanelWidth = 64;
constexpr int kContributionDepth = 128;

/// Size of the packing buffer for fronts of up to n rows.
constexpr std::size_t packed_size(int n) { return (static_cast<std::size_t>(n) + 16) * kContributionDepth; }

/// The fastest kernels that this processor runs.
const FrontKernels& front_kernels();
const FrontKernels& portable_front_kernels();
/// Null where the compiler did not build them; the processor must have AVX2 and FMA.
const FrontKernels* avx2_front_kernels();

}  // namespace taut
