#include "core/constraints/curve_part.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/constraints/rows.h"

namespace taut {

BodyCurve::BodyCurve(CubicSpline<3> spline) : spline_(std::move(spline)) {
  const std::vector<double>& t = spline_.parameters();
  for (std::size_t i = 0; i + 1 < t.size(); ++i)
    for (int k = 0; k < kCells; ++k) nodes_.emplace_back().s = t[i] + (t[i + 1] - t[i]) * k / kCells;
  nodes_.emplace_back().s = t.back();
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const auto c = spline_.at(nodes_[k].s);
    nodes_[k].p = c.value;
    if (!(c.first.norm() > 0)) fail("curve", "has a corner or stands still at parameter", nodes_[k].s);
    nodes_[k].tangent = c.first.normalized();
    Vec3 unused;
    if (k == 0)
      complete_frame(nodes_[k].tangent, nodes_[k].normal, unused);
    else
      nodes_[k].normal = rotation_between(nodes_[k - 1].tangent, nodes_[k].tangent) * nodes_[k - 1].normal;
  }
}

BodyCurve BodyCurve::carried(const Pose& X_CA) const {
  BodyCurve copy = *this;
  copy.spline_ = spline_.moved(X_CA.q.toRotationMatrix(), X_CA.p);
  for (Node& node : copy.nodes_) {
    node.p = X_CA.point(node.p);
    node.tangent = X_CA.q * node.tangent;
    node.normal = X_CA.q * node.normal;
  }
  return copy;
}

BodyCurve::Near BodyCurve::near(const Vec3& x) const {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const double distance = (x - nodes_[k].p).squaredNorm();
    if (distance < least) least = distance, best = k;
  }
  Near at;
  at.s = nodes_[best].s;
  for (int iteration = 0;; ++iteration) {
    at.c = spline_.at(at.s);
    at.e = x - at.c.value;
    at.D = at.c.first.squaredNorm() - at.c.second.dot(at.e);
    // Gauss–Newton where the point is farther off than the curve is bent.
    const double slope = at.D > 0.1 * at.c.first.squaredNorm() ? at.D : at.c.first.squaredNorm();
    const double step = at.c.first.dot(at.e) / slope;
    if (iteration >= kMaxIterations || !(std::abs(step) > 1e-15 * spline_.length())) break;
    at.s += step;
  }
  place_frame(at);
  return at;
}

void BodyCurve::place_frame(Near& at) const {
  double s = at.s;
  if (spline_.closed())
    s -= spline_.length() * std::floor((s - spline_.first_parameter()) / spline_.length());
  const auto after = std::upper_bound(nodes_.begin() + 1, nodes_.end(), s,
                                      [](double value, const Node& node) { return value < node.s; });
  const Node& node = *(after - 1);
  const double speed = at.c.first.norm();
  at.tangent = at.c.first / speed;
  at.tangent_rate = (at.c.second - at.tangent.dot(at.c.second) * at.tangent) / speed;
  at.gradient = at.c.first / at.D;
  at.normal[0] = rotation_between(node.tangent, at.tangent) * node.normal;
  at.normal[1] = at.tangent.cross(at.normal[0]);
  at.twist = -at.tangent_rate.dot(node.tangent.cross(at.tangent)) / (1 + node.tangent.dot(at.tangent));
}

namespace row_parts {

PointInBody::PointInBody(const Pose& A, const Pose& B, const Vec3& p_BQ) {
  r_B = rotate(B.q, p_BQ);
  s = B.p + r_B - A.p;
  x = A.q.conjugate() * s;
}

void PointInBody::row(const Pose& A, const Vec3& g, double* J_A, double* J_B) const {
  const Vec3 a = rotate(A.q, g);
  Eigen::Map<Eigen::Matrix<double, 1, 6>>{J_A} << a.cross(s).transpose(), -a.transpose();
  Eigen::Map<Eigen::Matrix<double, 1, 6>>{J_B} << r_B.cross(a).transpose(), a.transpose();
}

void PointInBody::rates(const Pose& A, const Twist& V_A, const Twist& V_B, Vec3& first, Vec3& second) const {
  const Vec3 v = V_B.at(r_B) - V_A.v, x1 = v - V_A.w.cross(s);
  first = A.q.conjugate() * x1;
  second = A.q.conjugate() * (V_B.w.cross(V_B.w.cross(r_B)) - V_A.w.cross(v) - V_A.w.cross(x1));
}

void PointInBody::stiffness(const Pose& A, const Vec3& g, const Mat3& H, StiffnessBlocks& K_A,
                            StiffnessBlocks& K_B) const {
  const Mat3 R = A.q.toRotationMatrix(), S = -R * H * R.transpose();
  const Vec3 f = rotate(A.q, g);
  K_A.translation += S;
  K_B.translation += S;
  K_A.rotation += skew(s) * S * skew(s).transpose();
  K_B.rotation += skew(r_B) * S * skew(r_B).transpose();
  add_lever_stiffness(s, f, K_A.rotation);
  add_lever_stiffness(r_B, f, K_B.rotation);
}

void PointOnCurve::residual(const Pose& A, const Pose& B, double* phi) const {
  const BodyCurve::Near at = curve->near(PointInBody(A, B, p_BQ).x);
  for (int i : {0, 1}) phi[i] = at.normal[i].dot(at.e);
}

void PointOnCurve::jacobian(const Pose& A, const Pose& B, JacobianBlock<2> J_A, JacobianBlock<2> J_B) const {
  const PointInBody Q(A, B, p_BQ);
  const BodyCurve::Near at = curve->near(Q.x);
  for (int i : {0, 1}) Q.row(A, gradient(at, i), J_A.data() + 6 * i, J_B.data() + 6 * i);
}

void PointOnCurve::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B,
                        double* gamma) const {
  const PointInBody Q(A, B, p_BQ);
  const BodyCurve::Near at = curve->near(Q.x);
  Vec3 x1, x2;
  Q.rates(A, V_A, V_B, x1, x2);
  for (int i : {0, 1}) gamma[i] = gradient(at, i).dot(x2) + x1.dot(hessian(at, i) * x1);
}

void PointOnCurve::stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                             StiffnessBlocks& K_B) const {
  const PointInBody Q(A, B, p_BQ);
  const BodyCurve::Near at = curve->near(Q.x);
  for (int i : {0, 1}) Q.stiffness(A, lambda[i] * gradient(at, i), lambda[i] * hessian(at, i), K_A, K_B);
}

std::string PointOnCurve::row_name(int) const { return "translation across the curve"; }

Vec3 PointOnCurve::gradient(const BodyCurve::Near& at, int i) {
  return at.normal[i] + at.twist * at.tangent.cross(at.normal[i]).dot(at.e) * at.gradient;
}

Mat3 PointOnCurve::hessian(const BodyCurve::Near& at, int i) {
  const Mat3 turn = at.twist * at.tangent.cross(at.normal[i]) * at.gradient.transpose();
  return -at.normal[i].dot(at.tangent_rate) * at.tangent * at.gradient.transpose() + turn + turn.transpose();
}

double CurveParameter::period() const {
  return curve->spline().closed() ? curve->spline().length() : std::numeric_limits<double>::infinity();
}

void CurveParameter::residual(const Pose& A, const Pose& B, double* s) const {
  *s = curve->near(PointInBody(A, B, p_BQ).x).s;
}

void CurveParameter::jacobian(const Pose& A, const Pose& B, JacobianBlock<1> J_A,
                              JacobianBlock<1> J_B) const {
  const PointInBody Q(A, B, p_BQ);
  Q.row(A, curve->near(Q.x).gradient, J_A.data(), J_B.data());
}

void CurveParameter::bias(const Pose& A, const Pose& B, const Twist& V_A, const Twist& V_B,
                          double* gamma) const {
  const PointInBody Q(A, B, p_BQ);
  const BodyCurve::Near at = curve->near(Q.x);
  Vec3 x1, x2;
  Q.rates(A, V_A, V_B, x1, x2);
  *gamma = at.gradient.dot(x2) + x1.dot(hessian(at) * x1);
}

void CurveParameter::stiffness(const Pose& A, const Pose& B, const double* lambda, StiffnessBlocks& K_A,
                               StiffnessBlocks& K_B) const {
  const PointInBody Q(A, B, p_BQ);
  const BodyCurve::Near at = curve->near(Q.x);
  Q.stiffness(A, *lambda * at.gradient, *lambda * hessian(at), K_A, K_B);
}

std::string CurveParameter::row_name(int) const { return "displacement along the curve"; }

Mat3 CurveParameter::hessian(const BodyCurve::Near& at) {
  const Mat3 mixed = at.gradient * at.c.second.transpose();
  const double own = at.c.third.dot(at.e) - 3 * at.c.first.dot(at.c.second);
  return (mixed + mixed.transpose() + own * at.gradient * at.gradient.transpose()) / at.D;
}

PointOnCurve PointOnCurve::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {std::make_shared<const BodyCurve>(curve->carried(X_CA)), X_CB.point(p_BQ)};
}

CurveParameter CurveParameter::carried(const Pose& X_CA, const Pose& X_CB) const {
  return {std::make_shared<const BodyCurve>(curve->carried(X_CA)), X_CB.point(p_BQ)};
}

}  // namespace row_parts

template class detail::PartStore<row_parts::PointOnCurve>;
template void RowSink::add(const row_parts::PointOnCurve&, Between);
template void RowSink::add(const row_parts::CurveParameter&, Between);
template void AxisSink::add(std::string_view, const row_parts::CurveParameter&, Between);
template class detail::PartStore<row_parts::CurveParameter>;

}  // namespace taut
