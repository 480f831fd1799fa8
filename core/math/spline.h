#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/check.h"

namespace taut {
namespace detail {
/// Second derivatives of the spline below at its points, one row each [n × dimension].
Eigen::MatrixXd spline_second_derivatives(const std::vector<double>& t, const Eigen::MatrixXd& points,
                                          bool closed);
}  // namespace detail

/// Cubic spline through points at increasing parameters, twice continuously differentiable.  An open one ends
/// with curvature 0 and goes on straight; a closed one returns to its first point (which is given again as
/// the last) with the same derivatives and repeats.
template <int Dimension>
class CubicSpline {
 public:
  using Vector = Eigen::Matrix<double, Dimension, 1>;  ///< a point
  struct At {                                          ///< The spline and its derivatives at one parameter.
    Vector value, first, second, third;  ///< s(t), ds/dt, d²s/dt² and d³s/dt³, in this order
  };

  CubicSpline() = default;
  /// @throws std::invalid_argument if there are fewer than two points (three for a closed curve), numbers of
  /// parameters and points differ, one is not finite, parameters do not increase strictly, or the ends of a
  /// closed curve differ.
  CubicSpline(std::vector<double> parameters, std::vector<Vector> given_points, bool closed = false)
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
    const Eigen::MatrixXd m = detail::spline_second_derivatives(t_, points, closed);
    for (std::size_t i = 0; i < p_.size(); ++i) m_.push_back(m.row(i).transpose());
  }

  /// The spline of the points R p + d: R turns derivatives along, since they are linear in the points.
  CubicSpline moved(const Eigen::Matrix<double, Dimension, Dimension>& R, const Vector& d) const {
    CubicSpline copy = *this;
    for (Vector& p : copy.p_) p = R * p + d;
    for (Vector& m : copy.m_) m = R * m;
    return copy;
  }

  double first_parameter() const { return t_.front(); }         ///< of the first point
  double last_parameter() const { return t_.back(); }           ///< of the last point
  double length() const { return t_.back() - t_.front(); }      ///< of the range of parameters
  bool closed() const { return closed_; }                       ///< it repeats beyond its ends
  const std::vector<double>& parameters() const { return t_; }  ///< one per point

  At at(double t) const {  ///< at any parameter
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

 private:
  At straight(std::size_t i, const Vector& slope, double beyond) const {
    return {p_[i] + beyond * slope, slope, Vector(Vector::Zero()), Vector(Vector::Zero())};
  }
  std::vector<double> t_;
  std::vector<Vector> p_, m_;
  bool closed_ = false;
};

extern template class CubicSpline<1>;  // motions
extern template class CubicSpline<3>;  // curves

}  // namespace taut
