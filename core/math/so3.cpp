#include "core/math/so3.h"

namespace taut {
namespace {

/// Cosine below which 1 + cosine has lost three digits.
constexpr double kNearlyOpposite = -0.999;
/// Sine below which directions are opposite but for round-off.
constexpr double kOpposite = 1e-15;

}  // namespace

void complete_frame(const Vec3& z, Vec3& x, Vec3& y) {
  Eigen::Index smallest;
  z.cwiseAbs().minCoeff(&smallest);
  x = z.cross(Vec3::Unit(smallest)).normalized();
  y = z.cross(x);
}

Quat relative(const Quat& q_WA, const Quat& q_WF) { return (q_WA.conjugate() * q_WF).normalized(); }

Quat rotation_between(const Vec3& from, const Vec3& to) {
  const Vec3 a = from.normalized(), b = to.normalized();
  const double cosine = b.dot(a);
  if (cosine > kNearlyOpposite) {
    const double twice = std::sqrt(2 * (1 + cosine));
    Quat q;
    q.vec() = a.cross(b) * (1 / twice);
    q.w() = 0.5 * twice;
    return q;
  }
  // About what is across a, so that its own round-off is one of the plane of the turn only; of opposite
  // directions any is.
  Vec3 axis = a.cross(b), other;
  const double sine = axis.norm();
  axis -= axis.dot(a) * a;
  if (axis.norm() < kOpposite) complete_frame(a, axis, other);
  Quat q;
  q.vec() = (1 - cosine) * axis.normalized();
  q.w() = sine;
  return q.normalized();
}

Vec3 across(const Vec3& v, const Vec3& axis) {
  const Vec3 part = v - v.dot(axis) * axis;
  if (part.norm() > 1e-6) return part.normalized();
  Vec3 x, y;
  complete_frame(axis, x, y);
  return x;
}

Vec3 log_so3(const Quat& q) {
  const Vec3 v = q.w() < 0 ? Vec3(-q.vec()) : Vec3(q.vec());
  const double sine = v.norm(), cosine = std::abs(q.w());
  if (sine < 1e-8) return 2 * v / cosine;
  return 2 * std::atan2(sine, cosine) / sine * v;
}

}  // namespace taut
