#include "core/joints/ball.h"

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

}  // namespace taut
