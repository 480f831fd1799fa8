#include "solvers/integrators/reduced/orthogonal_triangles.h"

#include <Eigen/QR>

namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct TrianglesTuning {
  /// Rows of a joint whose share beyond the others is below this part of the largest depend on them.  Without
  /// a unit.
  static constexpr double kDependent = 1e-9;
};

}  // namespace

bool invert_rows(const SixColumns& J_transposed, Eigen::Matrix<double, 6, Eigen::Dynamic>& inverse,
                 SixColumns* null_space) {
  const Eigen::Index m = J_transposed.cols();
  Eigen::ColPivHouseholderQR<SixColumns> qr;
  qr.setThreshold(TrianglesTuning::kDependent);
  qr.compute(J_transposed);
  if (qr.rank() != m) return false;
  // J⁺ = Q R⁻ᵀ Pᵀ
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
  Square right = Square::Identity(m, m);
  right.applyOnTheLeft(qr.colsPermutation().transpose());
  qr.matrixQR().topLeftCorner(m, m).triangularView<Eigen::Upper>().transpose().solveInPlace(right);
  Eigen::Matrix<double, 6, 6> Q = Eigen::Matrix<double, 6, 6>::Identity();
  Q.applyOnTheLeft(qr.householderQ());
  inverse.noalias() = Q.leftCols(m).lazyProduct(right);
  if (null_space != nullptr) *null_space = Q.rightCols(6 - m);
  return true;
}

}  // namespace taut
