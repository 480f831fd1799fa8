#pragma once

#include "core/axes/axis_field.h"

namespace taut {

/// Coulomb and viscous friction: sticks up to `static_friction`, then slides with `dynamic_friction`;
/// −`viscous` θ̇ besides.
struct AxisFriction {
  double static_friction = 0;   ///< [N·m or N]
  double dynamic_friction = 0;  ///< [N·m or N], at most static_friction
  double viscous = 0;           ///< [N·m·s/rad or N·s/m]
  /// Static and dynamic friction also grow by this times the force [N] that the joint's translation rows
  /// carry: μ r [m] for a pin of radius r, μ for a slider.
  double per_load = 0;

  /// What the property says of itself.
  static constexpr AxisFacts kFacts{
      .key = "friction",
      .phrase = "friction",
      .text =
          "Coulomb and viscous friction: sticks up to the static friction [N·m or N], then slides with "
          "the dynamic one; −viscous θ̇ besides.  Both also grow by `per_load` times the force [N] that "
          "the joint's translation rows carry.",
      .jumps = 1};  // at rest
  /// use(field, …) with its members.
  template <typename Use>
  static constexpr auto fields(Use use) {
    return use(
        axis_field(
            "static", &AxisFriction::static_friction, AxisRange::kNotNegative,
            {.text = "[N·m or N]", .label = "static friction", .name = "static_friction", .acts = true}),
        axis_field("dynamic", &AxisFriction::dynamic_friction, AxisRange::kNotNegative,
                   {.text = "[N·m or N], in scene files by default as static",
                    .label = "dynamic friction",
                    .name = "dynamic_friction",
                    .acts = true}),
        axis_field("viscous", &AxisFriction::viscous, AxisRange::kNotNegative,
                   {.text = "[N·m·s/rad or N·s/m]", .label = "viscous friction", .acts = true}),
        axis_field("per_load", &AxisFriction::per_load, AxisRange::kNotNegative,
                   {.text = "times the force that the joint carries [m or 1]",
                    .label = "friction per load",
                    .acts = true}));
  }
  /// Refuses dynamic above static friction.
  void check(std::string_view axis) const;
};

/// Where what is said of a part of an axis, such as its force, has that of the friction.
template <typename Value>
struct AxisMember<AxisFriction, Value> {
  Value friction{};                                       ///< of the friction
  static constexpr auto kMember = &AxisMember::friction;  ///< the place
};

}  // namespace taut
