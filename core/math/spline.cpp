#include "core/math/spline.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/check.h"
#include "core/math/dense.h"

namespace taut {
namespace {

/// Of the spline at its points, one row each [n × dimension]:
///   h_{i−1} m_{i−1} + 2 (h_{i−1} + h_i) m_i + h_i m_{i+1} = 6 (slope_i − slope_{i−1}), m = second
/// derivatives; made once, hence dense.
Eigen::MatrixXd second_derivatives(const std::vector<double>& t, const Eigen::MatrixXd& points, bool closed) {
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
  return dense::solve(A, right);
}

}  // namespace

template <int Dimension>
CubicSpline<Dimension>::CubicSpline(std::vector<double> parameters, std::vector<Vector> given_points,
                                    bool closed)
    : t_(std::move(parameters)), p_(std::move(given_points)), closed_(closed) {
  const std::size_t least = closed ? 4 : 2;
  if (p_.size() < least) fail("spline", "must have more points", p_.size());
  if (t_.size() != p_.size()) fail("spline", "must have one parameter per point", t_.size());
  for (std::size_t i = 0; i < p_.size(); ++i) {
    require_all_finite("spline point " + std::to_string(i + 1), p_[i]);
    require_finite("spline parameter " + std::to_string(i + 1), t_[i]);
    if (i > 0 && t_[i] <= t_[i - 1])
      fail("spline parameter " + std::to_string(i + 1), "must exceed the one before it", t_[i]);
  }
  if (closed && p_.front() != p_.back())
    fail_with("spline", "must end where it starts to be closed", p_.back());
  Eigen::MatrixXd points(p_.size(), Dimension);
  for (std::size_t i = 0; i < p_.size(); ++i) points.row(i) = p_[i].transpose();
  const Eigen::MatrixXd m = second_derivatives(t_, points, closed);
  for (std::size_t i = 0; i < p_.size(); ++i) m_.push_back(m.row(i).transpose());
}

template <int Dimension>
CubicSpline<Dimension> CubicSpline<Dimension>::moved(const Eigen::Matrix<double, Dimension, Dimension>& R,
                                                     const Vector& d) const {
  CubicSpline copy = *this;
  for (Vector& p : copy.p_) p = R * p + d;
  for (Vector& m : copy.m_) m = R * m;
  return copy;
}

template <int Dimension>
typename CubicSpline<Dimension>::At CubicSpline<Dimension>::at(double t) const {
  if (closed_) t -= length() * std::floor((t - t_.front()) / length());
  const auto right = std::upper_bound(t_.begin() + 1, t_.end() - 1, t);
  const auto i = static_cast<std::size_t>(right - t_.begin()) - 1;
  const double h = t_[i + 1] - t_[i];
  const Vector slope = (p_[i + 1] - p_[i]) / h;
  if (!closed_ && t < t_.front()) return straight(i, slope - h / 6 * m_[i + 1], t - t_[i]);
  if (!closed_ && t > t_.back()) return straight(i + 1, slope + h / 6 * m_[i], t - t_[i + 1]);
  const double a = t_[i + 1] - t, b = t - t_[i];
  At out;
  out.third = (m_[i + 1] - m_[i]) / h;
  out.second = (a * m_[i] + b * m_[i + 1]) / h;
  out.first = slope + ((b * b / 2 - h * h / 6) * m_[i + 1] - (a * a / 2 - h * h / 6) * m_[i]) / h;
  out.value = (a * p_[i] + b * p_[i + 1]) / h + (a * a - h * h) * a / (6 * h) * m_[i] +
              (b * b - h * h) * b / (6 * h) * m_[i + 1];
  return out;
}

template <int Dimension>
typename CubicSpline<Dimension>::At CubicSpline<Dimension>::straight(std::size_t i, const Vector& slope,
                                                                     double beyond) const {
  return {p_[i] + beyond * slope, slope, Vector(Vector::Zero()), Vector(Vector::Zero())};
}

template class CubicSpline<1>;
template class CubicSpline<2>;
template class CubicSpline<3>;

}  // namespace taut
