#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace taut {

/// A sparse symmetric matrix in elimination order: one triangle in compressed columns, made of dense blocks.
/// Scalar row r belongs to block k with block_start[k] ≤ r < block_start[k + 1].  Blocks on the diagonal are
/// stored whole (both triangles of the block); readers use the triangle that they need.  Row indices ascend
/// in each column, and all columns of a block have the same row indices.
struct SymmetricMatrix {
  enum class Triangle { kLower, kUpper };
  Triangle triangle = Triangle::kLower;
  std::vector<int> block_start{0};
  std::vector<int> column_start{0};
  std::vector<int> row_index;
  std::vector<double> values;

  int size() const { return block_start.back(); }
  int block_count() const { return static_cast<int>(block_start.size()) - 1; }
};

/// A Cholesky-type factorisation A = L D Lᵀ with symbolic and numeric work apart.  The order of elimination
/// is that of the matrix: whoever builds it has ordered it (block_ordering.h), and its elimination tree is
/// postordered.
class Factor {
 public:
  virtual ~Factor() = default;

  /// The triangle that factorize() wants its matrix in.
  virtual SymmetricMatrix::Triangle triangle() const = 0;
  /// Symbolic factorisation; once per pattern.  The numeric calls below then allocate nothing (after a first
  /// one).
  virtual void analyze(const SymmetricMatrix& A) = 0;
  /// Numeric factorisation of a matrix with the analysed pattern.  Returns −1, or the first column whose
  /// pivot was not positive; then solve() must not be called, and relative_pivots() says nothing.
  [[nodiscard]] virtual int factorize(const SymmetricMatrix& A) = 0;
  /// x ← A⁻¹ x, in elimination order.
  virtual void solve(std::span<double> x) = 0;
  /// The pivots D_ii > 0 (L_ii² of an L Lᵀ form), each as a part of A_ii, in elimination order.
  virtual std::span<const double> relative_pivots() const = 0;

  virtual std::string name() const = 0;
  virtual double flops() const = 0;           ///< of one numeric factorisation
  virtual std::int64_t nonzeros() const = 0;  ///< of L

  /// How the order of elimination was found, for reports.
  std::string_view ordering() const { return ordering_; }
  void set_ordering(std::string_view method) { ordering_ = method; }

 private:
  std::string_view ordering_;
};

}  // namespace taut
