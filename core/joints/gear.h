#pragma once

#include "core/joints/axis_coupling.h"

namespace taut {

/// Gear: the axis `driven` follows the axis `driving` by a ratio, θ_driven = ratio θ_driving + const.
///   φ = θ_driven − ratio θ_driving − offset                                         (core/joints, Eq. 15)
/// Two wheels with z₁ and z₂ teeth on parallel hinges of one direction mesh outside with ratio −z₁/z₂ and
/// inside with z₁/z₂; bevel gears, belts and couplings of displacements differ only in the axes and the
/// ratio. λ is the torque on the driven axis, −ratio λ that on the driving one.
class Gear final : public AxisCoupling {
 public:
  /// @throws std::invalid_argument if an axis is missing, both are the same, or the ratio is not finite or 0.
  Gear(const World& world, AxisId driving, AxisId driven, double ratio);
  std::string_view type() const override { return "gear"; }
};

}  // namespace taut
