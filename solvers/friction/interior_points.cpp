#include "solvers/friction/interior_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {
namespace {

using Vector = Eigen::VectorXd;
using Law = ScaledFriction::Law;

/// Products and quotients of the algebra of the cone |x_t| ≤ x_0.  @{
Vec3 arrow(const Vec3& a, const Vec3& b) {
  Vec3 c = a[0] * b + b[0] * a;
  c[0] = a.dot(b);
  return c;
}
double determinant(const Vec3& v) {
  const double t = std::hypot(v[1], v[2]);
  return std::max((v[0] - t) * (v[0] + t), std::numeric_limits<double>::min());
}
Vec3 arrow_quotient(const Vec3& a, const Vec3& c) {
  Vec3 x;
  x[0] = (a[0] * c[0] - a.tail<2>().dot(c.tail<2>())) / determinant(a);
  x.tail<2>() = (c.tail<2>() - x[0] * a.tail<2>()) / a[0];
  return x;
}  /// @}

/// How far v may go along d within the cone.
double way_in_cone(const Vec3& v, const Vec3& d) {
  const double tangent = std::hypot(v[1], v[2]);
  const double c = (v[0] - tangent) * (v[0] + tangent), b = v[0] * d[0] - v.tail<2>().dot(d.tail<2>());
  const double a = d[0] * d[0] - d.tail<2>().squaredNorm(), discriminant = b * b - a * c;
  double way = std::numeric_limits<double>::infinity();
  const auto meet = [&](double at) {
    if (std::isfinite(at) && at > 0) way = std::min(way, at);
  };
  if (discriminant >= 0) {
    const double root = std::sqrt(discriminant), sum = -(b + (b >= 0 ? root : -root));
    meet(sum / a);
    meet(c / sum);
  }
  if (d[0] < 0) meet(-v[0] / d[0]);
  return way;
}

}  // namespace

InteriorPoints::InteriorPoints(const ScaledFriction& friction)
    : y(Vector::Zero(friction.rows())),
      z(Vector::Zero(friction.rows())),
      P(Vector::Ones(friction.rows())),
      problem(friction) {
  const double size = std::max(problem.largest_q(), std::numeric_limits<double>::min());
  for (const auto& [law, first, n, mu] : problem.blocks()) {
    if (law == Law::kEquality) continue;
    if (law == Law::kCone) P[first] = 1 / mu;
    y[first] = InteriorPointsTuning::kFirstImpulse * size;
    z[first] = InteriorPointsTuning::kFirstRate * size;
    ++cones_;
  }
}

double InteriorPoints::gap() const { return y.dot(z) / cones_; }

double InteriorPoints::gap_after(double part, const Vector& dy, const Vector& dz) const {
  return (y + part * dy).dot(z + part * dz) / cones_;
}

Vector InteriorPoints::residual(double smooth) const {
  Vector residual = problem.rates(impulses()).cwiseProduct(P) - z;
  for (const auto& [law, first, n, mu] : problem.blocks())
    if (law == Law::kCone) residual[first] += std::hypot(std::hypot(z[first + 1], z[first + 2]), smooth);
  return residual;
}

double InteriorPoints::off_centre(double centre) const {
  double off = 0;
  for (const auto& [law, first, n, mu] : problem.blocks()) {
    if (law == Law::kUnilateral) off = std::max(off, std::abs(y[first] * z[first] / centre - 1));
    if (law != Law::kCone) continue;
    const Vec3 a = y.segment<3>(first), b = z.segment<3>(first);
    const double dot = a.dot(b), product = determinant(a) * determinant(b);
    const double large = dot + std::sqrt(std::max(0.0, dot * dot - product));
    off = std::max({off, std::abs(large / centre - 1), std::abs(product / (large * centre) - 1)});
  }
  return off;
}

double InteriorPoints::way(const Vector& dy, const Vector& dz, double boundary, double most) const {
  double part = most;
  for (const auto& [law, first, n, mu] : problem.blocks()) {
    if (law == Law::kUnilateral)
      for (const auto& [v, d] : {std::pair(y[first], dy[first]), std::pair(z[first], dz[first])})
        if (d < 0) part = std::min(part, -boundary * v / d);
    if (law == Law::kCone) {
      part = std::min(part, boundary * way_in_cone(y.segment<3>(first), dy.segment<3>(first)));
      part = std::min(part, boundary * way_in_cone(z.segment<3>(first), dz.segment<3>(first)));
    }
  }
  return part;
}

InteriorNewton::InteriorNewton(const InteriorPoints& at, double smooth)
    : problem_(at.problem), at_(at), scaling_(problem_.blocks().size()) {
  for (int b = 0; b < std::ssize(scaling_); ++b) scale(b, smooth);
  assemble();
}

template <typename Function>
void InteriorNewton::each_cone(const Function& function) const {
  for (int b = 0; b < std::ssize(scaling_); ++b)
    if (const auto& block = problem_.blocks()[b]; block.law != Law::kEquality)
      function(scaling_[b], block.first, block.size);
}

void InteriorNewton::scale(int b, double smooth) {
  const auto& [law, first, n, mu] = problem_.blocks()[b];
  Scaling& s = scaling_[b];
  if (law == Law::kUnilateral) {
    const double y = at_.y[first], z = at_.z[first];
    s.T(0, 0) = std::sqrt(y / z);
    s.inverse(0, 0) = std::sqrt(z / y);
    s.inverse_squared(0, 0) = z / y;
    s.lambda[0] = std::sqrt(y * z);
  }
  if (law != Law::kCone) return;
  const Vec3 y = at_.y.segment<3>(first), z = at_.z.segment<3>(first);
  const double det_y = determinant(y), det_z = determinant(z);
  const Vec3 unit_y = y / std::sqrt(det_y), unit_z = z / std::sqrt(det_z);
  const double gamma = std::sqrt((1 + unit_y.dot(unit_z)) / 2), eta = std::pow(det_y / det_z, 0.25);
  const Vec3 w = (unit_y + Vec3(unit_z[0], -unit_z[1], -unit_z[2])) / (2 * gamma);
  const Eigen::Vector2d t = w.tail<2>();
  s.T << w[0], t.transpose(), t, Eigen::Matrix2d::Identity() + t * t.transpose() / (1 + w[0]);
  s.inverse = s.T / eta;
  s.inverse.topRightCorner<1, 2>() *= -1;
  s.inverse.bottomLeftCorner<2, 1>() *= -1;
  s.T *= eta;
  s.inverse_squared = s.inverse * s.inverse;
  s.lambda = s.T * z;
  if (const double slip = std::hypot(std::hypot(z[1], z[2]), smooth); slip > 0)
    s.G.topRightCorner<1, 2>() -= z.tail<2>().transpose() / slip;
}

/// D W D + G T⁻² + compliance.
void InteriorNewton::assemble() {
  for (int b = 0; b < std::ssize(scaling_); ++b) {
    const auto& block = problem_.blocks()[b];
    const Mat3 more = block.law == Law::kEquality
                          ? Mat3(InteriorPointsTuning::kEqualityCompliance * Mat3::Identity())
                          : Mat3(scaling_[b].G * scaling_[b].inverse_squared);
    const int diagonal = problem_.diagonal(block);
    for (int i = 0; i < block.size; ++i) {
      const int row = block.first + i;
      const auto columns = problem_.columns(row);
      const auto values = problem_.values(row);
      for (int k = 0; k < std::ssize(columns); ++k) {
        double value = at_.P[row] * values[k] * at_.P[columns[k]];
        if (const int j = k - diagonal; j >= 0 && j < block.size)
          value += more(i, j) + (i == j ? InteriorPointsTuning::kCompliance * at_.P[row] * at_.P[row] : 0);
        matrix_.column.push_back(columns[k]);
        matrix_.values.push_back(value);
      }
      matrix_.row_start.push_back(static_cast<int>(matrix_.column.size()));
    }
  }
}

bool InteriorNewton::direction(const Vector& right, const Vector& residual, double part, Vector& dy,
                               Vector& dz) {
  Vector b = -part * residual;
  dz = Vector::Zero(problem_.rows());
  each_cone([&](const Scaling& s, int first, int n) {
    if (n == 1) {
      dz[first] = s.inverse(0, 0) * right[first] / s.lambda[0];
      b[first] += dz[first];
    } else {
      const Vec3 k = s.inverse * arrow_quotient(s.lambda, right.segment<3>(first));
      dz.segment<3>(first) = k;
      b.segment<3>(first) += s.G * k;
    }
  });
  dy.resize(problem_.rows());
  const auto size = static_cast<std::size_t>(problem_.rows());
  if (!factor_.solve({b.data(), size}, {dy.data(), size})) return false;
  each_cone([&](const Scaling& s, int first, int n) {
    if (n == 1)
      dz[first] -= s.inverse_squared(0, 0) * dy[first];
    else
      dz.segment<3>(first) -= s.inverse_squared * dy.segment<3>(first);
  });
  return dz.allFinite();
}

Vector InteriorNewton::to_centre(double centre) const {
  Vector out = unit(centre);
  each_cone([&](const Scaling& s, int first, int n) {
    if (n == 1)
      out[first] -= s.lambda[0] * s.lambda[0];
    else
      out.segment<3>(first) -= arrow(s.lambda, s.lambda);
  });
  return out;
}

Vector InteriorNewton::unit(double centre) const {
  Vector out = Vector::Zero(problem_.rows());
  each_cone([&](const Scaling&, int first, int) { out[first] = centre; });
  return out;
}

Vector InteriorNewton::second_order(const Vector& dy, const Vector& dz) const {
  Vector out = Vector::Zero(problem_.rows());
  each_cone([&](const Scaling& s, int first, int n) {
    if (n == 1)
      out[first] = dy[first] * dz[first];
    else
      out.segment<3>(first) = arrow(s.inverse * dy.segment<3>(first), s.T * dz.segment<3>(first));
  });
  return out;
}

double InteriorNewton::inner(const Vector& dy, const Vector& dz, const Vector& ey, const Vector& ez) const {
  double sum = 0;
  each_cone([&](const Scaling& s, int first, int n) {
    if (n == 1)
      sum += s.inverse_squared(0, 0) * dy[first] * ey[first] + s.T(0, 0) * s.T(0, 0) * dz[first] * ez[first];
    else
      sum += (s.inverse * dy.segment<3>(first)).dot(s.inverse * ey.segment<3>(first)) +
             (s.T * dz.segment<3>(first)).dot(s.T * ez.segment<3>(first));
  });
  return sum;
}

}  // namespace taut
