#pragma once

#include <string>
#include <vector>

#include "core/world.h"

/// What can be said of a world before its first step.
namespace taut {

/// Velocities that joints forbid.  Where a step begins with J V + φ_t = 0 they are taken away by the least
/// impulses, without a trace in its report.
struct ForbiddenVelocity {
  double speed = 0, spin = 0;   ///< largest change of a body's v [m/s] and ω [rad/s]
  std::vector<JointId> joints;  ///< those with |J V + φ_t| of more than 1e-6 of what adds up to it
  bool empty() const { return joints.empty(); }
};
/// Rows that only drivers move, from rest, do not count.
ForbiddenVelocity forbidden_velocity(const World& world);

/// The distance [m] of neighbouring numbers at the coordinate of a body that is farthest from 0: no joint can
/// be closed much better.
double coarsest_position(const World& world);

}  // namespace taut
