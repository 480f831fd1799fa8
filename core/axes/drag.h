#pragma once

#include <cmath>

#include "core/axes/axis_field.h"

namespace taut {

/// Drag that grows with the square of the rate, −c θ̇ |θ̇|, as of what moves through air or water.
struct AxisDrag {
  double coefficient = 0;  ///< c [N·m·s²/rad² or N·s²/m²]

  /// What the property says of itself.
  static constexpr AxisFacts kFacts{
      .key = "drag",
      .phrase = "drag",
      .text =
          "Drag that grows with the square of the rate, −coefficient θ̇ |θ̇|, as of what moves through air "
          "or water.",
      .term = "damping"};
  /// use(field, …) with its members.
  template <typename Use>
  static constexpr auto fields(Use use) {
    return use(axis_field("coefficient", &AxisDrag::coefficient, AxisRange::kNotNegative,
                          {.text = "[N·m·s²/rad² or N·s²/m²]", .acts = true}));
  }

  /// Force along the axis [N·m or N], and its slope by the rate.  @{
  double force(double, double rate) const { return -coefficient * rate * std::abs(rate); }
  double rate_slope(double, double rate) const { return -2 * coefficient * std::abs(rate); }  /// @}
};

/// Where what is said of a part of an axis, such as its force, has that of the drag.
template <typename Value>
struct AxisMember<AxisDrag, Value> {
  Value drag{};                                       ///< of the drag
  static constexpr auto kMember = &AxisMember::drag;  ///< the place
};

}  // namespace taut
