#include "scenes/files/state_file.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/state/same_state.h"
#include "scenes/files/json_positions.h"
#include "scenes/files/scene_file.h"
#include "scenes/files/scene_reader.h"
#include "scenes/files/state_json.h"
#include "scenes/support/base64.h"
#include "scenes/support/output_file.h"

namespace taut {
namespace {

constexpr const char* kStateFormat = "taut-state/1";

std::vector<double> components(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

std::vector<std::vector<ShapeId>> shapes_of_bodies(const World& world) {
  std::vector<std::vector<ShapeId>> shapes(world.body_count());
  for (int i = 0; i < world.shape_count(); ++i) shapes[world.shape(ShapeId{i}).body.index].push_back({i});
  return shapes;
}

/// Reads a state into a copy of the world's own.
class StateReader {
 public:
  StateReader(World& world, Problems& problems) : world_(world), problems_(problems), state_(world.state()) {}

  SavedMemory read(const nlohmann::json& document) {
    const JsonNode root(document, "/", problems_);
    JsonObject keys(root);
    const auto format = keys.required("format");
    if (format && format->json() != kStateFormat)
      format->problem(std::string("must be \"") + kStateFormat + '"');
    state_.time = keys.get_required("time", &JsonNode::number, 0.0);
    each_of(keys.required("bodies"), "an array of bodies", [&](const JsonNode& body) { read_body(body); });
    each_of(keys.find("axes"), "an array of axes", [&](const JsonNode& axis) { read_axis(axis); });
    each_of(keys.find("detached"), "an array of names", [&](const JsonNode& joint) {
      if (const auto id = joint_named(joint)) detached_.push_back(*id);
    });
    each_of(keys.find("contacts"), "an array of contacts",
            [&](const JsonNode& contact) { read_contact(contact); });
    if (const auto memory = keys.find("memory")) read_memory(*memory);
    keys.reject_unknown_keys();
    // Programs write states: what is only strange in a scene is wrong here.
    problems_.insert(problems_.end(), problems_.warnings.begin(), problems_.warnings.end());
    if (problems_.empty()) root.guard([&] { world_.set_state(state_); });
    if (!problems_.empty()) return {};
    for (const JointId joint : detached_) world_.detach(joint);
    return std::move(memory_);
  }

 private:
  template <typename Read>
  static void each_of(const std::optional<JsonNode>& list, const char* what, Read read) {
    if (!list) return;
    for (const JsonNode& item : list->items(what)) read(item);
  }

  void read_body(const JsonNode& node) {
    JsonObject keys(node);
    const auto name = keys.required("name");
    Pose pose;
    Twist twist;
    pose.p = keys.get_required("position", &JsonNode::vector, Vec3(Vec3::Zero()));
    if (const auto orientation = keys.required("orientation")) pose.q = read_orientation(*orientation);
    twist.v = keys.get_required("velocity", &JsonNode::vector, Vec3(Vec3::Zero()));
    twist.w = keys.get_required("angular_velocity", &JsonNode::vector, Vec3(Vec3::Zero()));
    keys.reject_unknown_keys();
    if (!name) return;
    const std::string text = name->string();
    if (!world_.has_body(text)) return name->problem("there is no body of that name in the scene");
    const BodyId body = world_.body(text);
    if (world_.is_fixed(body)) return name->problem("is fixed in the scene");
    if (!bodies_.insert(body.index).second) return name->problem("is given twice");
    state_.poses[body.index] = pose;
    state_.twists[body.index] = twist;
  }

  void read_axis(const JsonNode& node) {
    JsonObject keys(node);
    const auto joint = keys.required("joint"), axis = keys.required("axis");
    const double value = keys.get_required("value", &JsonNode::number, 0.0);
    keys.reject_unknown_keys();
    if (!joint || !axis) return;
    const auto id = joint_named(*joint);
    const std::string name = axis->string();
    if (!id) return;
    axis->guard([&] {
      const int index = world_.axis_index(world_.axis(*id, name));
      if (!axes_.insert(index).second) return axis->problem("is given twice");
      state_.axes[index] = value;
    });
  }

  void read_memory(const JsonNode& node) {
    const auto bytes = from_base64(node.string());
    if (!bytes) return node.problem("must be base64");
    node.guard([&] { memory_.checkpoint = Checkpoint::from_bytes(*bytes); });
  }

  void read_contact(const JsonNode& node) {
    JsonObject keys(node);
    const auto a = keys.required("a"), b = keys.required("b");
    ContactStretch contact;
    contact.p_AP = keys.get_required("point", &JsonNode::vector, Vec3(Vec3::Zero()));
    contact.stretch = keys.get_required("stretch", &JsonNode::vector, Vec3(Vec3::Zero()));
    contact.holds = keys.get("holds", &JsonNode::boolean, true);
    keys.reject_unknown_keys();
    const auto shape_a = a ? shape_at(*a) : std::nullopt, shape_b = b ? shape_at(*b) : std::nullopt;
    if (!shape_a || !shape_b) return;
    contact.a = *shape_a;
    contact.b = *shape_b;
    memory_.stretches.push_back(contact);
  }

  /// {"body": NAME, "shape": its place among the shapes of the body}.
  std::optional<ShapeId> shape_at(const JsonNode& node) {
    JsonObject keys(node);
    const auto name = keys.required("body"), index = keys.required("shape");
    keys.reject_unknown_keys();
    if (!name || !index) return std::nullopt;
    const std::string text = name->string();
    const double at = index->number();
    if (!world_.has_body(text)) {
      name->problem("there is no body of that name in the scene");
      return std::nullopt;
    }
    const std::vector<ShapeId>& shapes = shapes_[world_.body(text).index];
    if (at >= 0 && at < static_cast<double>(shapes.size()) && at == std::floor(at))
      return shapes[static_cast<std::size_t>(at)];
    index->problem("must be the place of a shape among the " + std::to_string(shapes.size()) +
                   " of the body");
    return std::nullopt;
  }

  std::optional<JointId> joint_named(const JsonNode& node) {
    const std::string name = node.string();
    if (world_.has_joint(name)) return world_.joint(name);
    node.problem("there is no joint of that name in the scene");
    return std::nullopt;
  }

  World& world_;
  Problems& problems_;
  State state_;
  std::set<int> bodies_, axes_;
  std::vector<JointId> detached_;
  std::vector<std::vector<ShapeId>> shapes_ = shapes_of_bodies(world_);
  SavedMemory memory_;
};

}  // namespace

nlohmann::ordered_json state_json(const World& world, const SavedMemory& memory) {
  auto bodies = nlohmann::ordered_json::array(), axes = bodies, detached = bodies, contacts = bodies;
  for (int i = 0; i < world.body_count(); ++i) {
    const BodyId body{i};
    if (world.is_fixed(body)) continue;
    const Pose& pose = world.pose(body);
    const Twist& twist = world.twist(body);
    bodies.push_back({{"name", world.name(body)},
                      {"position", components(pose.p)},
                      {"orientation", {pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()}},
                      {"velocity", components(twist.v)},
                      {"angular_velocity", components(twist.w)}});
  }
  for (int i = 0; i < world.joint_count(); ++i) {
    const JointId joint{i};
    if (!world.is_attached(joint)) detached.push_back(world.name(joint));
    for (int a = 0; a < world.axis_count(joint); ++a) {
      const AxisId axis{joint, a};
      const double value = world.state().axes[world.axis_index(axis)];
      if (value == 0 && !world.has_axis_properties(joint)) continue;  // else couplings may count its turns
      axes.push_back({{"joint", world.name(joint)}, {"axis", world.axis_info(axis).name}, {"value", value}});
    }
  }
  const std::vector<std::vector<ShapeId>> shapes = shapes_of_bodies(world);
  const auto shape = [&](ShapeId id) -> nlohmann::ordered_json {
    const BodyId body = world.shape(id).body;
    const std::vector<ShapeId>& of_body = shapes[body.index];
    return {{"body", world.name(body)},
            {"shape", std::find(of_body.begin(), of_body.end(), id) - of_body.begin()}};
  };
  for (const ContactStretch& s : memory.stretches)
    contacts.push_back({{"a", shape(s.a)},
                        {"b", shape(s.b)},
                        {"point", components(s.p_AP)},
                        {"stretch", components(s.stretch)},
                        {"holds", s.holds}});
  nlohmann::ordered_json state = {{"format", kStateFormat}, {"time", world.time()}, {"bodies", bodies},
                                  {"axes", axes},           {"detached", detached}, {"contacts", contacts}};
  if (!memory.checkpoint.empty()) state["memory"] = base64(memory.checkpoint.bytes());
  return state;
}

SavedMemory apply_state(World& world, std::string_view text, const std::string& file_name) {
  Problems problems;
  problems.by_hand = false;
  SavedMemory memory;
  if (const auto document = parse_json(text, problems)) memory = StateReader(world, problems).read(*document);
  locate(text, problems);
  if (!problems.empty()) throw SceneFileError(file_name, std::move(problems));
  return memory;
}

SavedMemory load_state_file(World& world, const std::filesystem::path& path) {
  return apply_state(world, read_text_file(path), path.string());
}

std::string save_state_file(Simulator& simulator, const std::filesystem::path& path) {
  const SavedMemory memory{simulator.contact_stretches(), simulator.checkpoint()};
  constexpr auto replace = nlohmann::ordered_json::error_handler_t::replace;
  return write_output(path.string(),
                      state_json(simulator.world(), memory).dump(1, ' ', false, replace) + '\n');
}

std::string go_on_from(Simulator& simulator, World& world, const SavedMemory& memory) {
  std::string reason;
  if (!memory.checkpoint.empty()) {
    const State stated = world.state();
    try {
      simulator.restore(memory.checkpoint);
      if (same(world.state(), stated)) return "";
      reason = "the state in the file is not that of its memory";
      world.set_state(stated);
    } catch (const std::invalid_argument& error) {
      reason = error.what();
    }
  }
  simulator.set_contact_stretches(memory.stretches);
  return reason;
}

}  // namespace taut
