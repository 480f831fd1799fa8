#pragma once

#include <optional>

#include "core/world.h"

namespace taut {

/// A swing of a joint that has friction.  Where it is 0 the direction of that axis is none, and friction of
/// it acts along two others of the joint instead: those have rows, too.                 (solvers/README,
/// "Axes")
struct SwingFriction {
  int swing = 0;              ///< by its place in the joint
  std::array<int, 2> turn{};  ///< AxisInfo::across
};

inline std::optional<SwingFriction> swing_friction(const World& world, JointId joint) {
  for (int k = 0; k < world.axis_count(joint); ++k) {
    const AxisId axis{joint, k};
    const std::array<int, 2>& across = world.axis_info(axis).across;
    if (across[0] >= 0 && world.axis_properties(axis).friction) return SwingFriction{k, across};
  }
  return {};
}

}  // namespace taut
