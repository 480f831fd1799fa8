#include "scenes/accuracy/rolling_body.h"

#include <cmath>

namespace taut::reference {
namespace {

/// Orientation, angular velocity in body axes, position of the centre of mass along x and y.
struct RollingPhase {
  Eigen::Vector4d q;  ///< x, y, z, w
  Vec3 w;
  Eigen::Vector2d p;
};

RollingPhase moved(const RollingPhase& y, double h, const RollingPhase& rate) {
  return {y.q + h * rate.q, y.w + h * rate.w, y.p + h * rate.p};
}

Vec3 up_in_body(const Eigen::Vector4d& q) { return Quat(q).normalized().conjugate() * Vec3::UnitZ(); }

/// [v]×, so that cross_matrix(v) x = v × x.
Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

RollingPhase rate_of(const RollingBody& body, const RollingPhase& y) {
  const Vec3 n = up_in_body(y.q), &w = y.w;
  const auto [r, slope] = body.surface(n);
  const Vec3 v = r.cross(w), n_dot = n.cross(w);
  // F = F₀ + m r × ẇ is the force at the contact: m (v̇ + ω × v + g n) with v = r × ω.
  const Vec3 fixed = body.mass * ((slope * n_dot).cross(w) + w.cross(v) + body.gravity * n);
  const Vec3 across = w - w.dot(n) * n;
  const Vec3 resisted =
      body.rolling_arm > 0 && across.norm() > 0 ? Vec3(body.rolling_arm * across.normalized()) : Vec3::Zero();
  const Mat3 R = cross_matrix(r);
  const Mat3 matrix = body.inertia - body.mass * R * R + body.mass * resisted * (n.transpose() * R);
  const Vec3 right = r.cross(fixed) - w.cross(body.inertia * w) - n.dot(fixed) * resisted;
  RollingPhase rate;
  rate.q = 0.5 * (Quat(y.q) * Quat(0, w.x(), w.y(), w.z())).coeffs();
  rate.w = matrix.partialPivLu().solve(right);
  rate.p = (Quat(y.q).normalized() * v).head<2>();
  return rate;
}

RollingState rolling_state(const RollingBody& body, const RollingPhase& y) {
  const Quat q = Quat(y.q).normalized();
  const Vec3 r = body.surface(up_in_body(y.q)).p;
  return {.pose = {.q = q, .p = {y.p.x(), y.p.y(), -(q * r).z()}},
          .twist = {.w = q * y.w, .v = q * r.cross(y.w)}};
}

}  // namespace

SurfacePoint on_ellipsoid(const Vec3& radii, const Vec3& centre, const Vec3& n) {
  const Mat3 A = radii.cwiseAbs2().asDiagonal();
  const Vec3 An = A * n;
  const double s = std::sqrt(n.dot(An));
  return {centre - An / s, -A / s + An * An.transpose() / (s * s * s)};
}

SurfacePoint on_rim(double radius, double half, const Vec3& n) {
  const Vec3 flat(n.x(), n.y(), 0), u = flat.normalized();
  Mat3 across = Mat3::Identity() - u * u.transpose();
  across(2, 2) = 0;
  return {-radius * u - Vec3(0, 0, std::copysign(half, n.z())), -radius / flat.norm() * across};
}

RollingState roll(const RollingBody& body, const RollingState& start, double time, int steps,
                  const std::function<void(double t, const RollingState&)>& watch) {
  const double h = time / steps;
  RollingPhase y{start.pose.q.coeffs(), start.pose.q.conjugate() * start.twist.w, start.pose.p.head<2>()};
  for (int i = 0; i < steps; ++i) {
    const RollingPhase k1 = rate_of(body, y), k2 = rate_of(body, moved(y, h / 2, k1)),
                       k3 = rate_of(body, moved(y, h / 2, k2)), k4 = rate_of(body, moved(y, h, k3));
    y = moved(moved(moved(moved(y, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
    y.q.normalize();
    if (watch) watch((i + 1) * h, rolling_state(body, y));
  }
  return rolling_state(body, y);
}

}  // namespace taut::reference
