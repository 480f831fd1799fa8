#include "core/constraints/parallel_part.h"

#include <cmath>
#include <numbers>

#include "core/constraints/ball_parts.h"
#include "core/constraints/rows.h"

namespace taut {
namespace row_parts {
namespace {

/// Sine of the angle from opposite ways below which no direction leads back.
constexpr double kOpposite = 1e-6;

/// u, v of A and b of B in world axes.
struct Directions {
  Vec3 u, v, b;
  [[gnu::always_inline]] Directions(const Parallel& p, const Pose& A, const Pose& B)
      : u(rotate(A.q, p.u_A)), v(rotate(A.q, p.v_A)), b(rotate(B.q, p.b_B)) {}
  /// b is more than a right angle from a.
  bool turned_over() const { return u.cross(v).dot(b) < 0; }
};

/// The rows by themselves: within a right angle …
Perpendicular near_row(const Parallel& p, int i) { return {i == 0 ? p.u_A : p.v_A, p.b_B}; }
/// … and beyond.  u = v × a, and (a × b)·v = b·(v × a).
SwingComponent far_row(const Parallel& p, int i) {
  return {p.u_A.cross(p.v_A), p.b_B, i == 0 ? p.v_A : Vec3(-p.u_A)};
}

}  // namespace

void Parallel::residual(const Pose& A, const Pose& B, double* phi) const {
  const Directions d(*this, A, B);
  phi[0] = d.u.dot(d.b), phi[1] = d.v.dot(d.b);
  if (!d.turned_over()) return;
  if (std::hypot(phi[0], phi[1]) < kOpposite) {
    phi[0] = std::numbers::pi, phi[1] = 0;
    return;
  }
  for (int i = 0; i < kRows; ++i) far_row(*this, i).residual(A, B, phi + i);
}

void Parallel::jacobian(const Pose& A, const Pose& B, JacobianBlock<2> J_A, JacobianBlock<2> J_B) const {
  const Directions d(*this, A, B);
  if (!d.turned_over()) {
    const Vec3 uxb = d.u.cross(d.b), vxb = d.v.cross(d.b);
    J_A << uxb.transpose(), 0, 0, 0, vxb.transpose(), 0, 0, 0;
    J_B << -uxb.transpose(), 0, 0, 0, -vxb.transpose(), 0, 0, 0;
    return;
  }
  for (int i = 0; i < kRows; ++i)
    far_row(*this, i).jacobian(A, B, JacobianBlock<1>(J_A.data() + 6 * i),
                               JacobianBlock<1>(J_B.data() + 6 * i));
}

void Parallel::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
  const bool over = Directions(*this, A, B).turned_over();
  for (int i = 0; i < kRows; ++i) {
    if (over)
      far_row(*this, i).bias(A, B, V_A, V_B, gamma + i);
    else
      near_row(*this, i).bias(A, B, V_A, V_B, gamma + i);
  }
}

void Parallel::stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                         StiffnessBlocks& K_B) const {
  const Directions d(*this, A, B);
  const bool over = d.turned_over();
  for (int i = 0; i < kRows; ++i) {
    if (over) {
      far_row(*this, i).stiffness(A, B, lambda + i, K_A, K_B);
      continue;
    }
    const Vec3& a = i == 0 ? d.u : d.v;
    const Vec3 f = lambda[i] * d.b;
    add_lever_stiffness(a, f, K_A.rotation);
    add_lever_stiffness(a, f, K_B.rotation);
  }
}

std::string Parallel::row_name(int i) const { return near_row(*this, i).row_name(0); }

Parallel Parallel::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {X_CA.q * u_A, X_CA.q * v_A, X_CB.q * b_B};
}

}  // namespace row_parts

template class detail::PartStore<row_parts::Parallel>;
template void RowSink::add(const row_parts::Parallel&, Between);

}  // namespace taut
