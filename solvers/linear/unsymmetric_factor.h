#pragma once

#include <memory>
#include <span>
#include <vector>

namespace taut {

/// A sparse square matrix in compressed rows, columns ascending in each.
struct RowMatrix {
  std::vector<int> row_start{0}, column;
  std::vector<double> values;

  int size() const { return static_cast<int>(row_start.size()) - 1; }
};

/// P A Q = L U of an unsymmetric matrix, by Eigen's SparseLU: as fast here as UMFPACK, whose licence would
/// bind the library's users (solvers/linear, "Unsymmetric matrices").
class UnsymmetricFactor {
 public:
  UnsymmetricFactor();
  ~UnsymmetricFactor();

  /// False if A is singular; solve() must not be called then.
  [[nodiscard]] bool factorize(const RowMatrix& A);
  /// x = A⁻¹ b, refined once.  False if it is not finite.
  [[nodiscard]] bool solve(std::span<const double> b, std::span<double> x) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace taut
