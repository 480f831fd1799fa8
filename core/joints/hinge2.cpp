#include "core/joints/hinge2.h"

#include "core/base/check.h"

namespace taut {

Hinge2::Hinge2(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& steering_A, const Vec3& p_BQ,
               const Vec3& spin_B)
    : Joint(a, b), p_AP_(p_AP), steering_A_(steering_A), p_BQ_(p_BQ), spin_B_(spin_B) {
  require_all_finite("hinge2 anchor on A", p_AP);
  require_all_finite("hinge2 anchor on B", p_BQ);
  require_unit("hinge2 steering axis on A", steering_A);
  require_unit("hinge2 spin axis on B", spin_B);
  Vec3 unused;
  complete_frame(steering_A, reference_A_, unused);
  complete_frame(spin_B, reference_B_, unused);
}

Hinge2 Hinge2::at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Vec3& steering_W,
                  const Vec3& spin_W) {
  require_unit("hinge2 steering axis", steering_W);
  require_unit("hinge2 spin axis", spin_W);
  if (std::abs(steering_W.dot(spin_W)) > kUnitTolerance)
    fail("hinge2 axes", "must be perpendicular (cosine)", steering_W.dot(spin_W));
  const Pose &A = world.pose(a), &B = world.pose(b);
  return Hinge2(a, b, A.local(p_W), A.q.conjugate() * steering_W, B.local(p_W), B.q.conjugate() * spin_W)
      .zeroed(A, B);
}

Hinge2 Hinge2::zeroed(const Pose& A, const Pose& B) const {
  Hinge2 joint = *this;
  joint.reference_A_ = across(A.q.conjugate() * (B.q * spin_B_), steering_A_);
  joint.reference_B_ = across(B.q.conjugate() * (A.q * steering_A_), spin_B_);
  return joint;
}

void Hinge2::append_rows(RowSink& rows) const {
  Vec3 u, v;
  complete_frame(steering_A_, u, v);
  rows.add(row_parts::PointInPlane{p_AP_, u, p_BQ_});
  rows.add(row_parts::PointInPlane{p_AP_, v, p_BQ_});
  rows.add(row_parts::Perpendicular{steering_A_, spin_B_});
}

void Hinge2::append_axes(AxisSink& axes) const {
  axes.add("travel", row_parts::Displacement{{p_AP_, steering_A_, p_BQ_}});
  axes.add("steering", row_parts::Angle{steering_A_, reference_A_, spin_B_});
  // Seen from the wheel, the steering axis turns the other way.
  axes.add("spin", row_parts::Angle{-spin_B_, reference_B_, steering_A_}, {1, 0});
}

}  // namespace taut
