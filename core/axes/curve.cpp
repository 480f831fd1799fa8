#include "core/axes/curve.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/check.h"

namespace taut {

Curve::Curve(std::vector<Point> points) : points_(std::move(points)) {
  if (points_.empty()) fail("curve", "must have a point", 0);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const std::string name = "curve point " + std::to_string(i + 1);
    require_finite(name, points_[i].x);
    require_finite(name, points_[i].y);
    if (i > 0 && points_[i].x <= points_[i - 1].x)
      fail(name, "must lie to the right of the point before it", points_[i].x);
  }
}

/// Index of the left end of the piece that holds x, or the nearest one; needs two points.
std::size_t Curve::piece(double x) const {
  const auto right = std::upper_bound(points_.begin() + 1, points_.end() - 1, x,
                                      [](double value, const Point& p) { return value < p.x; });
  return static_cast<std::size_t>(right - points_.begin()) - 1;
}

double Curve::held(double x) const {
  if (!(x > points_.front().x)) return points_.front().y;
  return x < points_.back().x ? extended(x) : points_.back().y;
}

double Curve::extended(double x) const {
  if (points_.size() == 1) return points_[0].y;
  const std::size_t i = piece(x);
  return points_[i].y + slope(x) * (x - points_[i].x);
}

double Curve::slope(double x) const {
  if (points_.size() == 1) return 0;
  const std::size_t i = piece(x);
  return (points_[i + 1].y - points_[i].y) / (points_[i + 1].x - points_[i].x);
}

/// Trapezoids, exact for a function that is linear between its points.
double Curve::integral(double from, double to) const {
  const double low = std::min(from, to), high = std::max(from, to);
  double at = low, sum = 0;
  const auto add = [&](double next) {
    sum += 0.5 * (next - at) * (extended(at) + extended(next));
    at = next;
  };
  for (const Point& p : points_)
    if (p.x > low && p.x < high) add(p.x);
  add(high);
  return from <= to ? sum : -sum;
}

/// d/db (1/(b − a) ∫ f) = (f(b) − mean)/(b − a): in one piece half its slope, and never more than the
/// steepest has, whatever round-off makes of it.
Curve::Mean Curve::mean(double from, double to) const {
  if (points_.size() < 3 || piece(from) == piece(to))
    return {0.5 * (extended(from) + extended(to)), 0.5 * slope(to)};
  const double value = integral(from, to) / (to - from);
  double steepest = 0;
  for (std::size_t i = std::min(piece(from), piece(to)); i <= std::max(piece(from), piece(to)); ++i)
    steepest = std::max(steepest, std::abs(slope(points_[i].x)));
  return {value, std::clamp((extended(to) - value) / (to - from), -steepest, steepest)};
}

}  // namespace taut
