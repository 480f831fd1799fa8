#include "core/axes/motor.h"

#include "core/base/check.h"

namespace taut {

void AxisMotor::check(std::string_view axis) const {
  using detail::of_axis;
  if (mode == Mode::kTrajectory && !trajectory)
    fail(of_axis("motor trajectory", axis), "must be given in its mode", "null");
  if (mode == Mode::kVelocity && max_speed != kUnlimited)
    fail(of_axis("motor max_speed", axis), "is for a position or trajectory, not beside a velocity",
         max_speed);
  if (mode == Mode::kVelocity && stiffness != 0)
    fail(of_axis("motor stiffness", axis), "is for a position or trajectory, not beside a velocity",
         stiffness);
  if (has_gains() && max_speed != kUnlimited)
    fail(of_axis("motor max_speed", axis), "is for a motor without stiffness and damping", max_speed);
  if (has_gains() && pulls_only)
    fail(of_axis("motor stiffness and damping", axis), "must be 0 where it only pulls",
         stiffness > 0 ? stiffness : damping);
  if (!force_of_speed) return;
  for (const Curve::Point& p : force_of_speed->points()) {
    require_not_negative(of_axis("speed in the motor curve", axis), p.x);
    require_not_negative(of_axis("force in the motor curve", axis), p.y);
  }
}

}  // namespace taut
