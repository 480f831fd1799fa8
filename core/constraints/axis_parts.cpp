#include "core/constraints/axis_parts.h"

#include <cmath>

#include "core/constraints/rows.h"

namespace taut {
namespace row_parts {

Vec3 Angle::Directions::j() const { return a - z / D * p; }

Angle::Directions Angle::directions(const Pose& A, const Pose& B) const {
  Directions d;
  d.a = rotate(A.q, a_A), d.u = rotate(A.q, u_A), d.v = d.a.cross(d.u), d.e = rotate(B.q, e_B);
  d.x = d.u.dot(d.e), d.y = d.v.dot(d.e), d.z = d.a.dot(d.e);
  d.p = d.x * d.u + d.y * d.v;
  d.D = d.x * d.x + d.y * d.y;
  return d;
}

void Angle::residual(const Pose& A, const Pose& B, double* theta) const {
  const Vec3 u = rotate(A.q, u_A), v = rotate(A.q, a_A.cross(u_A)), e = rotate(B.q, e_B);
  *theta = std::atan2(v.dot(e), u.dot(e));
}

void Angle::jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
  const Vec3 j = directions(A, B).j();
  J_A << -j.transpose(), 0, 0, 0;
  J_B << j.transpose(), 0, 0, 0;
}

void Angle::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
  const Directions d = directions(A, B);
  const Vec3 e1 = V_B.w.cross(d.e), e2 = V_B.w.cross(e1);
  const auto rates = [&](const Vec3& u, double& first, double& second) {
    const Vec3 u1 = V_A.w.cross(u);
    first = u1.dot(d.e) + u.dot(e1);
    second = V_A.w.cross(u1).dot(d.e) + 2 * u1.dot(e1) + u.dot(e2);
  };
  double x1, x2, y1, y2;
  rates(d.u, x1, x2);
  rates(d.v, y1, y2);
  const double rate = (d.x * y1 - d.y * x1) / d.D;
  *gamma = (d.x * y2 - d.y * x2 - 2 * rate * (d.x * x1 + d.y * y1)) / d.D;
}

void Angle::stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                      StiffnessBlocks& K_B) const {
  const Directions d = directions(A, B);
  // ∂j/∂e; the direction e itself changes by −[e]× with the rotation of B.
  const Mat3 G = -(d.p * d.a.transpose() + d.z * (Mat3::Identity() - d.a * d.a.transpose())) / d.D +
                 2 * d.z / (d.D * d.D) * d.p * d.p.transpose();
  const Mat3 turn = *lambda * G * skew(d.e);
  const Mat3 K = 0.5 * (turn + turn.transpose());
  K_A.rotation += K;
  K_B.rotation += K;
}

std::string Angle::row_name(int) const { return "rotation about the axis"; }

std::string Displacement::row_name(int) const { return "displacement along the axis"; }

std::string Length::row_name(int) const { return "length"; }

void Screw::residual(const Pose& A, const Pose& B, double* phi) const {
  double theta;
  displacement.residual(A, B, phi);
  angle.residual(A, B, &theta);
  *phi -= k() * theta;
}

void Screw::jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
  double of_a[6], of_b[6];
  JacobianBlock<1> angle_A(of_a), angle_B(of_b);
  displacement.jacobian(A, B, J_A, J_B);
  angle.jacobian(A, B, angle_A, angle_B);
  J_A -= k() * angle_A;
  J_B -= k() * angle_B;
}

void Screw::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
  double of_angle;
  displacement.bias(A, B, V_A, V_B, gamma);
  angle.bias(A, B, V_A, V_B, &of_angle);
  *gamma -= k() * of_angle;
}

void Screw::stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                      StiffnessBlocks& K_B) const {
  const double torque = -k() * *lambda;
  displacement.stiffness(A, B, lambda, K_A, K_B);
  angle.stiffness(A, B, &torque, K_A, K_B);
}

std::string Screw::row_name(int) const { return "displacement by the thread"; }

Angle Angle::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {X_CA.q * a_A, X_CA.q * u_A, X_CB.q * e_B};
}

Displacement Displacement::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {PointInPlane::carried(X_CA, X_CB)};
}

Length Length::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {X_CA.point(p_AP), X_CB.point(p_BQ)};
}

Screw Screw::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {displacement.carried(X_CA, X_CB), angle.carried(X_CA, X_CB), pitch};
}

}  // namespace row_parts

template class detail::PartStore<row_parts::Angle>;
template class detail::PartStore<row_parts::Displacement>;
template class detail::PartStore<row_parts::Length>;
template void RowSink::add(const row_parts::Angle&, Between);
template void AxisSink::add(std::string_view, const row_parts::Angle&, Between);
template void RowSink::add(const row_parts::Displacement&, Between);
template void AxisSink::add(std::string_view, const row_parts::Displacement&, Between);
template void RowSink::add(const row_parts::Length&, Between);
template void AxisSink::add(std::string_view, const row_parts::Length&, Between);
template void RowSink::add(const row_parts::Screw&, Between);
template void AxisSink::add(std::string_view, const row_parts::Screw&, Between);
template class detail::PartStore<row_parts::Screw>;

}  // namespace taut
