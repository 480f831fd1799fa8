#pragma once

#include "core/joints/axis_coupling.h"

namespace taut {

/// Rack and pinion: the displacement of the rack follows the turn of the pinion, x = radius θ + const.
///   φ = x − radius θ − offset [m]                                                    (core/joints, Eq. 16)
/// λ is the force on the rack along its axis, −radius λ the torque on the pinion.
class RackAndPinion final : public AxisCoupling {
 public:
  /// A negative radius [m] drives the rack the other way.
  /// @throws std::invalid_argument if an axis is missing, the pinion's is no angle or the rack's no
  /// displacement, or the radius is not finite or 0.
  RackAndPinion(const World& world, AxisId pinion, AxisId rack, double radius);
  std::string_view type() const override { return "rack_and_pinion"; }
};

}  // namespace taut
