#pragma once

#include "core/joints/axis_coupling.h"

namespace taut {

/// Differential: the angle of the case is the mean of those of its two shafts.
///   φ = θ_left + θ_right − 2 θ_case − offset [rad]                                   (core/joints, Eq. 17)
/// λ is the torque on either shaft, −2 λ that on the case: both shafts get the same.
class Differential final : public AxisCoupling {
 public:
  /// @throws std::invalid_argument if an axis is missing, is no angle, or is given twice.
  Differential(const World& world, AxisId input, AxisId left, AxisId right);
  std::string_view type() const override { return "differential"; }
};

}  // namespace taut
