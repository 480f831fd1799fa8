#pragma once

#include "core/joints/axis_coupling.h"

namespace taut {

/// Differential: the angle of the case is the mean of those of its two shafts.
///   φ = θ_left + θ_right − 2 θ_case − offset [rad]                                   (core/joints, Eq. 17)
/// λ is the torque on either shaft, −2 λ that on the case: both shafts get the same.
class Differential final : public AxisCoupling {
 public:
  /// @throws std::invalid_argument if an axis is missing, is no angle, or is given twice.
  Differential(const World& world, AxisId input, AxisId left, AxisId right)
      : AxisCoupling(world, "differential", {{input, -2}, {left, 1}, {right, 1}}) {
    for (AxisId axis : {input, left, right})
      if (!world.axis_info(axis).angular)
        fail("differential", "its axes must be angles", world.axis_label(axis));
    for (const auto& [first, second] : {std::pair(input, left), {input, right}, {left, right}})
      if (first == second) fail("differential", "has the same axis twice", world.axis_label(first));
  }
  std::string_view type() const override { return "differential"; }
};

}  // namespace taut
