#include "scenes/files/generated_names.h"

#include <algorithm>
#include <cctype>

namespace taut {

std::string look_of(std::string_view name) {
  std::string look;
  for (char c : name) {
    if (!std::isdigit(static_cast<unsigned char>(c)))
      look += c;
    else if (look.empty() || look.back() != '0')
      look += '0';
  }
  return look;
}

std::set<std::string> looks_of(const SceneInfo& builder) {
  std::set<std::string> looks;
  const auto build = [&](const std::map<std::string, double>& parameters) {
    const World world = build_scene(builder.name, parameters).world;
    for (int b = 0; b < world.body_count(); ++b) looks.insert(look_of(world.name(BodyId{b})));
    for (int j = 0; j < world.joint_count(); ++j) looks.insert(look_of(world.name(JointId{j})));
    for (int m = 0; m < world.material_count(); ++m) looks.insert(look_of(world.name(MaterialId{m})));
  };
  build({});
  // What one more of everything adds, and every switch.
  std::map<std::string, double> more;
  for (const ParameterInfo& parameter : builder.parameters)
    more[parameter.name] = parameter.default_value < parameter.maximum
                               ? std::min(parameter.default_value + 1, parameter.maximum)
                               : parameter.minimum;
  build(more);
  return looks;
}

}  // namespace taut
