#pragma once

#include <optional>

#include "core/axes/axis_field.h"
#include "core/axes/curve.h"

namespace taut {

/// Spring and damper: force −k (θ − rest) − c θ̇, each of them by a table if it has one:
/// −table(θ − rest) − damping_table(θ̇).
struct AxisSpring {
  double stiffness = 0;  ///< k [N·m/rad or N/m]; 0 with a table
  double damping = 0;    ///< c [N·m·s/rad or N·s/m]; 0 with a damping table
  double rest = 0;       ///< [rad or m]
  /// θ − rest → restoring force, extended beyond its ends.
  std::optional<Curve> table{};
  /// θ̇ → force against it, extended beyond its ends.
  std::optional<Curve> damping_table{};

  /// What the property says of itself.
  static constexpr AxisFacts kFacts{
      .key = "spring",
      .phrase = "a spring",
      .text =
          "Spring and damper along an axis: force −stiffness (θ − rest) − damping θ̇, each by a table if it "
          "has one: −table(θ − rest) − damping_table(θ̇)."};
  /// use(field, …) with its members.
  template <typename Use>
  static constexpr auto fields(Use use) {
    return use(
        axis_field("stiffness", &AxisSpring::stiffness, AxisRange::kNotNegative,
                   {.text = "[N·m/rad or N/m]; 0 with a table", .acts = true}),
        axis_field("damping", &AxisSpring::damping, AxisRange::kNotNegative,
                   {.text = "[N·m·s/rad or N·s/m]; 0 with a damping table", .acts = true}),
        axis_field("rest", &AxisSpring::rest, AxisRange::kFinite, {.text = "[rad or m]", .angular = true}),
        axis_field("table", &AxisSpring::table,
                   {.text = "θ − rest → restoring force", .angular = true, .acts = true}),
        axis_field(
            "damping_table", &AxisSpring::damping_table,
            {.text = "θ̇ → force against it; through 0, and nowhere falling", .angular = true, .acts = true}));
  }
  /// Refuses a stiffness beside a table, damping beside a table of it, and such a table that falls somewhere
  /// or does not go through 0.
  void check(std::string_view axis) const;

  /// What needs an axis that has positions, for messages; null: nothing.
  const char* needs_position() const { return "spring"; }
  bool stores_energy() const { return true; }  ///< also where its stiffness is 0
  double energy(double theta) const;           ///< spring_energy()
};

/// Where what is said of a part of an axis, such as its force, has that of the spring.
template <typename Value>
struct AxisMember<AxisSpring, Value> {
  Value spring{};                                       ///< of the spring
  static constexpr auto kMember = &AxisMember::spring;  ///< the place
};

/// Force of the spring along the axis at θ [N·m or N]: −k (θ − rest), or −table(θ − rest).
double spring_force(const AxisSpring& spring, double theta);
double damping_force(const AxisSpring& spring, double rate);  ///< the damper's at θ̇ [N·m or N]
/// Potential energy of the spring at θ [J]: ½ k (θ − rest)², or the integral of its table from rest.
double spring_energy(const AxisSpring& spring, double theta);

}  // namespace taut
