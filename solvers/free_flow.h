#pragma once

#include <cmath>

#include "solvers/mass_matrix.h"

/// The kinetic flow of a free rigid body over a time h: momentum P and angular momentum L (world axes) are
/// constant, only the pose moves. (solvers/README, Eq. 3)
namespace taut {

namespace detail {

/// Rotation by twice the angle with this sine and cosine about body axis i, applied on the right:
/// q ← q exp(angle e_i).
inline void rotate_right(Quat& q, int i, double sine, double cosine) {
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  double* v = q.coeffs().data();  // x, y, z, w
  const double w = v[3], vi = v[i], vj = v[j], vk = v[k];
  v[3] = cosine * w - sine * vi;
  v[i] = cosine * vi + sine * w;
  v[j] = cosine * vj + sine * vk;
  v[k] = cosine * vk - sine * vj;
}

/// Five rotations about the principal axes, x y z y x [Dullweber1997]: order 2, symplectic, time-reversible.
inline Quat rotate_split(const MassMatrix::Body& body, Quat q, const Vec3& L, double h) {
  Vec3 m = q.conjugate() * L;  // angular momentum in principal axes
  const auto turn = [&](int i, double time) {
    const double half = 0.5 * time * m[i] * body.inverse_moments[i];
    const auto [sinc, c] = sinc_cosine(half * half);
    const double s = half * sinc;
    rotate_right(q, i, s, c);
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double sine = 2 * s * c, cosine = 1 - 2 * s * s, mj = m[j], mk = m[k];
    m[j] = cosine * mj + sine * mk;
    m[k] = cosine * mk - sine * mj;
  };
  turn(0, 0.5 * h), turn(1, 0.5 * h), turn(2, h), turn(1, 0.5 * h), turn(0, 0.5 * h);
  return q;
}

/// Exact for two equal moments I_t: a rotation about L at the rate |L| / I_t after one about the symmetry
/// axis at the rate L_i (1/I_i − 1/I_t).
inline Quat rotate_symmetric(const MassMatrix::Body& body, Quat q, const Vec3& L, double h) {
  const int i = body.symmetry_axis;
  const double across = body.inverse_moments[(i + 1) % 3], excess = body.inverse_moments[i] - across;
  if (excess != 0) {
    // L along the axis: column i of the rotation matrix, written out.
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double *v = q.coeffs().data(), w = v[3], vi = v[i], vj = v[j], vk = v[k];  // x, y, z, w
    const double along =
        L[i] * (1 - 2 * (vj * vj + vk * vk)) + 2 * (L[j] * (vi * vj + w * vk) + L[k] * (vi * vk - w * vj));
    const double half = 0.5 * h * excess * along;
    const auto [sinc, cosine] = sinc_cosine(half * half);
    rotate_right(q, i, half * sinc, cosine);
  }
  return exp_so3(h * across * L) * q;
}

}  // namespace detail

/// Pose after time h.
inline Pose free_flow(const MassMatrix::Body& body, const Pose& pose, const Vec3& L, const Vec3& P,
                      double h) {
  Quat q = body.principal ? pose.q : Quat(pose.q * body.q_BP);
  q = body.symmetry_axis >= 0 ? detail::rotate_symmetric(body, q, L, h) : detail::rotate_split(body, q, L, h);
  if (!body.principal) q = q * body.q_BP.conjugate();
  // One Newton step towards |q| = 1; its round-off drift over millions of steps would otherwise show.
  q.coeffs() *= 1.5 - 0.5 * q.squaredNorm();
  return {q, pose.p + h * body.inverse_mass * P};
}

}  // namespace taut
