#include "core/joints/ball.h"

#include "core/base/check.h"
#include "core/constraints/ball_parts.h"

namespace taut {

Ball Ball::with_axes(const World& world, const Vec3& axis_W) const {
  require_unit("ball axis", axis_W);
  Mat3 R;
  Vec3 x, y;
  complete_frame(axis_W, x, y);
  R << x, y, axis_W;
  const Quat q_WF(R);
  return with_axes(relative(world.pose(a()).q, q_WF), relative(world.pose(b()).q, q_WF));
}

void Ball::append_axes(AxisSink& axes) const {
  if (!frames_) return;
  const Vec3 x_A = frames_->q_AF * Vec3::UnitX(), y_A = frames_->q_AF * Vec3::UnitY(),
             z_A = frames_->q_AF * Vec3::UnitZ(), z_B = frames_->q_BG * Vec3::UnitZ();
  axes.add("swing", row_parts::Swing{z_A, z_B, {.turns = {2, 3}, .components = {5, 6}}});
  axes.add("twist", row_parts::TwistAngle{frames_->q_AF, frames_->q_BG});
  axes.add("turn_x", row_parts::Turn{x_A});
  axes.add("turn_y", row_parts::Turn{y_A});
  axes.add("turn_z", row_parts::Turn{z_A});
  axes.add("swing_x", row_parts::SwingComponent{z_A, z_B, x_A});
  axes.add("swing_y", row_parts::SwingComponent{z_A, z_B, y_A});
}

Ball::Ball(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ) : Joint(a, b), p_AP_(p_AP), p_BQ_(p_BQ) {
  require_all_finite("ball anchor on A", p_AP);
  require_all_finite("ball anchor on B", p_BQ);
}

Ball Ball::at(const World& world, BodyId a, BodyId b, const Vec3& p_W) {
  return {a, b, world.pose(a).local(p_W), world.pose(b).local(p_W)};
}

Ball Ball::with_axes(const Quat& q_AF, const Quat& q_BG) const {
  require_unit("ball frame on A", q_AF.coeffs());
  require_unit("ball frame on B", q_BG.coeffs());
  Ball joint = *this;
  joint.frames_ = Frames{q_AF, q_BG};
  return joint;
}

void Ball::append_rows(RowSink& rows) const { rows.add(row_parts::Point{p_AP_, p_BQ_}); }

}  // namespace taut
