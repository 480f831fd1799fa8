#include <cmath>
#include <sstream>

#include "core/base/check.h"
#include "scenes/builders/bridge.h"
#include "scenes/builders/capstan.h"
#include "scenes/builders/chain.h"
#include "scenes/builders/joint_grid.h"
#include "scenes/builders/mechanisms.h"
#include "scenes/builders/net.h"
#include "scenes/builders/net_drag.h"
#include "scenes/builders/ragdoll.h"
#include "scenes/builders/scene.h"
#include "scenes/builders/stacks.h"
#include "scenes/builders/suspension_bridge.h"
#include "scenes/builders/tank.h"
#include "scenes/builders/vehicle_bridge.h"
#include "scenes/support/suggestion.h"

namespace taut {
namespace {

std::vector<SceneInfo> collect() {
  std::vector<SceneInfo> all;
  for (const auto& family : {chain_scenes, capstan_scenes, bridge_scenes, crossing_scenes, net_scenes,
                             net_drag_scenes, joint_grid_scenes, machine_scenes, ragdoll_scenes, stack_scenes,
                             suspension_bridge_scenes, tank_scenes})
    for (SceneInfo& info : family()) all.push_back(std::move(info));
  return all;
}

/// Refuses a name that is none of the list's: with the one that may be meant, or else with all that there
/// are.
template <typename List>
[[noreturn]] void refuse_name(const std::string& what, const std::string& name, const List& list) {
  std::vector<std::string> names;
  std::string all;
  for (const auto& item : list) {
    names.push_back(item.name);
    all += (all.empty() ? "" : ", ") + item.name;
  }
  std::string instead = did_you_mean(name, names);
  if (instead.empty()) instead = all.empty() ? ", and no other" : ", but " + all;
  fail(what, "there is none of this name" + instead, name);
}

const SceneInfo& find_scene(const std::string& name) {
  for (const SceneInfo& info : scene_catalogue())
    if (info.name == name) return info;
  refuse_name("scene", name, scene_catalogue());
}

void check_value(const std::string& scene, const ParameterInfo& info, double value) {
  if (std::isfinite(value) && value >= info.minimum && value <= info.maximum &&
      (!info.integer || value == std::floor(value)))
    return;
  if (info.unit == "bool") fail("parameter " + info.name + " of " + scene, "must be true or false", value);
  std::ostringstream allowed;
  allowed << "must be " << (info.integer ? "a whole number" : "a number") << " from " << info.minimum
          << " to " << info.maximum;
  if (!info.unit.empty()) allowed << ' ' << info.unit;
  fail("parameter " + info.name + " of " + scene, allowed.str(), value);
}

}  // namespace

const std::vector<SceneInfo>& scene_catalogue() {
  static const std::vector<SceneInfo> catalogue = collect();
  return catalogue;
}

Scene build_scene(const std::string& name, const std::map<std::string, double>& parameters) {
  const SceneInfo& info = find_scene(name);
  std::map<std::string, double> all;
  for (const ParameterInfo& parameter : info.parameters) all[parameter.name] = parameter.default_value;
  for (const auto& [key, value] : parameters) {
    if (!all.contains(key)) refuse_name("parameter of " + name, key, info.parameters);
    all[key] = value;
  }
  for (const ParameterInfo& parameter : info.parameters) check_value(name, parameter, all[parameter.name]);
  Scene scene = info.build(all);
  for (const ParameterInfo& parameter : info.parameters)
    if (!parameter.unit.empty()) scene.parameter_units[parameter.name] = parameter.unit;
  return scene;
}

}  // namespace taut
