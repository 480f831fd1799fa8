#pragma once

#include <array>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string_view>

#include "core/axes/axis.h"
#include "solvers/common/energy_ledger.h"

namespace taut {

namespace detail {
template <typename Property>
struct AxisPartOf {};  // of a property whose law is in solvers/laws
template <PlainAxisProperty Property>
struct AxisPartOf<Property> : AxisMember<Property, double> {};
template <typename Types>
struct PlainAxisParts;
template <typename... Properties>
struct PlainAxisParts<AxisTypes<Properties...>> : AxisPartOf<Properties>... {};
}  // namespace detail

/// A quantity along one axis by what gave it; forces and impulses are positive towards larger θ.  Besides the
/// members here there is one for each property whose law is all in its header, of the name that it has in
/// AxisProperties.
struct AxisImpulse : detail::PlainAxisParts<AllAxisProperties> {
  double motor = 0, friction = 0, limit = 0, spring = 0;  ///< friction: Coulomb's; limit: rigid
  /// Dampers of springs and soft limits, viscous friction, and what a property takes beside what it stores.
  double damping = 0;
  double elastic_limit = 0;  ///< limits with compliance, but for their dampers

  double total() const;                                   ///< sum
  AxisImpulse& operator+=(const AxisImpulse& other);      ///< adds each part
  AxisImpulse operator-(const AxisImpulse& other) const;  ///< of each part
};

/// A part of an AxisImpulse.
struct AxisPart {
  double AxisImpulse::*part;             ///< the member
  std::string_view column;               ///< of probes, which add the parts of one column
  double EnergyLedger::*term = nullptr;  ///< where its work goes; null: into energy that is stored
};
/// The part of a property whose law is all in its header.
template <PlainAxisProperty Property>
inline constexpr double AxisImpulse::*kAxisPartOf = AxisMember<Property, double>::kMember;

namespace detail {
inline constexpr AxisPart kOwnAxisParts[] = {
    {&AxisImpulse::motor, "motor", &EnergyLedger::motors},
    {&AxisImpulse::friction, "friction", &EnergyLedger::friction},
    {&AxisImpulse::limit, "limit", &EnergyLedger::limits},
    {&AxisImpulse::spring, "spring"},
    {&AxisImpulse::damping, "damping", &EnergyLedger::damping},
    {&AxisImpulse::elastic_limit, "limit"},
};
template <typename Property>
constexpr double EnergyLedger::*ledger_term_of() {
  if constexpr (StoringAxisProperty<Property>) return nullptr;
  for (const LedgerTerm& term : kLedgerTerms)
    if (term.name == Property::kFacts.term && !term.stored) return term.amount;
  throw "kFacts.term is no term of the ledger";  // not a constant then
}
template <typename... Properties>
constexpr auto axis_parts(AxisTypes<Properties...>) {
  std::array<AxisPart, std::size(kOwnAxisParts) + (0 + ... + PlainAxisProperty<Properties>)> parts{};
  std::size_t count = 0;
  for (const AxisPart& part : kOwnAxisParts) parts[count++] = part;
  const auto add = [&]<typename Property>() {
    if constexpr (PlainAxisProperty<Property>)
      parts[count++] = {kAxisPartOf<Property>, Property::kFacts.key, ledger_term_of<Property>()};
  };
  (add.template operator()<Properties>(), ...);
  return parts;
}
}  // namespace detail
/// All parts of an AxisImpulse, those of its properties behind its own.
inline constexpr auto kAxisParts = detail::axis_parts(AllAxisProperties{});

inline double AxisImpulse::total() const {
  double sum = 0;
  for (const auto& [part, column, term] : kAxisParts) sum += this->*part;
  return sum;
}
inline AxisImpulse& AxisImpulse::operator+=(const AxisImpulse& other) {
  for (const auto& [part, column, term] : kAxisParts) this->*part += other.*part;
  return *this;
}

inline AxisImpulse AxisImpulse::operator-(const AxisImpulse& other) const {
  AxisImpulse difference = *this;
  for (const auto& [part, column, term] : kAxisParts) difference.*part -= other.*part;
  return difference;
}

/// What acted along an axis over a step.
struct AxisReport {
  AxisImpulse force;                  ///< mean over the step [N·m or N]
  AxisImpulse work;                   ///< on the bodies [J]
  AxisImpulse power;                  ///< mean over the step [W]
  bool stuck = false;                 ///< friction holds the axis where it is
  bool saturated = false;             ///< the motor gives all it has and does not reach its target
  bool at_limit = false;              ///< a limit holds the axis
  std::optional<double> impact_time;  ///< of the last impact at a limit in the step [s]
};

}  // namespace taut
