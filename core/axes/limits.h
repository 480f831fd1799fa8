#pragma once

#include <string>

#include "core/axes/axis_field.h"

namespace taut {

/// lower ≤ θ ≤ upper, angles with their turns: an upper limit of 10π is five turns.  An impact at a limit
/// reverses the rate by the factor of restitution, θ̇⁺ = −e θ̇⁻.
/// With a compliance the limit is a spring of stiffness 1/compliance and a damper that act beyond it.
struct AxisLimits {
  double lower = -kUnlimited, upper = kUnlimited;  ///< [rad or m]
  double restitution = 0;                          ///< e, from 0 to 1
  double compliance = 0;                           ///< [rad/(N·m) or m/N]; then the restitution must be 0
  double damping = 0;                              ///< [N·m·s/rad or N·s/m], with a compliance

  /// What the property says of itself.
  static constexpr AxisFacts kFacts{
      .key = "limits",
      .phrase = "limits",
      .text =
          "lower ≤ θ ≤ upper [rad or m], angles with their turns.  An impact reverses the rate by the factor "
          "of restitution.  With a compliance [rad/(N·m) or m/N] the limit is a spring with a damper "
          "[N·m·s/rad or N·s/m] that act beyond it.",
      .jumps = 2};  // at both
  /// use(field, …) with its members.
  template <typename Use>
  static constexpr auto fields(Use use) {
    return use(axis_field("lower", &AxisLimits::lower, AxisRange::kLowest,
                          {.text = "[rad or m]", .label = "lower limit", .angular = true, .acts = true}),
               axis_field("upper", &AxisLimits::upper, AxisRange::kHighest,
                          {.text = "[rad or m]", .label = "upper limit", .angular = true, .acts = true}),
               axis_field("restitution", &AxisLimits::restitution, AxisRange::kFromZeroToOne,
                          {.text = "0 beside a compliance", .label = "restitution"}),
               axis_field("compliance", &AxisLimits::compliance, AxisRange::kNotNegative,
                          {.text = "[rad/(N·m) or m/N]", .label = "limit compliance"}),
               axis_field("damping", &AxisLimits::damping, AxisRange::kNotNegative,
                          {.text = "[N·m·s/rad or N·s/m], with a compliance", .label = "limit damping"}));
  }
  /// Refuses limits that are crossed, a restitution beside a compliance, and damping without one.
  void check(std::string_view axis) const;

  /// What needs an axis that has positions, for messages; null: nothing.
  const char* needs_position() const { return "limits"; }
  bool stores_energy() const { return compliance > 0; }  ///< it is a spring
  double energy(double theta) const;                     ///< limit_energy()
  /// How a start at θ violates it by more than the tolerance, for messages; empty if it does not.
  std::string start_problem(double theta, double tolerance) const;
};

/// Where what is said of a part of an axis, such as its force, has that of the limits.
template <typename Value>
struct AxisMember<AxisLimits, Value> {
  Value limits{};                                       ///< of the limits
  static constexpr auto kMember = &AxisMember::limits;  ///< the place
};

/// How far θ is beyond limits [rad or m]: positive above the upper, negative below the lower one.
double beyond(const AxisLimits& limits, double theta);
/// Potential energy of a limit with compliance [J]: ½ beyond()²/compliance; 0 for a rigid one.
double limit_energy(const AxisLimits& limits, double theta);

}  // namespace taut
