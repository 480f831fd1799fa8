#pragma once

#include <optional>

#include "collision/contact.h"

namespace taut {

/// What a contact gave over a step.
struct ContactReport {
  Contact contact;  ///< where it is at the end of the step, or was last
  Vec3 force =
      Vec3::Zero();  ///< on B, world axes: impulse of the step divided by dt [N]; A gets the opposite
  Vec3 torque = Vec3::Zero();  ///< on B, of rolling and spinning friction [N·m]
  double normal_force = 0;     ///< of it, along the normal [N], ≥ 0
  bool sliding = false;        ///< at the end of the step
  /// [s] of the last impact in the step: points that came together faster than Settings::resting_speed
  std::optional<double> impact_time;
};

/// Work of all contacts in a step [J].
struct ContactWork {
  double normal = 0;    ///< of normal impulses: what impacts take
  double friction = 0;  ///< of friction, rolling and spinning friction
  double total() const { return normal + friction; }
};

}  // namespace taut
