#pragma once

#include <Eigen/Core>
#include <vector>

namespace taut {
/// Cubic spline through points at increasing parameters, twice continuously differentiable.  An open one ends
/// with curvature 0 and goes on straight; a closed one returns to its first point (which is given again as
/// the last) with the same derivatives and repeats.  Dimensions are 1, 2 and 3.
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
  CubicSpline(std::vector<double> parameters, std::vector<Vector> given_points, bool closed = false);

  /// The spline of the points R p + d: R turns derivatives along, since they are linear in the points.
  CubicSpline moved(const Eigen::Matrix<double, Dimension, Dimension>& R, const Vector& d) const;

  double first_parameter() const { return t_.front(); }         ///< of the first point
  double length() const { return t_.back() - t_.front(); }      ///< of the range of parameters
  bool closed() const { return closed_; }                       ///< it repeats beyond its ends
  const std::vector<double>& parameters() const { return t_; }  ///< one per point

  At at(double t) const;  ///< at any parameter

 private:
  At straight(std::size_t i, const Vector& slope, double beyond) const;

  std::vector<double> t_;
  std::vector<Vector> p_, m_;
  bool closed_ = false;
};

extern template class CubicSpline<1>;  // motions
extern template class CubicSpline<2>;
extern template class CubicSpline<3>;  // curves

}  // namespace taut
