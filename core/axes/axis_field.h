#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <type_traits>

/// What a property of an axis says of itself, by which others check it, read and describe it.
/// (core/axes, "A new axis property")
namespace taut {

inline constexpr double kUnlimited = std::numeric_limits<double>::infinity();  ///< no limit

/// Which values a number of a property may have.
enum class AxisRange {
  kFinite,         ///< any
  kNotNegative,    ///< finite and not negative
  kFromZeroToOne,  ///< from 0 to 1
  kBound,          ///< not negative, or unlimited
  kSpeed,          ///< positive, or unlimited
  kLowest,         ///< any, or −∞ for none
  kHighest,        ///< any, or ∞ for none
};

/// What else there is to say of a field.
struct AxisFieldNotes {
  const char* text = "";        ///< what it is, with its unit
  const char* label = nullptr;  ///< in messages; null: key of the property and of the field
  const char* name = nullptr;   ///< of its member, in Python too; null: its key
  bool angular = false;         ///< is θ or a rate of it, and so can also be given in degrees
  bool acts = false;            ///< of those that act one must be given
};

/// A member of a property: a number, a bool, or a Curve that may be missing.
template <typename Owner, typename Value>
struct AxisField {
  using Type = Value;    ///< of the member
  const char* key;       ///< in scene files; null: not there by itself
  Value Owner::*member;  ///< where it is
  AxisRange range;       ///< of a number
  AxisFieldNotes notes;  ///< what else there is
  /// Name of the member, in C++ and in Python.
  constexpr const char* name() const { return notes.name ? notes.name : key; }
};
/// A field of an axis property; the default of the member is that of the field.  @{
template <typename Owner>
constexpr AxisField<Owner, double> axis_field(const char* key, double Owner::*member, AxisRange range,
                                              AxisFieldNotes notes = {}) {
  return {key, member, range, notes};
}
template <typename Owner, typename Value>
constexpr AxisField<Owner, Value> axis_field(const char* key, Value Owner::*member,
                                             AxisFieldNotes notes = {}) {
  return {key, member, AxisRange::kFinite, notes};
}  /// @}

/// What a property says of itself, its kFacts.
struct AxisFacts {
  const char* key;        ///< in scene files and Python
  const char* phrase;     ///< in messages, "has a spring"
  const char* text;       ///< what it does, for Python and editors
  int jumps = 0;          ///< at how many rates its force jumps
  const char* term = "";  ///< of the energy ledger, of one whose law is in its header: where its work goes
};

/// The place of one Value for each property: a specialisation has one member, and kMember points at it.
template <typename Property, typename Value>
struct AxisMember;

/// Several properties.
template <typename... Properties>
struct AxisTypes {};

/// Its law is a smooth force in its header: force(θ, θ̇) [N·m or N] and rate_slope(θ, θ̇) ≤ 0, its slope by the
/// rate; place_slope(θ, θ̇), its slope by θ, if it depends on θ.  What it stores, if anything, is all that
/// force(θ, 0) does.
template <typename Property>
concept SmoothAxisProperty = requires(const Property& p, double x) {
  p.force(x, x) + p.rate_slope(x, x);
};
/// It stores energy(θ) [J], if stores_energy() says so.
template <typename Property>
concept StoringAxisProperty = requires(const Property& p, double x) {
  p.stores_energy() && p.energy(x) > 0;
};
/// Its law is bounded, and in its header: at most bound(θ) [N·m or N], finite, against the difference of the
/// rate from kept_rate().
template <typename Property>
concept BoundedAxisProperty = requires(const Property& p, double x) {
  p.bound(x) + p.kept_rate();
};
/// All of its law is in its header.
template <typename Property>
concept PlainAxisProperty = SmoothAxisProperty<Property> || BoundedAxisProperty<Property>;

/// use(field) for each field of a property, in order.
template <typename Property, typename Use>
constexpr void each_axis_field(Use use) {
  Property::fields([&](const auto&... field) { (use(field), ...); });
}

namespace detail {
bool is_in(AxisRange range, double value);
/// "spring stiffness of elbow angle must …", by the key of its property.
[[noreturn]] void fail_axis_number(std::string_view axis, const char* property, const char* key,
                                   const AxisFieldNotes& notes, AxisRange range, double value);
/// `what` of the axis, for messages.
std::string of_axis(const char* what, std::string_view axis);
}  // namespace detail

/// @throws std::invalid_argument naming `axis`, what is wrong and the value: a number that is not in its
/// range, and what the property's own check() refuses.
template <typename Property>
void check_axis(std::string_view axis, const Property& property) {
  each_axis_field<Property>([&](const auto& field) {
    if constexpr (std::is_same_v<typename std::decay_t<decltype(field)>::Type, double>)
      if (const double value = property.*field.member; !detail::is_in(field.range, value))
        detail::fail_axis_number(axis, Property::kFacts.key, field.key, field.notes, field.range, value);
  });
  if constexpr (requires { property.check(axis); }) property.check(axis);
}

}  // namespace taut
