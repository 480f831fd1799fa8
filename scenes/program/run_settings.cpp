#include "scenes/program/run_settings.h"

#include <utility>

#include "core/base/check.h"
#include "scenes/files/json_document.h"
#include "scenes/files/scene_source.h"
#include "solvers/common/setting_checks.h"

namespace taut {

SettingSources::SettingSources(const RunOptions& options, const Scene& scene) {
  for (const std::string& key : scene.given_settings)
    source_[key] = options.scene + ": " + child_path("/settings", key);
  const auto option = [&](bool given, const char* key, const char* name) {
    if (given) source_[key] = name;
  };
  option(options.integrator.has_value(), "integrator", "--integrator");
  option(options.tension.has_value(), "tension", "--tension");
  option(options.drift_cure.has_value(), "drift_cure", "--drift-cure");
  option(options.factor.has_value(), "factor", "--factor");
  option(options.solver.has_value(), "solver", "--solver");
  option(options.iterations.has_value(), "iterations", "--iterations");
  option(options.threads.has_value(), "threads", "--threads");
  for (std::size_t i = 0; i < options.numbers.size(); ++i)
    option(options.numbers[i].has_value(), kNumberOptions[i].key, kNumberOptions[i].option);
  option(options.sleep, "sleep", "--sleep");
  option(options.merge_fixed_joints, "merge_fixed_joints", "--merge-fixed-joints");
  option(options.locate_plastic_impacts, "locate_plastic_impacts", "--locate-plastic-impacts");
}

std::string SettingSources::name(const std::string& setting) const {
  const auto found = source_.find(setting);
  return found == source_.end() ? "setting " + setting : found->second;
}

void apply_settings(const RunOptions& options, Settings& settings) {
  const auto take = [](const auto& given, auto& value) {
    if (given) value = *given;
  };
  take(options.integrator, settings.integrator);
  take(options.tension, settings.tension);
  take(options.drift_cure, settings.drift_cure);
  take(options.factor, settings.factor);
  take(options.solver, settings.solver);
  take(options.iterations, settings.iterations);
  take(options.threads, settings.threads);
  for (std::size_t i = 0; i < options.numbers.size(); ++i)
    take(options.numbers[i], settings.*kNumberOptions[i].setting);
  if (options.sleep) settings.sleep = true;
  if (options.merge_fixed_joints) settings.merge_fixed_joints = true;
  if (options.locate_plastic_impacts) settings.locate_plastic_impacts = true;
}

void require_compatible(const Scene& scene, const SettingSources& sources) {
  std::vector<SettingConflict> conflicts = setting_conflicts(scene.settings);
  for (SettingConflict& conflict : setting_conflicts(scene.settings, scene.world))
    conflicts.push_back(std::move(conflict));
  if (conflicts.empty()) return;
  auto& [first, second, reason] = conflicts.front();
  if (second.setting.empty()) fail(sources.name(first.setting), reason, first.value);
  if (!sources.given(first.setting)) std::swap(first, second);
  fail(sources.name(first.setting),
       "excludes " + sources.name(second.setting) + " \"" + second.value + "\", since " + reason,
       first.value);
}

std::vector<std::string> settings_without_effect(const Settings& settings, const SettingSources& sources) {
  std::vector<std::string> sentences;
  for (const auto& [setting, reason] : unused_settings(settings))
    if (sources.given(setting)) sentences.push_back(sources.name(setting) + " has no effect: " + reason);
  return sentences;
}

}  // namespace taut
