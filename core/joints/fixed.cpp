#include "core/joints/fixed.h"

#include "core/base/check.h"

namespace taut {

Fixed::Fixed(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ, const Quat& q_AB)
    : Joint(a, b), p_AP_(p_AP), p_BQ_(p_BQ), q_AB_(q_AB) {
  require_all_finite("fixed anchor on A", p_AP);
  require_all_finite("fixed anchor on B", p_BQ);
  require_unit("fixed orientation of B in A", q_AB.coeffs());
}

Fixed Fixed::at(const World& world, BodyId a, BodyId b, const Vec3& p_W) {
  const Pose &A = world.pose(a), &B = world.pose(b);
  return {a, b, A.local(p_W), B.local(p_W), relative(A.q, B.q)};
}

void Fixed::append_rows(RowSink& rows) const {
  rows.add(row_parts::Point{p_AP_, p_BQ_});
  rows.add(row_parts::Orientation{q_AB_, Quat::Identity()});
}

std::optional<Pose> Fixed::rigid_pose() const { return Pose{q_AB_, p_AP_ - q_AB_ * p_BQ_}; }

}  // namespace taut
