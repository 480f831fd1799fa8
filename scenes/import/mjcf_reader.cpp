#include "scenes/import/mjcf_reader.h"

#include "scenes/import/mjcf_tree.h"

namespace taut::model {
namespace {

bool disabled(XmlFiles& files, const pugi::xml_node& flags, const char* what) {
  const char* text = files.find(flags, what);
  return text && std::string_view(text) == "disable";
}

void read_options(XmlFiles& files, const pugi::xml_node& mujoco, RobotModel& model) {
  model.dt = 0.002;
  model.joined_touch = true;
  bool weightless = false;
  for (const pugi::xml_node& option : files.children(mujoco, "option")) {
    model.dt = positive(files, option, "timestep", number(files, option, "timestep", model.dt));
    model.gravity = vector(files, option, "gravity", model.gravity);
    if (const char* groups = files.find(option, "actuatorgroupdisable"))
      for (double group : numbers(files, option, "actuatorgroupdisable", groups))
        model.groups_disabled.insert(static_cast<int>(group));
    for (const pugi::xml_node& flags : files.children(option, "flag")) {
      if (disabled(files, flags, "contact")) model.contacts = false;
      if (disabled(files, flags, "actuation")) model.actuation = false;
      if (disabled(files, flags, "gravity")) weightless = true;
      if (disabled(files, flags, "clampctrl")) model.clamps_controls = false;
    }
  }
  if (weightless) model.gravity.setZero();
}

}  // namespace

RobotModel read_mjcf(XmlFiles& files, const pugi::xml_node& mujoco) {
  RobotModel model;
  model.refuses_wrong_inertia = true;
  if (const char* name = files.find(mujoco, "model")) model.name = name;
  read_options(files, mujoco, model);
  MjcfTree tree(files, mujoco, model);
  tree.read_world();
  tree.finish();
  tree.relate();
  files.throw_problems();
  return model;
}

}  // namespace taut::model
