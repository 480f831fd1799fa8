#pragma once

#include <string>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"

/// What can be said of settings before a step is done: which exclude each other, and which have no effect.
namespace taut {

/// @throws std::invalid_argument naming a setting that is out of range.
void check_settings(const Settings& settings);

/// Joint forces from the acceleration equation: no sub-steps, and equalities only.
bool is_force_level(Integrator integrator);
/// Trees of joints in reduced coordinates, and which of these are dense or by the midpoint rule.  @{
bool is_reduced(Integrator integrator);
bool is_lagrangian(Integrator integrator);
bool is_midpoint(Integrator integrator);  /// @}
/// Force level and reduced coordinates: they have no contacts, and ask for forces as often as they need.
bool has_no_laws(Integrator integrator);

/// Two settings that exclude each other, or one that something in the world excludes.  Names are those of
/// scene files (setting_names.h).
struct SettingConflict {
  struct Choice {
    std::string setting, value;
  };
  Choice first, second;  ///< `second` has no names if it is the world
  std::string reason;
};
std::vector<SettingConflict> setting_conflicts(const Settings& settings);
/// Those with what is in the world.
std::vector<SettingConflict> setting_conflicts(const Settings& settings, const World& world);
/// @throws std::invalid_argument naming both of the first.
void require_none(const std::vector<SettingConflict>& conflicts);

/// A setting that the others leave without effect.
struct UnusedSetting {
  std::string setting;
  std::string reason;  ///< `only the integrator "moreau-jean" uses it`
};
std::vector<UnusedSetting> unused_settings(const Settings& settings);

}  // namespace taut
