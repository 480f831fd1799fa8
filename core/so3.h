#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace taut {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// Unit quaternion w, x, y, z.  Not over-aligned, so that its layout is the same under any compiler flags.
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

/// [v]×, so that skew(v) u = v × u.
inline Mat3 skew(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Rotation by |θ| [rad] about θ.
inline Quat exp_so3(const Vec3& theta) {
  const double angle = theta.norm();
  const double scale = angle < 1e-8 ? 0.5 - angle * angle / 48 : std::sin(0.5 * angle) / angle;
  return Quat(std::cos(0.5 * angle), scale * theta.x(), scale * theta.y(), scale * theta.z());
}

/// Rotation vector of q [rad], |θ| ≤ π: the inverse of exp_so3 up to the sign of q.
inline Vec3 log_so3(const Quat& q) {
  const Vec3 v = q.w() < 0 ? Vec3(-q.vec()) : Vec3(q.vec());
  const double sine = v.norm(), cosine = std::abs(q.w());
  if (sine < 1e-8) return 2 * v / cosine;
  return 2 * std::atan2(sine, cosine) / sine * v;
}

/// Two unit vectors that complete the unit vector z to a right-handed frame (x, y, z).
inline void complete_frame(const Vec3& z, Vec3& x, Vec3& y) {
  Eigen::Index smallest;
  z.cwiseAbs().minCoeff(&smallest);
  x = z.cross(Vec3::Unit(smallest)).normalized();
  y = z.cross(x);
}

/// Direction of the part of v across the unit vector `axis`; any direction across it where that vanishes.
inline Vec3 across(const Vec3& v, const Vec3& axis) {
  const Vec3 part = v - v.dot(axis) * axis;
  if (part.norm() > 1e-6) return part.normalized();
  Vec3 x, y;
  complete_frame(axis, x, y);
  return x;
}

}  // namespace taut
