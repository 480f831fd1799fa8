#include "scenes/import/mjcf_tree.h"

// Models that are parts of others.
namespace taut::model {
namespace {

/// Models in models: deeper ones name each other in a circle.
constexpr int kMostModelsDeep = 16;

}  // namespace

/// Without a name it is this one itself.
pugi::xml_node MjcfTree::model_named(const pugi::xml_node& node, const std::string& name) {
  if (name.empty()) return mujoco_;
  if (const auto known = models_.find(name); known != models_.end()) return known->second;
  for (const pugi::xml_node& asset : files_.children(mujoco_, "asset"))
    for (const pugi::xml_node& entry : files_.children(asset, "model")) {
      const char* given = files_.find(entry, "name");
      if (given && given != name) continue;
      const pugi::xml_node root = files_.open_model(entry, files_.required(entry, "file"));
      if (std::string_view(root.name()) != "mujoco") files_.fail(root, "an attached model must be <mujoco>");
      if (given || name == root.attribute("model").value()) return models_[name] = root;
    }
  files_.fail(node, "there is no <model> of this name (value: " + name + ")");
}

void MjcfTree::read_attach(const pugi::xml_node& node, const Where& where) {
  if (depth_ >= kMostModelsDeep) files_.fail(node, "models attach each other too deep");
  const MjcfElement attach(files_, node);
  const std::string name = attach.text("model");
  const char* part = node.attribute("body") ? "body" : "frame";
  const std::string prefix = files_.find(node, "prefix") ? node.attribute("prefix").value() : "";
  auto attached = std::make_unique<MjcfTree>(files_, model_named(node, name), model_, depth_ + 1);
  Where inside = where;
  inside.childclass.clear();
  inside.beginning = where.beginning + prefix;
  attached->prefix_ = inside.beginning;
  if (node.attribute(part))
    attached->read_part(attach, inside);
  else
    attached->read_all(inside);
  adopt(*attached, prefix);
  attached_.push_back(std::move(attached));
}

void MjcfTree::read_part(const MjcfElement& attach, const Where& where) {
  const char* kind = attach.node().attribute("body") ? "body" : "frame";
  const std::string name = attach.text(kind);
  names_.lacks_some = true;  // the rest of the model
  for (const pugi::xml_node& world : files_.children(mujoco_, "worldbody"))
    if (const pugi::xml_node part = find_part(world, kind, name)) return read_child(part, where);
  attach.fail(std::string("\"") + kind + "\" names nothing of the model (value: " + name + ")");
}

pugi::xml_node MjcfTree::find_part(const pugi::xml_node& parent, const char* kind, const std::string& name) {
  for (const pugi::xml_node& child : files_.children(parent)) {
    if (std::string_view(child.name()) == kind && name == child.attribute("name").value()) return child;
    if (const pugi::xml_node found = find_part(child, kind, name)) return found;
  }
  return {};
}

/// What the attached model has defined is known here with the prefix.
void MjcfTree::adopt(const MjcfTree& attached, const std::string& prefix) {
  const auto merge = [&](auto& into, const auto& from) {
    for (const auto& [name, value] : from)
      if (name != "world") into.try_emplace(prefix + name, value);
  };
  merge(names_.bodies, attached.names_.bodies);
  merge(names_.sites, attached.names_.sites);
  merge(names_.geoms, attached.names_.geoms);
  merge(names_.joints, attached.names_.joints);
  for (const std::string& name : attached.names_.free_joints) names_.free_joints.insert(prefix + name);
}

}  // namespace taut::model
