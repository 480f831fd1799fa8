#include "scenes/files/scene_reader.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/constraints/rows.h"
#include "core/world/diagnostics.h"
#include "scenes/files/generated_names.h"
#include "scenes/files/scene_merge.h"
#include "scenes/files/synonyms.h"
#include "solvers/common/setting_checks.h"

namespace taut {
namespace {

constexpr const char* kFormat = "taut-scene/1";
/// As World::validate().
constexpr double kGapTolerance = 1e-6;

/// What a probe's quantity belongs to.
enum class Subject { kBodyPoint, kBody, kJoint, kAxis, kWorld };
struct NamedQuantity {
  Probe::Quantity quantity;
  Subject subject;
};
using Quantity = Probe::Quantity;
constexpr std::pair<const char*, NamedQuantity> kQuantities[] = {
    {"position", {Quantity::kPosition, Subject::kBodyPoint}},
    {"velocity", {Quantity::kVelocity, Subject::kBodyPoint}},
    {"orientation", {Quantity::kOrientation, Subject::kBody}},
    {"angular-velocity", {Quantity::kAngularVelocity, Subject::kBody}},
    {"reaction-force", {Quantity::kReactionForce, Subject::kJoint}},
    {"reaction-torque", {Quantity::kReactionTorque, Subject::kJoint}},
    {"gap", {Quantity::kGap, Subject::kJoint}},
    {"energy", {Quantity::kEnergy, Subject::kWorld}},
    {"momentum", {Quantity::kMomentum, Subject::kWorld}},
    {"angular-momentum", {Quantity::kAngularMomentum, Subject::kWorld}},
    {"axis", {Quantity::kAxis, Subject::kAxis}},
    {"axis-force", {Quantity::kAxisForce, Subject::kAxis}},
    {"axis-power", {Quantity::kAxisPower, Subject::kAxis}},
    {"axis-state", {Quantity::kAxisState, Subject::kAxis}},
};

/// Names of bodies or joints, for suggestions.
template <typename Id>
std::vector<std::string> names_of(const World& world, int count) {
  std::vector<std::string> names;
  if (count <= 1000)  // more would take too long
    for (int i = 0; i < count; ++i) names.push_back(world.name(Id{i}));
  return names;
}

/// The parameters of a generate block; problems for those that the builder would not take.
std::map<std::string, double> read_parameters(const JsonNode& node, const SceneInfo& builder) {
  std::map<std::string, double> result;
  JsonObject object(node);
  for (const ParameterInfo& info : builder.parameters) {
    const auto member = object.find(info.name.c_str());
    if (!member) continue;
    const bool is_switch = info.unit == "bool" && member->json().is_boolean();
    const std::size_t before = node.problems().size();
    const double value = is_switch ? member->boolean() : member->number();
    if (node.problems().size() != before) continue;
    result[info.name] = value;
    if (value >= info.minimum && value <= info.maximum && (!info.integer || value == std::floor(value)))
      continue;
    std::ostringstream message;
    message << "must be " << (info.integer ? "a whole number" : "a number") << " from " << info.minimum
            << " to " << info.maximum;
    member->problem(message.str());
  }
  object.reject_unknown_keys();
  return result;
}

const SceneInfo* find_builder(const JsonNode& node) {
  const std::string name = node.string();
  std::vector<std::string> names;
  for (const SceneInfo& info : scene_catalogue()) {
    if (info.name == name) return &info;
    names.push_back(info.name);
  }
  if (!name.empty()) node.not_a_choice(names);
  return nullptr;
}

}  // namespace

Scene SceneReader::read(const nlohmann::json& document, const std::string& default_name) {
  scene_.name = default_name;
  JsonObject top(JsonNode(document, "/", problems_));
  if (!document.is_object()) return std::move(scene_);

  if (const auto format = top.required("format"); format && format->json() != kFormat)
    format->problem(std::string("must be \"") + kFormat + "\"");
  top.find("$schema");
  const auto each = [&](const char* key, void (SceneReader::*read_one)(const JsonNode&)) {
    if (const auto list = top.find(key))
      for (const JsonNode& item : list->items()) (this->*read_one)(item);
  };
  each("generate", &SceneReader::read_generate);
  read_top_level(top);
  if (const auto materials = top.find("materials")) read_materials(*materials);
  each("material_pairs", &SceneReader::read_material_pair);
  if (const auto ground = top.find("ground")) read_ground(*ground);
  each("bodies", &SceneReader::read_body);
  each("cables", &SceneReader::read_cable);
  each("joints", &SceneReader::read_joint);
  each("pairs", &SceneReader::read_pair);
  each("forces", &SceneReader::read_force);
  each("probes", &SceneReader::read_probe);
  each("events", &SceneReader::read_event);
  top.reject_unknown_keys();
  if (!scene_.assemble && knows_start_) check_gaps();
  note_far_anchors();
  note_untouchable();
  return std::move(scene_);
}

/// What stands beside the lists; the defaults are those of the first generate block.
void SceneReader::read_top_level(JsonObject& top) {
  const bool is_one_block = scene_.world.body_count() > 1 && !top.find("bodies") && !top.find("forces");
  if (!is_one_block) scene_.energy_scale = 0;
  scene_.name = top.get("name", &JsonNode::string, scene_.name);
  if (const auto gravity = top.find("gravity")) scene_.world.set_gravity(gravity->vector());
  const std::size_t before_start = problems_.size();
  scene_.world.set_time(top.get("time", &JsonNode::number, scene_.world.time()));
  scene_.assemble = top.get("assemble", &JsonNode::boolean, scene_.assemble);
  knows_start_ = problems_.size() == before_start;
  scene_.dt = top.get("dt", &JsonNode::positive, scene_.dt);
  scene_.duration = top.get("duration", &JsonNode::positive, scene_.duration);
  scene_.energy_scale = top.get("energy_scale", &JsonNode::not_negative, scene_.energy_scale);
  const auto settings = top.find("settings");
  if (!settings) return;
  scene_.settings = read_settings(*settings, scene_.settings);
  for (const auto& [key, value] : settings->json().items())
    if (settings->json().is_object()) scene_.given_settings.insert(key);
  check_settings(*settings);
}

/// Settings that exclude each other.  One with a problem has its default, which excludes nothing.
void SceneReader::check_settings(const JsonNode& node) {
  for (SettingConflict& conflict : setting_conflicts(scene_.settings)) {
    if (!scene_.given_settings.contains(conflict.first.setting)) std::swap(conflict.first, conflict.second);
    const auto& [first, second, reason] = conflict;
    if (!scene_.given_settings.contains(first.setting)) continue;  // both are the block's
    const std::string at = scene_.given_settings.contains(second.setting)
                               ? child_path(node.path(), second.setting)
                               : "the first block";
    JsonNode(node.json()[first.setting], child_path(node.path(), first.setting), problems_)
        .problem("excludes " + quoted_list({second.setting}) + ": " + quoted_list({second.value}) + " of " +
                 at + ", since " + reason);
  }
}

void SceneReader::read_generate(const JsonNode& node) {
  const std::size_t before = problems_.size();
  JsonObject block(node);
  const auto builder_name = block.required("builder");
  const SceneInfo* builder = builder_name ? find_builder(*builder_name) : nullptr;
  const auto parameters = block.find("parameters");
  std::map<std::string, double> values;
  if (parameters && builder) values = read_parameters(*parameters, *builder);
  const std::size_t before_prefix = problems_.size();
  UnreadBlock unread{block.get("prefix", &JsonNode::string, std::string()), {}};
  const std::string& prefix = unread.prefix;
  const std::size_t before_placement = problems_.size();
  Pose placement;
  placement.p = block.get("position", &JsonNode::vector, placement.p);
  if (const auto orientation = block.find("orientation")) placement.q = read_orientation(*orientation);
  const bool placed = problems_.size() == before_placement;
  const std::size_t before_keys = problems_.size();
  block.reject_unknown_keys();
  // An unknown key may be any of the others, misspelt.
  const bool knows_keys = problems_.size() == before_keys;
  const auto leave_out = [&, names_known = builder && before_placement == before_prefix && knows_keys] {
    if (names_known) unread.looks = looks_of(*builder);
    unread_blocks_.push_back(std::move(unread));
  };
  if (before_placement != before || !knows_keys) return leave_out();
  if (!placed) placement = prefix.empty() ? Pose{} : Pose{Quat::Identity(), Vec3::UnitX()};  // a stand-in

  bool added = false;
  const int first_body = scene_.world.body_count();
  node.guard([&] {
    Scene built = build_scene(builder->name, values);
    if (const std::string taken = taken_name(scene_, built, prefix, placement); !taken.empty())
      return node.problem(taken + " is there already; give each block a \"prefix\" of its own");
    add_block(std::move(built), node, prefix, placement);
    added = true;
  });
  for (int b = first_body; b < scene_.world.body_count() && !placed; ++b) unplaced_bodies_.insert(b);
  if (!added) leave_out();
}

void SceneReader::add_block(Scene built, const JsonNode& node, const std::string& prefix,
                            const Pose& placement) {
  built.name = scene_.name;
  const bool is_first = node.path() == "/generate/0";
  const bool as_it_is = prefix.empty() && placement.p.isZero(0) && placement.q.vec().isZero(0);
  if (is_first && as_it_is) {
    scene_ = std::move(built);
  } else {
    if (is_first) {
      scene_.world.set_gravity(built.world.gravity());
      scene_.settings = built.settings;
      scene_.dt = built.dt;
      scene_.duration = built.duration;
    }
    append_scene(scene_, built, prefix, placement);
  }
  joint_paths_.resize(scene_.world.joint_count(), node.path());
  for (const Probe& probe : scene_.probes) probe_names_.insert(probe.name);
}

void SceneReader::read_probe(const JsonNode& node) {
  const std::size_t before = problems_.size();
  JsonObject object(node);
  Probe probe;
  const auto name = object.required("name");
  if (name) probe.name = name->string();
  const auto quantity = object.required("quantity");
  if (!quantity) return;
  const std::size_t before_quantity = problems_.size();
  const NamedQuantity info = quantity->choice(kQuantities);
  BodyReference body;
  if (problems_.size() != before_quantity) return;
  probe.quantity = info.quantity;
  if (info.subject == Subject::kBody || info.subject == Subject::kBodyPoint)
    body = required_body(object, "body");
  probe.body = body.id;
  if (info.subject == Subject::kBodyPoint)
    probe.point_B = object.get("point", &JsonNode::vector, body.centre) - body.centre;
  if (info.subject == Subject::kJoint)
    if (const auto joint = object.required("joint")) probe.joint = find_joint(*joint);
  if (info.subject == Subject::kAxis) probe.axis = required_axis(object, "axis").value_or(AxisId{});
  object.reject_unknown_keys();
  if (!probe.name.empty() && !probe_names_.insert(probe.name).second)
    name->problem("name is already taken by another probe");
  if (problems_.size() == before)
    scene_.probes.push_back(std::move(probe));
  else
    misses_probe_ = true;
}

const Probe* SceneReader::find_probe(const JsonNode& node) const {
  const std::string name = node.string();
  std::vector<std::string> names;
  for (const Probe& probe : scene_.probes) {
    if (probe.name == name) return &probe;
    names.push_back(probe.name);
  }
  knows_all_ = false;
  if (!name.empty() && !misses_probe_ && !may_be_generated(name))
    node.problem("there is no probe of this name" + did_you_mean(name, names));
  return nullptr;
}

JointId SceneReader::required_joint(JsonObject& object, const char* key) const {
  const auto node = object.required(key);
  return node ? find_joint(*node) : JointId{};
}

BodyReference SceneReader::required_body(JsonObject& object, const char* key) const {
  const auto node = object.required(key);
  return node ? find_body(*node) : BodyReference{};
}

BodyReference SceneReader::find_body(const JsonNode& node) const {
  const std::string name = node.string();
  if (name.empty()) return {};
  if (scene_.world.has_body(name)) {
    const BodyId id = scene_.world.body(name);
    const auto centre = centre_of_body_.find(id.index);
    const bool placed = !unplaced_bodies_.contains(id.index);
    knows_all_ = knows_all_ && placed;
    return {id, true, placed, !unshaped_bodies_.contains(id.index),
            centre == centre_of_body_.end() ? Vec3(Vec3::Zero()) : centre->second};
  }
  knows_all_ = false;
  if (may_be_generated(name) || may_be_counted(name, "body_", misses_body_)) return {};
  const std::string ground = called_here(name, {scene_.world.name(kGround)});
  node.problem("there is no body of this name" +
               (ground.empty() ? did_you_mean(name, names_of<BodyId>(scene_.world, scene_.world.body_count()))
                               : ground));
  return {};
}

/// Whether a block with problems may have made what has this name.
bool SceneReader::may_be_generated(const std::string& name) const {
  return std::any_of(unread_blocks_.begin(), unread_blocks_.end(), [&](const UnreadBlock& block) {
    return name.starts_with(block.prefix) &&
           (!block.looks || block.looks->contains(look_of(name.substr(block.prefix.size()))));
  });
}

/// Whether it may be the name that something without one gets from its index, where others are missing.
bool SceneReader::may_be_counted(const std::string& name, const char* stem, bool misses_some) const {
  return (misses_some || !unread_blocks_.empty()) && name.starts_with(stem);
}

JointId SceneReader::find_joint(const JsonNode& node) const {
  const std::string name = node.string();
  if (scene_.world.has_joint(name)) return scene_.world.joint(name);
  knows_all_ = false;
  if (!name.empty() && !path_of_joint_.contains(name) && !may_be_generated(name) &&
      !may_be_counted(name, "joint_", misses_joint_))
    node.problem("there is no joint of this name" +
                 did_you_mean(name, names_of<JointId>(scene_.world, scene_.world.joint_count())));
  return {};
}

/// Joints must be closed at the start, unless the simulator is to assemble them.
void SceneReader::check_gaps() {
  const Rows rows(scene_.world);
  std::vector<double> phi(rows.row_count());
  rows.residual(scene_.world.state(), phi);
  const std::vector<Gap> gaps = joint_gaps(rows, phi);
  for (int j = 0; j < scene_.world.joint_count(); ++j) {
    if (joint_paths_[j].empty()) continue;
    std::ostringstream gap;
    if (!(gaps[j].metres <= kGapTolerance)) gap << gaps[j].metres << " m";
    if (!(gaps[j].radians <= kGapTolerance))
      gap << (gap.tellp() > 0 ? ", " : "") << gaps[j].radians << " rad";
    if (gap.tellp() == 0) continue;
    std::ostringstream message;
    message << scene_.world.joint(JointId{j}).type() << " \"" << scene_.world.name(JointId{j})
            << "\" must be closed at the start to " << kGapTolerance
            << " m or rad, but has a gap; \"assemble\": true lets the simulator close it";
    problems_.push_back({joint_paths_[j], message.str(), gap.str()});
  }
}

}  // namespace taut
