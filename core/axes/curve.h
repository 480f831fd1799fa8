#pragma once

#include <cstddef>
#include <vector>

namespace taut {

/// A function given by points, linear between them.
class Curve {
 public:
  struct Point {          ///< One point of the function.
    double x = 0, y = 0;  ///< argument, or value
  };
  /// @throws std::invalid_argument if there is no point, one is not finite, or x does not increase strictly.
  explicit Curve(std::vector<Point> points);

  /// Value at x, held constant beyond the ends.
  double held(double x) const;
  /// Value at x, where the first and last piece go on beyond the ends; a single point is a constant.
  double extended(double x) const;
  /// dy/dx of the piece that extended() uses at x; the right one at a point.
  double slope(double x) const;
  /// ∫ extended(x) dx.
  double integral(double from, double to) const;
  /// Mean of extended() over an interval, and its derivative by the upper end.
  struct Mean {
    double value = 0, slope = 0;  ///< mean, or ∂mean/∂to
  };
  Mean mean(double from, double to) const;                      ///< of extended() between both
  const std::vector<Point>& points() const { return points_; }  ///< as given

 private:
  std::size_t piece(double x) const;
  std::vector<Point> points_;
};

}  // namespace taut
