#pragma once

#include <map>
#include <string>
#include <vector>

#include "scenes/builders/scene.h"
#include "scenes/program/run_command.h"

namespace taut {

/// Where the settings of a run come from, as whoever gave them knows them.
class SettingSources {
 public:
  SettingSources(const RunOptions& options, const Scene& scene);

  /// By an option or the scene file.
  bool given(const std::string& setting) const { return source_.contains(setting); }
  /// `--theta`, `arm.json: /settings/theta`, or `setting theta` if nobody has given it.
  std::string name(const std::string& setting) const;

 private:
  std::map<std::string, std::string> source_;
};

/// Takes over what the options say.
void apply_settings(const RunOptions& options, Settings& settings);

/// @throws std::invalid_argument for settings that exclude each other or what is in the world.
void require_compatible(const Scene& scene, const SettingSources& sources);

/// A sentence for each setting that was given and has no effect beside the others.
std::vector<std::string> settings_without_effect(const Settings& settings, const SettingSources& sources);

}  // namespace taut
