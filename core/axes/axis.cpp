#include "core/axes/axis.h"

#include <string>

namespace taut {

bool AxisProperties::any() const {
  return with_all(*this, [](const auto&... all) { return (all.has_value() || ...); });
}

std::string AxisProperties::phrases() const {
  std::string phrases;
  for_axis_types_backward([&]<typename Property>() {
    if (get<Property>()) phrases += (phrases.empty() ? "" : ", ") + std::string(Property::kFacts.phrase);
  });
  return phrases;
}

bool AxisProperties::stores_energy() const {
  bool stores = false;
  each([&](const auto& property) {
    if constexpr (requires { property.stores_energy(); }) stores = stores || property.stores_energy();
  });
  return stores;
}

void AxisProperties::add_energy(double theta, double& energy) const {
  each([&](const auto& property) {
    if constexpr (requires { property.stores_energy(); })
      if (property.stores_energy()) energy += property.energy(theta);
  });
}

bool AxisProperties::keeps_going() const {
  bool goes = false;
  each([&](const auto& property) {
    if constexpr (requires { property.keeps_going(); }) goes = goes || property.keeps_going();
  });
  return goes;
}

}  // namespace taut
