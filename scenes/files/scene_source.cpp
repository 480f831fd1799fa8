#include "scenes/files/scene_source.h"

#include <charconv>
#include <cmath>

#include "core/base/check.h"
#include "scenes/files/scene_file.h"

namespace taut {

bool is_scene_file(const std::string& name_or_file) {
  return name_or_file.find('/') != std::string::npos || name_or_file.ends_with(".json");
}

Scene open_scene(const std::string& name_or_file, const std::map<std::string, double>& parameters) {
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
