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

/// "a, b, c" of the names in a list.
template <typename List>
std::string names_of(const List& list) {
  std::string names;
  for (const auto& item : list) names += (names.empty() ? "" : ", ") + item.name;
  return names;
}

const SceneInfo& find_scene(const std::string& name) {
  for (const SceneInfo& info : scene_catalogue())
    if (info.name == name) return info;
  fail("scene", "there is none of this name, but " + names_of(scene_catalogue()), name);
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
    if (!all.contains(key))
      fail("parameter of " + name, "there is none of this name, but " + names_of(info.parameters), key);
    all[key] = value;
  }
  for (const ParameterInfo& parameter : info.parameters) check_value(name, parameter, all[parameter.name]);
  return info.build(all);
}

}  // namespace taut
