#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace taut {

using Vec3 = Eigen::Vector3d;  ///< a vector of ℝ³
using Mat3 = Eigen::Matrix3d;  ///< a 3 × 3 matrix
/// Unit quaternion w, x, y, z.  Not over-aligned, so that its layout is the same under any compiler flags.
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

/// Cross-product matrix [v]×, so that skew(v) u = v × u.
inline Mat3 skew(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Orientation of F in A from those of both in W, q_WA* q_WF, of unit length.
Quat relative(const Quat& q_WA, const Quat& q_WF);

/// q v q*.  Written out in scalars: Eigen's goes through the stack in pieces of another width than it comes
/// back in, for which the processor waits longer than the product takes; and inline, since a call takes as
/// long.
[[gnu::always_inline]] inline Vec3 rotate(const Quat& q, const Vec3& v) {
  const double x = q.x(), y = q.y(), z = q.z(), w = q.w();
  const double tx = 2 * (y * v[2] - z * v[1]), ty = 2 * (z * v[0] - x * v[2]), tz = 2 * (x * v[1] - y * v[0]);
  return {v[0] + w * tx + (y * tz - z * ty), v[1] + w * ty + (z * tx - x * tz),
          v[2] + w * tz + (x * ty - y * tx)};
}

/// sin(x)/x and cos(x) of x².  Small angles, as in a step, need neither a root nor the library's sine: series
/// to round-off.
struct SincCosine {
  double sinc, cosine;  ///< sin(x)/x, or cos(x)
};
[[gnu::always_inline]] inline SincCosine sinc_cosine(double x2) {  ///< of x2 = x² ≥ 0
  if (x2 > 0.1) {
    const double x = std::sqrt(x2);
    return {std::sin(x) / x, std::cos(x)};
  }
  // Σ (−x²)ᵏ/(2k + 1)! and Σ (−x²)ᵏ/(2k)!, in pairs of terms that do not wait for each other.
  const double x4 = x2 * x2, x8 = x4 * x4;
  return {((1 - x2 * (1.0 / 6)) + x4 * (1.0 / 120 - x2 * (1.0 / 5040))) +
              x8 * ((1.0 / 362880 - x2 * (1.0 / 39916800)) + x4 * (1.0 / 6227020800)),
          ((1 - x2 * 0.5) + x4 * (1.0 / 24 - x2 * (1.0 / 720))) +
              x8 * ((1.0 / 40320 - x2 * (1.0 / 3628800)) + x4 * (1.0 / 479001600))};
}

/// Rotation by |θ| [rad] about θ: the unit quaternion (cos |θ|/2, sin(|θ|/2) θ/|θ|).
inline Quat exp_so3(const Vec3& theta) {
  const double x = theta[0], y = theta[1], z = theta[2];
  const auto [sinc, cosine] = sinc_cosine(0.25 * (x * x + y * y + z * z));
  const double half = 0.5 * sinc;
  return Quat(cosine, half * x, half * y, half * z);
}

/// Rotation vector of q [rad], |θ| ≤ π: the inverse of exp_so3 up to the sign of q.
Vec3 log_so3(const Quat& q);

/// Two unit vectors that complete the unit vector z to a right-handed frame (x, y, z).
void complete_frame(const Vec3& z, Vec3& x, Vec3& y);

/// The rotation by the least angle that takes the direction of `from` to that of `to`.
Quat rotation_between(const Vec3& from, const Vec3& to);

/// Unit vector along the part of v across the unit vector `axis`; any across it where that vanishes.
Vec3 across(const Vec3& v, const Vec3& axis);

/// The part of v across the unit vector n.
inline Vec3 tangential(const Vec3& v, const Vec3& n) {
  const double along = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
  return {v[0] - along * n[0], v[1] - along * n[1], v[2] - along * n[2]};
}

/// rotation_between(m, n) v of unit vectors m and n that are not opposite, and of a v across m.
inline Vec3 carried(const Vec3& v, const Vec3& m, const Vec3& n) {
  const double along = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
  const double part = along / (1 + (n[0] * m[0] + n[1] * m[1] + n[2] * m[2]));
  return {v[0] - part * (n[0] + m[0]), v[1] - part * (n[1] + m[1]), v[2] - part * (n[2] + m[2])};
}

}  // namespace taut
