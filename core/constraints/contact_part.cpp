#include "core/constraints/contact_part.h"

namespace taut {
namespace row_parts {

void ContactPoint::residual(const Pose& A, const Pose& B, double* phi) const {
  const Vec3 d = (B.p - A.p) + (rotate(B.q, p_BQ) - rotate(A.q, p_AP));
  for (int i = 0; i < 3; ++i) phi[i] = frame.direction(i).dot(d);
}

void ContactPoint::jacobian(const Pose& A, const Pose& B, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const {
  const Vec3 X = 0.5 * (A.p + rotate(A.q, p_AP) + B.p + rotate(B.q, p_BQ)), r_A = X - A.p, r_B = X - B.p;
  for (int i = 0; i < 3; ++i) {
    const Vec3& d = frame.direction(i);
    J_A.row(i) << -r_A.cross(d).transpose(), -d.transpose();
    J_B.row(i) << r_B.cross(d).transpose(), d.transpose();
  }
}

void ContactPoint::bias(const Pose&, const Pose&, const Twist&, const Twist&, double* gamma) const {
  gamma[0] = gamma[1] = gamma[2] = 0;
}

std::string ContactPoint::row_name(int i) const { return i == 0 ? "contact normal" : "contact tangent"; }

void ContactTwist::residual(const Pose&, const Pose&, double* phi) const { phi[0] = phi[1] = phi[2] = 0; }

void ContactTwist::jacobian(const Pose&, const Pose&, JacobianBlock<3> J_A, JacobianBlock<3> J_B) const {
  for (int i = 0; i < 3; ++i) {
    J_A.row(i) << -frame.direction(i).transpose(), 0, 0, 0;
    J_B.row(i) << frame.direction(i).transpose(), 0, 0, 0;
  }
}

void ContactTwist::bias(const Pose&, const Pose&, const Twist&, const Twist&, double* gamma) const {
  gamma[0] = gamma[1] = gamma[2] = 0;
}

std::string ContactTwist::row_name(int i) const {
  return i == 0 ? "spin about the contact normal" : "rolling";
}

}  // namespace row_parts

template class detail::PartStore<row_parts::ContactPoint>;
template class detail::PartStore<row_parts::ContactTwist>;

}  // namespace taut
