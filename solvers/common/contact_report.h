#pragma once

#include <optional>

#include "collision/narrow/contact.h"

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

/// The spring of a compliant contact across its normal, which no pose shows: with those of all contacts a
/// state is whole.  Friction on B is −stretch / compliance.
struct ContactStretch {
  ShapeId a, b;              ///< a.index < b.index
  Vec3 p_AP = Vec3::Zero();  ///< [m] where the contact is, in the frame of a's body, from its centre of mass
  Vec3 stretch = Vec3::Zero();  ///< [m] of B along A, world axes
  bool holds = true;            ///< by static friction
};

/// Work of all contacts in a step [J].
struct ContactWork {
  double normal = 0;                                  ///< of normal impulses: what impacts take
  double friction = 0;                                ///< of friction, rolling and spinning friction
  double total() const { return normal + friction; }  ///< of both
};

}  // namespace taut
