#pragma once

#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "core/axes/axis_field.h"
#include "core/axes/drag.h"
#include "core/axes/friction.h"
#include "core/axes/limits.h"
#include "core/axes/motor.h"
#include "core/axes/spring.h"

/// What can act along a free axis of a joint.  An axis is a scalar coordinate θ(q) [rad or m] with rate θ̇;
/// forces along it are torques [N·m] about an angle and forces [N] along a displacement.  A positive one acts
/// on body B towards larger θ, and the opposite on A.
///
/// A property says by kFacts and fields() what it is, and by members whose names are those of AxisLimits,
/// AxisMotor and AxisSpring what else concerns others than its law; AxisProperties asks those that have them.
/// (core/axes, "A new axis property")
namespace taut {

/// All properties, in the order in which what they store is added up.
using AllAxisProperties = AxisTypes<AxisSpring, AxisFriction, AxisMotor, AxisLimits, AxisDrag>;

/// Calls `use.template operator()<Property>()` for each property, in the order of AllAxisProperties.  @{
template <typename Use, typename... Properties>
constexpr void for_axis_types(Use use, AxisTypes<Properties...>) {
  (use.template operator()<Properties>(), ...);
}
template <typename Use>
constexpr void for_axis_types(Use use) {
  for_axis_types(use, AllAxisProperties{});
}  /// @}

/// Calls it for each from the last to the first, the order in which files and messages name them.  @{
template <typename Use, typename First, typename... Others>
constexpr void for_axis_types_backward(Use use, AxisTypes<First, Others...>) {
  if constexpr (sizeof...(Others) > 0) for_axis_types_backward(use, AxisTypes<Others...>{});
  use.template operator()<First>();
}
template <typename Use>
constexpr void for_axis_types_backward(Use use) {
  for_axis_types_backward(use, AllAxisProperties{});
}  /// @}

namespace detail {
/// A place for each property, `spring`, `friction` and so on; with_all() is use(property, …) with all of
/// them, set or not, in the order of AllAxisProperties.
template <typename Types>
struct AxisPlaces;
template <typename... Properties>
struct AxisPlaces<AxisTypes<Properties...>> : AxisMember<Properties, std::optional<Properties>>... {
  template <typename Self, typename Use>
  static auto with_all(Self& self, Use use) {
    return use(self.*AxisMember<Properties, std::optional<Properties>>::kMember...);
  }
  static constexpr int kJumps = (Properties::kFacts.jumps + ...);
  template <typename Property>
  static constexpr bool kHas = (std::is_same_v<Property, Properties> || ...);
};
}  // namespace detail

/// All that acts along one axis: `spring`, `friction`, `motor`, `limits` and so on, each a std::optional that
/// is empty where there is none.
struct AxisProperties : detail::AxisPlaces<AllAxisProperties> {
  /// The property of this type, if it is set.  @{
  template <typename Property>
  const std::optional<Property>& get() const {
    return this->*AxisMember<Property, std::optional<Property>>::kMember;
  }
  template <typename Property>
  std::optional<Property>& get() {
    return this->*AxisMember<Property, std::optional<Property>>::kMember;
  }  /// @}
  /// visit(property) for each that is set.
  template <typename Visit>
  void each(Visit visit) const {
    with_all(*this, [&](const auto&... all) { ((all ? visit(*all) : void()), ...); });
  }
  /// Sets the property of this type; an optional that is empty takes it away.  @{
  template <typename Property>
  void set(std::optional<Property> value) {
    static_assert(kHas<Property>, "no axis property");
    get<Property>() = std::move(value);
  }
  template <typename Property>
  void set(Property value) {
    set(std::optional<Property>(std::move(value)));
  }  /// @}

  bool any() const;                                     ///< something is set
  std::string phrases() const;                          ///< what is: "a motor, friction"; for messages
  bool stores_energy() const;                           ///< something stores it
  void add_energy(double theta, double& energy) const;  ///< adds what is stored at θ [J], one by one
  bool keeps_going() const;  ///< something would move an axis that rests if it could
};

/// At how many rates the force along an axis with all properties jumps.
inline constexpr int kMostAxisJumps = AxisProperties::kJumps;

}  // namespace taut
