#include "scenes/program/list_command.h"

#include <cstdio>

#include "core/base/check.h"
#include "scenes/builders/scene.h"
#include "scenes/recording/recorder.h"
#include "scenes/support/suggestion.h"

namespace taut {
namespace {

/// A value of the parameter, without its unit.
std::string value_text(const ParameterInfo& parameter, double value) {
  if (parameter.unit == "bool") return value != 0 ? "true" : "false";
  return parameter.integer ? std::to_string(static_cast<long long>(value)) : shortest(value);
}

std::string parameter_line(const ParameterInfo& parameter) {
  std::string range = "true or false";
  if (parameter.unit != "bool") {
    range = value_text(parameter, parameter.minimum) + " … " + value_text(parameter, parameter.maximum);
    if (!parameter.unit.empty()) range += " " + parameter.unit;
    if (parameter.integer) range += ", integer";
  }
  char head[80];
  std::snprintf(head, sizeof head, "    %-24s ",
                (parameter.name + "=" + value_text(parameter, parameter.default_value)).c_str());
  return head + parameter.description + " (" + range + ")\n";
}

}  // namespace

std::string list_scenes(const std::string& name) {
  std::string text;
  std::vector<std::string> names;
  for (const SceneInfo& scene : scene_catalogue()) {
    names.push_back(scene.name);
    if (!name.empty() && scene.name != name) continue;
    text += scene.name + "\n    " + scene.description + "\n";
    for (const ParameterInfo& parameter : scene.parameters) text += parameter_line(parameter);
  }
  if (text.empty())
    fail("list", "there is no scene of that name, see `taut list`" + did_you_mean(name, names), name);
  return text;
}

}  // namespace taut
