#include "core/math/spline.h"

#include <Eigen/LU>

namespace taut {

/// h_{i−1} m_{i−1} + 2 (h_{i−1} + h_i) m_i + h_i m_{i+1} = 6 (slope_i − slope_{i−1}), m = second
/// derivatives at the points; made once, hence dense.
Eigen::MatrixXd detail::spline_second_derivatives(const std::vector<double>& t, const Eigen::MatrixXd& points,
                                                  bool closed) {
  const Eigen::Index n = points.rows();
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, points.cols());
  const auto h = [&](Eigen::Index i) { return t[i + 1] - t[i]; };
  const auto slope = [&](Eigen::Index i) -> Eigen::RowVectorXd {
    return (points.row(i + 1) - points.row(i)) / h(i);
  };
  // The row of the point between pieces `i0` and `i1`, which lies between two other points.
  const auto add = [&](Eigen::Index row, Eigen::Index before, Eigen::Index after, Eigen::Index i0,
                       Eigen::Index i1) {
    A.row(row).setZero();
    A(row, before) += h(i0);
    A(row, row) += 2 * (h(i0) + h(i1));
    A(row, after) += h(i1);
    right.row(row) = 6 * (slope(i1) - slope(i0));
  };
  for (Eigen::Index i = 1; i + 1 < n; ++i) add(i, i - 1, i + 1, i - 1, i);
  if (closed) {
    add(0, n - 2, 1, n - 2, 0);
    A.row(n - 1).setZero();
    A(n - 1, n - 1) = 1;
    A(n - 1, 0) = -1;
  }
  return A.partialPivLu().solve(right);
}

template class CubicSpline<1>;
template class CubicSpline<3>;

}  // namespace taut
