#include "core/constraints/wide_parts.h"

#include <array>

#include "core/constraints/rows.h"

namespace taut {
namespace row_parts {

void Coupling::residual(const Configuration& at, double* phi) const {
  *phi = -offset;
  for (const Term& term : terms) {
    double theta;
    term.coordinate->residual(at, &theta);
    *phi += term.factor * theta;
  }
}

void Coupling::jacobian(const Configuration& at, detail::SideBlocks J) const {
  std::array<double, 6 * kMaxBodies> values;
  for (const Term& term : terms) {
    values.fill(0);
    term.coordinate->jacobian(at, values.data());
    for (std::size_t s = 0; s < term.sides.size(); ++s)
      for (int k = 0; k < 6; ++k) J[term.sides[s]][k] += term.factor * values[6 * s + k];
  }
}

void Coupling::bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const {
  *gamma = 0;
  for (const Term& term : terms) {
    double bias;
    term.coordinate->bias(at, twists, &bias);
    *gamma += term.factor * bias;
  }
}

void Coupling::stiffness(const Configuration& at, const double* lambda,
                         std::span<StiffnessBlocks> bodies) const {
  for (const Term& term : terms) {
    const double along = term.factor * *lambda;
    term.coordinate->stiffness(at, &along, bodies);
  }
}

void Coupling::update_axes(const Configuration& at, std::span<double> axes) const {
  for (const Term& term : terms) term.coordinate->update_axes(at, axes);
}

std::string Coupling::row_name(int) const { return is_angle ? "rotation by the coupling" : "coupling"; }

Coupling Coupling::relocated(const Relocation& to) const {
  Coupling copy = *this;
  Relocation within = to;  // the blocks of a coordinate stay in the order of its own bodies
  within.sides.clear();
  copy.terms.clear();
  for (Term term : terms) {
    term.coordinate = term.coordinate->relocated(within);
    for (int& side : term.sides) side = to.side(side);
    // A section between two bodies on the same carrier has a constant length.
    if (term.sides.size() == 2 && term.sides[0] == term.sides[1]) {
      double theta;
      term.coordinate->residual(std::vector<Pose>(to.carriers->bodies.size()), &theta);
      copy.offset -= term.factor * theta;
      continue;
    }
    copy.terms.push_back(std::move(term));
  }
  return copy;
}

void DrivenCoupling::residual(const Configuration& at, double* phi) const {
  Coupling::residual(at, phi);
  *phi -= motion(at.time).value;
}

void DrivenCoupling::bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const {
  Coupling::bias(at, twists, gamma);
  *gamma -= motion(at.time).acceleration;
}

void DrivenCoupling::add_rate(const Configuration& at, double* out) const { *out -= motion(at.time).rate; }

std::string DrivenCoupling::row_name(int) const { return is_angle ? "rotation by the driver" : "driver"; }

PointInPlane DrivenPosition::row(int i) const { return {X_A.p, X_A.q * Vec3::Unit(i), X_B.p}; }

void DrivenPosition::residual(const Configuration& at, double* phi) const {
  const Vec3 target = motion(at.time).pose.p;
  for (int i = 0; i < 3; ++i) {
    row(i).residual(at.poses[body_a], at.poses[body_b], phi + i);
    phi[i] -= target[i];
  }
}

void DrivenPosition::jacobian(const Configuration& at, detail::SideBlocks J) const {
  for (int i = 0; i < 3; ++i)
    row(i).jacobian(at.poses[body_a], at.poses[body_b], JacobianBlock<1>(J[0] + 6 * i),
                    JacobianBlock<1>(J[1] + 6 * i));
}

void DrivenPosition::bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const {
  const Vec3 target = motion(at.time).acceleration.v;
  for (int i = 0; i < 3; ++i) {
    row(i).bias(at.poses[body_a], at.poses[body_b], twists[body_a], twists[body_b], gamma + i);
    gamma[i] -= target[i];
  }
}

void DrivenPosition::add_rate(const Configuration& at, double* out) const {
  Eigen::Map<Vec3>{out} -= motion(at.time).velocity.v;
}

void DrivenPosition::stiffness(const Configuration& at, const double* lambda,
                               std::span<StiffnessBlocks> bodies) const {
  for (int i = 0; i < 3; ++i)
    row(i).stiffness(at.poses[body_a], at.poses[body_b], lambda + i, bodies[body_a], bodies[body_b]);
}

std::string DrivenPosition::row_name(int i) const {
  return std::string("translation driven along A's ") + axis_name(i);
}

Orientation DrivenOrientation::part(const PosePoint& target) const { return {X_A.q * target.pose.q, X_B.q}; }

void DrivenOrientation::residual(const Configuration& at, double* phi) const {
  part(motion(at.time)).residual(at.poses[body_a], at.poses[body_b], phi);
}

void DrivenOrientation::jacobian(const Configuration& at, detail::SideBlocks J) const {
  part(motion(at.time))
      .jacobian(at.poses[body_a], at.poses[body_b], JacobianBlock<3>(J[0]), JacobianBlock<3>(J[1]));
}

void DrivenOrientation::bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const {
  const PosePoint target = motion(at.time);
  const Pose &A = at.poses[body_a], &B = at.poses[body_b];
  const Quat q_WA = A.q * X_A.q;
  const Vec3 w = q_WA * target.velocity.w, w_A = twists[body_a].w;
  part(target).bias(A, B, {w_A + w, Vec3::Zero()}, twists[body_b], gamma);
  Eigen::Map<Vec3>{gamma} -= rate_matrix(at, target) * (q_WA * target.acceleration.w + w_A.cross(w));
}

void DrivenOrientation::add_rate(const Configuration& at, double* out) const {
  const PosePoint target = motion(at.time);
  Eigen::Map<Vec3>{out} -= rate_matrix(at, target) * (at.poses[body_a].q * X_A.q * target.velocity.w);
}

std::string DrivenOrientation::row_name(int i) const {
  return std::string("rotation driven about target ") + axis_name(i);
}

Mat3 DrivenOrientation::rate_matrix(const Configuration& at, const PosePoint& target) const {
  std::array<double, 36> values;
  part(target).jacobian(at.poses[body_a], at.poses[body_b], JacobianBlock<3>(values.data()),
                        JacobianBlock<3>(values.data() + 18));
  return JacobianBlock<3>(values.data() + 18).leftCols<3>();
}

DrivenCoupling DrivenCoupling::relocated(const Relocation& to) const {
  return {Coupling::relocated(to), motion};
}

DrivenPosition DrivenPosition::relocated(const Relocation& to) const {
  return {to.body(body_a), to.body(body_b), motion, to.frame(BodyId{body_a}) * X_A,
          to.frame(BodyId{body_b}) * X_B};
}

DrivenOrientation DrivenOrientation::relocated(const Relocation& to) const {
  return {to.body(body_a), to.body(body_b), motion, to.frame(BodyId{body_a}) * X_A,
          to.frame(BodyId{body_b}) * X_B};
}

}  // namespace row_parts

template class detail::WideStore<row_parts::Coupling>;
template class detail::WideStore<row_parts::DrivenCoupling>;
template class detail::WideStore<row_parts::DrivenPosition>;
template void RowSink::add(const row_parts::Coupling&, Between);
template void AxisSink::add(std::string_view, const row_parts::Coupling&, Between);
template void RowSink::add(const row_parts::DrivenCoupling&, Between);
template void AxisSink::add(std::string_view, const row_parts::DrivenCoupling&, Between);
template void RowSink::add(const row_parts::DrivenPosition&, Between);
template void RowSink::add(const row_parts::DrivenOrientation&, Between);
template class detail::WideStore<row_parts::DrivenOrientation>;

}  // namespace taut
