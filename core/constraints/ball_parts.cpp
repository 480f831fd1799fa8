#include "core/constraints/ball_parts.h"

#include <algorithm>
#include <cmath>

#include "core/constraints/rows.h"

namespace taut {
namespace row_parts {
namespace {

/// How a direction turns per turn of B against A, in the axes of its Directions.
template <typename Directions>
Mat3 turning_of(const Directions& d) {
  Mat3 turning;
  for (int k = 0; k < 3; ++k) turning.col(k) = d.turning(Vec3::Unit(k));
  return turning;
}

/// The symmetric part of K on both bodies, with which the direction of a torque turns together.
void add_to_both(const Mat3& K, StiffnessBlocks& K_A, StiffnessBlocks& K_B) {
  K_A.rotation += 0.5 * (K + K.transpose());
  K_B.rotation += 0.5 * (K + K.transpose());
}

}  // namespace

Swing::Directions Swing::directions(const Pose& A, const Pose& B) const {
  Directions d;
  d.a = rotate(A.q, a_A), d.b = rotate(B.q, b_B);
  const Vec3 n = d.a.cross(d.b);
  d.sine = n.norm();
  d.straight = d.sine < 1e-12;
  Vec3 unused;
  if (d.straight)
    complete_frame(d.a, d.j, unused);
  else
    d.j = n / d.sine;
  return d;
}

void Swing::residual(const Pose& A, const Pose& B, double* theta) const {
  const Vec3 a = rotate(A.q, a_A), b = rotate(B.q, b_B);
  *theta = std::atan2(a.cross(b).norm(), a.dot(b));
}

void Swing::jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
  const Vec3 j = directions(A, B).j;
  J_A << -j.transpose(), 0, 0, 0;
  J_B << j.transpose(), 0, 0, 0;
}

void Swing::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
  const Directions d = directions(A, B);
  *gamma = 0;
  if (d.straight) return;
  const Vec3 rate = V_A.w.cross(d.a).cross(d.b) + d.a.cross(V_B.w.cross(d.b));
  const Vec3 turning = (rate - d.j.dot(rate) * d.j) / d.sine;
  *gamma = turning.dot(V_B.w - V_A.w);
}

void Swing::stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                      StiffnessBlocks& K_B) const {
  const Directions d = directions(A, B);
  if (d.straight) return;
  const Mat3 turned = *lambda / d.sine * (Mat3::Identity() - d.j * d.j.transpose());
  const Mat3 of_a = turned * skew(d.b) * skew(d.a), of_b = turned * skew(d.a) * skew(d.b);
  K_A.rotation += 0.5 * (of_a + of_a.transpose());
  K_B.rotation += 0.5 * (of_b + of_b.transpose());
}

std::string Swing::row_name(int) const { return "swing"; }

Vec3 SwingComponent::Directions::g() const { return f * (C * x - x.dot(b) * a) + h * n.dot(x) * n; }

Vec3 SwingComponent::Directions::turning(const Vec3& w) const {
  const Vec3 b1 = w.cross(b), n1 = a.cross(b1);
  const double along = n.dot(w);
  return along * (h * (C * x - x.dot(b) * a) + k * n.dot(x) * n) + f * (a.dot(b1) * x - x.dot(b1) * a) +
         h * (n1.dot(x) * n + n.dot(x) * n1);
}

SwingComponent::Directions SwingComponent::directions(const Pose& A, const Pose& B) const {
  constexpr double kSeries = 0.02;  // below, where differences of nearly equal numbers would cancel
  constexpr double kFolded = 1e-6;  // sine next to π, where there is no direction
  Directions d;
  d.a = rotate(A.q, a_A), d.b = rotate(B.q, b_B), d.x = rotate(A.q, x_A);
  d.n = d.a.cross(d.b);
  d.C = d.a.dot(d.b);
  const double S = d.n.norm(), theta = std::atan2(S, d.C), t = theta * theta;
  if (theta < kSeries) {
    d.f = 1 + t / 6 + 7 * t * t / 360;
    d.h = 1.0 / 3 + 2 * t / 15 + 2 * t * t / 63;
    d.k = 4.0 / 15 + 6 * t / 35;
  } else {
    const double S2 = std::max(S * S, kFolded * kFolded);
    d.f = theta / std::sqrt(S2);
    d.h = (1 - d.f * d.C) / S2;
    d.k = (d.f - 3 * d.C * d.h) / S2;
  }
  return d;
}

void SwingComponent::residual(const Pose& A, const Pose& B, double* s) const {
  const Directions d = directions(A, B);
  *s = d.f * d.n.dot(d.x);
}

void SwingComponent::jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A,
                              JacobianBlock<1> J_B) const {
  const Vec3 g = directions(A, B).g();
  J_A << -g.transpose(), 0, 0, 0;
  J_B << g.transpose(), 0, 0, 0;
}

void SwingComponent::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B,
                          double* gamma) const {
  const Directions d = directions(A, B);
  const Vec3 w = V_B.w - V_A.w;
  *gamma = (V_A.w.cross(d.g()) + d.turning(w)).dot(w);
}

void SwingComponent::stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                               StiffnessBlocks& K_B) const {
  add_to_both(-*lambda * turning_of(directions(A, B)), K_A, K_B);
}

std::string SwingComponent::row_name(int) const { return "swing about " + direction_name(x_A); }

Vec3 TwistAngle::Directions::j() const { return {(s * y + z * x) / D, (z * y - s * x) / D, 1}; }

Vec3 TwistAngle::Directions::turning(double s1, double x1, double y1, double z1) const {
  const double D1 = 2 * (s * s1 + z * z1);
  const Vec3 here = j();
  return {(s1 * y + s * y1 + z1 * x + z * x1 - D1 * here.x()) / D,
          (z1 * y + z * y1 - s1 * x - s * x1 - D1 * here.y()) / D, 0};
}

Vec3 TwistAngle::Directions::turning(const Vec3& w) const {
  const Vec3 u(x, y, z), rate = 0.5 * (s * w + w.cross(u));
  return turning(-0.5 * w.dot(u), rate.x(), rate.y(), rate.z());
}

TwistAngle::Directions TwistAngle::directions(const Pose& A, const Pose& B) const {
  const Quat q_WF = A.q * q_AF, q = q_WF.conjugate() * (B.q * q_BG);
  return {q_WF.toRotationMatrix(), q.w(), q.x(), q.y(), q.z(), q.w() * q.w() + q.z() * q.z()};
}

void TwistAngle::residual(const Pose& A, const Pose& B, double* theta) const {
  const Directions d = directions(A, B);
  *theta = 2 * std::atan2(d.s < 0 ? -d.z : d.z, std::abs(d.s));  // the same for q and −q
}

void TwistAngle::jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
  const Directions d = directions(A, B);
  const Vec3 j = d.R_WF * d.j();
  J_A << -j.transpose(), 0, 0, 0;
  J_B << j.transpose(), 0, 0, 0;
}

void TwistAngle::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
  const Directions d = directions(A, B);
  const Vec3 w = d.R_WF.transpose() * (V_B.w - V_A.w), w_A = d.R_WF.transpose() * V_A.w;
  *gamma = d.turning(w).dot(w) - d.j().dot(w_A.cross(w));
}

void TwistAngle::stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                           StiffnessBlocks& K_B) const {
  const Directions d = directions(A, B);
  add_to_both(-*lambda * d.R_WF * turning_of(d) * d.R_WF.transpose(), K_A, K_B);
}

std::string TwistAngle::row_name(int) const { return "twist"; }

double Turn::increment(const Pose& A_from, const Pose& B_from, const Pose& A, const Pose& B) const {
  const Quat before = A_from.q.conjugate() * B_from.q, now = A.q.conjugate() * B.q;
  return a_A.dot(log_so3(now * before.conjugate()));
}

void Turn::jacobian(const Pose& A, const Pose&, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
  const Vec3 a = rotate(A.q, a_A);
  J_A << -a.transpose(), 0, 0, 0;
  J_B << a.transpose(), 0, 0, 0;
}

void Turn::bias(const Pose& A, const Pose&, const Twist& V_A, const Twist& V_B, double* gamma) const {
  *gamma = V_A.w.cross(rotate(A.q, a_A)).dot(V_B.w);
}

std::string Turn::row_name(int) const { return "turn about " + direction_name(a_A); }

Swing Swing::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {X_CA.q * a_A, X_CB.q * b_B, across};
}

SwingComponent SwingComponent::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {X_CA.q * a_A, X_CB.q * b_B, X_CA.q * x_A};
}

TwistAngle TwistAngle::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {X_CA.q * q_AF, X_CB.q * q_BG};
}

Turn Turn::carried(const Pose& X_CA, const Pose&) const { return {X_CA.q * a_A}; }

}  // namespace row_parts

template class detail::PartStore<row_parts::Swing>;
template class detail::PartStore<row_parts::SwingComponent>;
template class detail::PartStore<row_parts::TwistAngle>;
template void RowSink::add(const row_parts::Swing&, Between);
template void AxisSink::add(std::string_view, const row_parts::Swing&, Between);
template void RowSink::add(const row_parts::SwingComponent&, Between);
template void AxisSink::add(std::string_view, const row_parts::SwingComponent&, Between);
template void RowSink::add(const row_parts::TwistAngle&, Between);
template void AxisSink::add(std::string_view, const row_parts::TwistAngle&, Between);
template void RowSink::add(const row_parts::Turn&, Between);
template void AxisSink::add(std::string_view, const row_parts::Turn&, Between);
template class detail::PartStore<row_parts::Turn>;

}  // namespace taut
