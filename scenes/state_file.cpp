#include "scenes/state_file.h"

#include <fstream>
#include <set>

#include "scenes/scene_file.h"
#include "scenes/scene_reader.h"

namespace taut {
namespace {

constexpr const char* kFormat = "taut-state/1";

std::vector<double> components(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Reads a state into a copy of the world's own.
class StateReader {
 public:
  StateReader(World& world, Problems& problems) : world_(world), problems_(problems), state_(world.state()) {}

  void read(const nlohmann::json& document) {
    const JsonNode root(document, "/", problems_);
    JsonObject keys(root);
    const auto format = keys.required("format");
    if (format && format->json() != kFormat) format->problem(std::string("must be \"") + kFormat + '"');
    state_.time = keys.get_required("time", &JsonNode::number, 0.0);
    if (const auto bodies = keys.required("bodies"))
      for (const JsonNode& body : bodies->items("an array of bodies")) read_body(body);
    if (const auto axes = keys.find("axes"))
      for (const JsonNode& axis : axes->items("an array of axes")) read_axis(axis);
    if (const auto detached = keys.find("detached"))
      for (const JsonNode& joint : detached->items("an array of names"))
        if (const auto id = joint_named(joint)) detached_.push_back(*id);
    keys.reject_unknown_keys();
    if (!problems_.empty()) return;
    root.guard([&] { world_.set_state(state_); });
    for (const JointId joint : detached_) world_.detach(joint);
  }

 private:
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
};

}  // namespace

nlohmann::ordered_json state_json(const World& world) {
  auto bodies = nlohmann::ordered_json::array(), axes = bodies, detached = bodies;
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
    if (!world.has_axis_properties(joint)) continue;
    for (int a = 0; a < world.axis_count(joint); ++a) {
      const AxisId axis{joint, a};
      axes.push_back({{"joint", world.name(joint)},
                      {"axis", world.axis_info(axis).name},
                      {"value", world.state().axes[world.axis_index(axis)]}});
    }
  }
  return {{"format", kFormat},
          {"time", world.time()},
          {"bodies", bodies},
          {"axes", axes},
          {"detached", detached}};
}

void apply_state(World& world, std::string_view text, const std::string& file_name) {
  Problems problems;
  if (const auto document = parse_json(text, problems)) StateReader(world, problems).read(*document);
  if (!problems.empty()) throw SceneFileError(file_name, std::move(problems));
}

void load_state_file(World& world, const std::filesystem::path& path) {
  apply_state(world, read_text_file(path), path.string());
}

bool save_state_file(const World& world, const std::filesystem::path& path) {
  std::filesystem::path part = path;
  part += ".part";
  std::ofstream out(part);
  out << state_json(world).dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(part, path, error);
  if (!out || error) std::filesystem::remove(part, error);
  return out && !error;
}

}  // namespace taut
