#include "scenes/files/scene_source.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "core/base/check.h"
#include "scenes/files/scene_file.h"
#include "scenes/support/suggestion.h"

namespace taut {

bool is_scene_file(const std::string& name_or_file) {
  return name_or_file.find('/') != std::string::npos || name_or_file.ends_with(".json");
}

namespace {

bool is_there(const std::string& file) {
  std::error_code error;
  return std::filesystem::exists(file, error);
}

bool is_builder(const std::string& name) {
  const std::vector<SceneInfo>& all = scene_catalogue();
  return std::any_of(all.begin(), all.end(), [&](const SceneInfo& info) { return info.name == name; });
}

/// A name with an ending that it must not have, or the other way round.
void refuse_wrong_ending(const std::string& given) {
  if (is_scene_file(given)) {
    const std::string stem = std::filesystem::path(given).stem().string();
    if (!is_there(given) && is_builder(stem))
      fail("scene", "there is no such file; did you mean the scene \"" + stem + "\"?", given);
  } else if (!is_builder(given)) {
    if (is_there(given + ".json"))
      fail("scene", "there is none of this name; did you mean the file \"" + given + ".json\"?", given);
    if (const std::string file = did_you_mean_file(given); given.find('.') != given.npos && !file.empty())
      fail("scene", "there is none of this name, and no such file" + file, given);
    if (is_there(given))
      fail("scene",
           "there is none of this name; a scene file ends in .json, or has a / in its name: ./" + given,
           given);
  }
}

}  // namespace

Scene open_scene(const std::string& name_or_file, const std::map<std::string, double>& parameters) {
  refuse_wrong_ending(name_or_file);
  if (!is_scene_file(name_or_file)) return build_scene(name_or_file, parameters);
  if (!parameters.empty())
    fail("--set", "a scene file has no parameters; edit " + name_or_file, parameters.begin()->first);
  return load_scene_file(name_or_file);
}

void add_parameter(std::map<std::string, double>& parameters, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) fail("--set", "must be key=value", assignment);
  const std::string key = assignment.substr(0, equals), text = assignment.substr(equals + 1);
  double value = text == "true";
  if (text != "true" && text != "false") {
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end || !std::isfinite(value))
      fail("--set", "the value must be a finite number, true or false", assignment);
  }
  if (!parameters.emplace(key, value).second) fail("--set", "the parameter is given twice", assignment);
}

}  // namespace taut
