#include "core/constraints/row_parts.h"

#include <cmath>
#include <sstream>

#include "core/constraints/rows.h"

namespace taut {
namespace row_parts {

const char* axis_name(int i) { return i == 0 ? "x" : i == 1 ? "y" : "z"; }

std::string direction_name(const Vec3& d) {
  for (int i = 0; i < 3; ++i)
    if (std::abs(std::abs(d[i]) - 1) < 1e-9) return std::string(d[i] < 0 ? "−" : "") + axis_name(i);
  std::ostringstream text;
  text.precision(3);
  text << "(" << d[0] + 0.0 << ", " << d[1] + 0.0 << ", " << d[2] + 0.0 << ")";
  return text.str();
}

void Point::residual(const Pose& A, const Pose& B, double* phi) const {
  const Vec3 a = rotate(A.q, p_AP), b = rotate(B.q, p_BQ);
  for (int i = 0; i < 3; ++i) phi[i] = (B.p[i] - A.p[i]) + (b[i] - a[i]);
}

void Point::jacobian(const Pose& A, const Pose& B, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const {
  const Vec3 a = rotate(A.q, p_AP), b = rotate(B.q, p_BQ);
  J_A << 0, -a[2], a[1], -1, 0, 0, a[2], 0, -a[0], 0, -1, 0, -a[1], a[0], 0, 0, 0, -1;  // [a]×, −1
  J_B << 0, b[2], -b[1], 1, 0, 0, -b[2], 0, b[0], 0, 1, 0, b[1], -b[0], 0, 0, 0, 1;     // −[b]×, 1
}

void Point::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
  Eigen::Map<Vec3> out(gamma);
  out = V_B.w.cross(V_B.w.cross(rotate(B.q, p_BQ))) - V_A.w.cross(V_A.w.cross(rotate(A.q, p_AP)));
}

void Point::stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                      StiffnessBlocks& K_B) const {
  const Vec3 f(lambda[0], lambda[1], lambda[2]);
  add_lever_stiffness(rotate(A.q, p_AP), -f, K_A.rotation);
  add_lever_stiffness(rotate(B.q, p_BQ), f, K_B.rotation);
}

std::string Point::row_name(int i) const { return std::string("translation along world ") + axis_name(i); }

void PointInPlane::residual(const Pose& A, const Pose& B, double* phi) const {
  *phi = rotate(A.q, a_A).dot((B.p - A.p) + (rotate(B.q, p_BQ) - rotate(A.q, p_AP)));
}

void PointInPlane::jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
  const Vec3 a = rotate(A.q, a_A), r_B = rotate(B.q, p_BQ),
             s = B.p + r_B - A.p;  // s: from the centre of A to Q
  J_A << a.cross(s).transpose(), -a.transpose();
  J_B << r_B.cross(a).transpose(), a.transpose();
}

void PointInPlane::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B,
                        double* gamma) const {
  const Vec3 a = rotate(A.q, a_A), r_A = rotate(A.q, p_AP), r_B = rotate(B.q, p_BQ);
  const Vec3 d = (B.p - A.p) + (r_B - r_A), d_dot = V_B.at(r_B) - V_A.at(r_A);
  const Vec3 a_dot = V_A.w.cross(a);
  *gamma = a.dot(V_B.w.cross(V_B.w.cross(r_B)) - V_A.w.cross(V_A.w.cross(r_A))) + 2 * a_dot.dot(d_dot) +
           V_A.w.cross(a_dot).dot(d);
}

void PointInPlane::stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                             StiffnessBlocks& K_B) const {
  const Vec3 f = *lambda * rotate(A.q, a_A), r_B = rotate(B.q, p_BQ);
  add_lever_stiffness(B.p + r_B - A.p, f, K_A.rotation);
  add_lever_stiffness(r_B, f, K_B.rotation);
}

std::string PointInPlane::row_name(int) const { return "translation along " + direction_name(a_A) + " of A"; }

void Perpendicular::residual(const Pose& A, const Pose& B, double* phi) const {
  *phi = rotate(A.q, a_A).dot(rotate(B.q, b_B));
}

void Perpendicular::jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
  const Vec3 axb = rotate(A.q, a_A).cross(rotate(B.q, b_B));
  J_A << axb.transpose(), 0, 0, 0;
  J_B << -axb.transpose(), 0, 0, 0;
}

void Perpendicular::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B,
                         double* gamma) const {
  const Vec3 a = rotate(A.q, a_A), b = rotate(B.q, b_B), a_dot = V_A.w.cross(a), b_dot = V_B.w.cross(b);
  *gamma = V_A.w.cross(a_dot).dot(b) + 2 * a_dot.dot(b_dot) + a.dot(V_B.w.cross(b_dot));
}

void Perpendicular::stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                              StiffnessBlocks& K_B) const {
  const Vec3 a = rotate(A.q, a_A), f = *lambda * rotate(B.q, b_B);
  add_lever_stiffness(a, f, K_A.rotation);
  add_lever_stiffness(a, f, K_B.rotation);
}

std::string Perpendicular::row_name(int) const {
  return "rotation that tilts the axis towards " + direction_name(a_A) + " of A";
}

Quat Orientation::relative(const Pose& A, const Pose& B) const {
  Quat q = (A.q * q_AF).conjugate() * (B.q * q_BG);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return q;
}

void Orientation::residual(const Pose& A, const Pose& B, double* phi) const {
  Eigen::Map<Vec3> out(phi);
  out = 2 * relative(A, B).vec();
}

void Orientation::jacobian(const Pose& A, const Pose& B, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const {
  const Quat q = relative(A, B);
  // d/dt 2 vec(q_FG) = (s 1 − [vec]×) R_FW ω_rel with s the scalar part.
  const Mat3 J = (q.w() * Mat3::Identity() - skew(q.vec())) * (A.q * q_AF).toRotationMatrix().transpose();
  J_A << -J, Mat3::Zero();
  J_B << J, Mat3::Zero();
}

void Orientation::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B,
                       double* gamma) const {
  const Quat q = relative(A, B), q_FW = (A.q * q_AF).conjugate();
  const Vec3 v = q.vec(), w = q_FW * (V_B.w - V_A.w), w_dot = -(q_FW * V_A.w).cross(w);
  const double s = q.w(), s_dot = -0.5 * w.dot(v);
  const Vec3 v_dot = 0.5 * (s * w + w.cross(v));
  Eigen::Map<Vec3> out(gamma);
  out = s_dot * w + w.cross(v_dot) + s * w_dot + w_dot.cross(v);
}

std::string Orientation::row_name(int i) const { return std::string("rotation about joint ") + axis_name(i); }

void Distance::residual(const Pose& A, const Pose& B, double* phi) const {
  *phi = ((B.p - A.p) + (rotate(B.q, p_BQ) - rotate(A.q, p_AP))).norm() - length;
}

void Distance::jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A, JacobianBlock<1> J_B) const {
  const Vec3 r_A = rotate(A.q, p_AP), r_B = rotate(B.q, p_BQ), n = direction((B.p - A.p) + (r_B - r_A));
  J_A << -r_A.cross(n).transpose(), -n.transpose();
  J_B << r_B.cross(n).transpose(), n.transpose();
}

void Distance::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B, double* gamma) const {
  const Vec3 r_A = rotate(A.q, p_AP), r_B = rotate(B.q, p_BQ), d = (B.p - A.p) + (r_B - r_A);
  const Vec3 n = direction(d), d_dot = V_B.at(r_B) - V_A.at(r_A);
  const double along = n.dot(d_dot), distance = d.norm();
  const double turning = distance > 0 ? (d_dot.squaredNorm() - along * along) / distance : 0;
  *gamma = n.dot(V_B.w.cross(V_B.w.cross(r_B)) - V_A.w.cross(V_A.w.cross(r_A))) + turning;
}

void Distance::stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                         StiffnessBlocks& K_B) const {
  const Vec3 r_A = rotate(A.q, p_AP), r_B = rotate(B.q, p_BQ), d = (B.p - A.p) + (r_B - r_A),
             n = direction(d);
  // The force λn swings with the line between the points: −λ (1 − nnᵀ)/|d| on translations.
  // Where the points coincide there is no line; nothing swings.
  const double distance = d.norm(), per_distance = distance > 0 ? -*lambda / distance : 0;
  const Mat3 swing = per_distance * (Mat3::Identity() - n * n.transpose());
  K_A.translation += swing;
  K_B.translation += swing;
  K_A.rotation += skew(r_A) * swing * skew(r_A).transpose();
  K_B.rotation += skew(r_B) * swing * skew(r_B).transpose();
  add_lever_stiffness(r_A, -*lambda * n, K_A.rotation);
  add_lever_stiffness(r_B, *lambda * n, K_B.rotation);
}

std::string Distance::row_name(int) const { return "distance"; }

Vec3 Distance::direction(const Vec3& d) {
  const double norm = d.norm();
  return norm > 0 ? Vec3(d / norm) : Vec3(Vec3::UnitX());
}

Point Point::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {X_CA.point(p_AP), X_CB.point(p_BQ)};
}

CompactPoint CompactPoint::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {Point::carried(X_CA, X_CB)};
}

void CompactPoint::arms(const Pose& A, const Pose& B, double* a, double* b) const {
  Eigen::Map<Vec3>{a} = rotate(A.q, p_AP);
  Eigen::Map<Vec3>{b} = rotate(B.q, p_BQ);
}

PointInPlane PointInPlane::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {X_CA.point(p_AP), X_CA.q * a_A, X_CB.point(p_BQ)};
}

Perpendicular Perpendicular::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {X_CA.q * a_A, X_CB.q * b_B};
}

Orientation Orientation::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {X_CA.q * q_AF, X_CB.q * q_BG};
}

Distance Distance::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {X_CA.point(p_AP), X_CB.point(p_BQ), length};
}

Stretch Stretch::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {X_CA.point(p_AP), X_CB.point(p_BQ)};
}

bool Stretch::turned_round(const Pose& A0, const Pose& B0, const Pose& A, const Pose& B) const {
  return (B0.point(p_BQ) - A0.point(p_AP)).dot(B.point(p_BQ) - A.point(p_AP)) < 0;
}

}  // namespace row_parts

template class detail::PartStore<row_parts::Point>;
template class detail::PartStore<row_parts::CompactPoint>;
template class detail::PartStore<row_parts::PointInPlane>;
template class detail::PartStore<row_parts::Perpendicular>;
template class detail::PartStore<row_parts::Orientation>;
template class detail::PartStore<row_parts::Distance>;
template class detail::PartStore<row_parts::Stretch>;
template void RowSink::add(const row_parts::Point&, Between);
template void RowSink::add(const row_parts::PointInPlane&, Between);
template void AxisSink::add(std::string_view, const row_parts::PointInPlane&, Between);
template void RowSink::add(const row_parts::Perpendicular&, Between);
template void AxisSink::add(std::string_view, const row_parts::Perpendicular&, Between);
template void RowSink::add(const row_parts::Orientation&, Between);
template void RowSink::add(const row_parts::Distance&, Between);
template void AxisSink::add(std::string_view, const row_parts::Distance&, Between);

}  // namespace taut
