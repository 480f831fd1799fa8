#pragma once

#include "core/world.h"

namespace taut {

/// Axes of a ball joint, by their place in it.
enum BallAxis : int { kSwing = 0, kTwist, kTurnX, kTurnY, kTurnZ, kBallAxes };

/// Where its swing is 0 the direction of that axis is none, and friction of it acts against turns about x and
/// y of A instead: those have rows, too.                                             (solvers/README, "Axes")
inline bool has_swing_friction(const World& world, JointId joint) {
  return world.joint(joint).type() == "ball" && world.axis_count(joint) == kBallAxes &&
         world.axis_properties({joint, kSwing}).friction;
}

}  // namespace taut
