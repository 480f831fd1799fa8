#pragma once

#include <cmath>

#include "solvers/system/mass_matrix.h"

/// The kinetic flow of a free rigid body over a time h: momenta (linear and angular, world axes) are
/// constant, only the pose moves. (solvers/integrators, Eq. 4)
namespace taut {

namespace detail {

// Quaternions are handled as four numbers with indices known to the compiler, so that they stay in registers.

/// Rotation about body axis I, applied on the right, by twice the angle with this sine and cosine.
template <int I>
void rotate_right(Quat& q, double sine, double cosine) {
  constexpr int J = (I + 1) % 3, K = (I + 2) % 3;
  double* v = q.coeffs().data();  // x, y, z, w
  const double w = v[3], vi = v[I], vj = v[J], vk = v[K];
  v[3] = cosine * w - sine * vi;
  v[I] = cosine * vi + sine * w;
  v[J] = cosine * vj + sine * vk;
  v[K] = cosine * vk - sine * vj;
}

/// q ← exp(θ) q.
inline void rotate_left(const Vec3& theta, Quat& q) {
  const auto [sinc, c] =
      sinc_cosine(0.25 * (theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2]));
  const double s = 0.5 * sinc, a = s * theta[0], b = s * theta[1], d = s * theta[2];
  const double x = q.x(), y = q.y(), z = q.z(), w = q.w();
  q = Quat(c * w - (a * x + b * y + d * z), c * x + w * a + (b * z - d * y), c * y + w * b + (d * x - a * z),
           c * z + w * d + (a * y - b * x));
}

/// A turn about principal axis I for `time`: angular momentum m stays in space, so it turns back in the body.
template <int I>
void turn(const MassMatrix::Body& body, double time, Quat& q, Vec3& m) {
  constexpr int J = (I + 1) % 3, K = (I + 2) % 3;
  const double half = 0.5 * time * m[I] * body.inverse_moments[I];
  const auto [sinc, c] = sinc_cosine(half * half);
  const double s = half * sinc;
  rotate_right<I>(q, s, c);
  const double sine = 2 * s * c, cosine = 1 - 2 * s * s, mj = m[J], mk = m[K];
  m[J] = cosine * mj + sine * mk;
  m[K] = cosine * mk - sine * mj;
}

/// Five rotations about the principal axes, x y z y x [Dullweber1997]: order 2, symplectic, time-reversible.
inline void rotate_split(const MassMatrix::Body& body, const Vec3& L, double h, Quat& q) {
  Vec3 m = q.conjugate() * L;  // angular momentum in principal axes
  turn<0>(body, 0.5 * h, q, m);
  turn<1>(body, 0.5 * h, q, m);
  turn<2>(body, h, q, m);
  turn<1>(body, 0.5 * h, q, m);
  turn<0>(body, 0.5 * h, q, m);
}

/// Exact for two equal moments I_t: a rotation about L at the rate |L| / I_t after one about the symmetry
/// axis I at the rate L_I (1/I_I − 1/I_t).
template <int I>
[[gnu::always_inline]] inline void rotate_symmetric(const MassMatrix::Body& body, const Vec3& L, double h,
                                                    Quat& q) {
  constexpr int J = (I + 1) % 3, K = (I + 2) % 3;
  const double across = body.inverse_moments[J], excess = body.inverse_moments[I] - across;
  if (excess != 0) {
    // L along the axis: column I of the rotation matrix, written out.
    const double *v = q.coeffs().data(), w = v[3], vi = v[I], vj = v[J], vk = v[K];
    const double along =
        L[I] * (1 - 2 * (vj * vj + vk * vk)) + 2 * (L[J] * (vi * vj + w * vk) + L[K] * (vi * vk - w * vj));
    const double half = 0.5 * h * excess * along;
    const auto [sinc, cosine] = sinc_cosine(half * half);
    rotate_right<I>(q, half * sinc, cosine);
  }
  rotate_left(h * across * L, q);
}

/// Turns the principal axes.
[[gnu::always_inline]] inline void rotate(const MassMatrix::Body& body, const Vec3& L, double h, Quat& q) {
  switch (body.symmetry_axis) {
    case 0:
      return rotate_symmetric<0>(body, L, h, q);
    case 1:
      return rotate_symmetric<1>(body, L, h, q);
    case 2:
      return rotate_symmetric<2>(body, L, h, q);
    default:
      return rotate_split(body, L, h, q);
  }
}

}  // namespace detail

/// Pose of body b after time h.
[[gnu::always_inline]] inline Pose free_flow(const MassMatrix& mass, int b, const Pose& pose, const Vec3& L,
                                             const Vec3& P, double h) {
  const MassMatrix::Body& body = mass[b];
  Quat q = body.principal ? pose.q : Quat(pose.q * mass.inertia(b).q_BP);
  detail::rotate(body, L, h, q);
  if (!body.principal) q = q * mass.inertia(b).q_BP.conjugate();
  // One Newton step towards |q| = 1; its round-off drift over millions of steps would otherwise show.
  const double x = q.x(), y = q.y(), z = q.z(), w = q.w();
  const double scale = 1.5 - 0.5 * ((x * x + y * y) + (z * z + w * w));
  q = Quat(scale * w, scale * x, scale * y, scale * z);
  return {q, pose.p + h * body.inverse_mass * P};
}

}  // namespace taut
