#pragma once

#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "scenes/json_reader.h"
#include "scenes/scene.h"

namespace taut {

/// A body or joint name of the file looked up in the world.
struct BodyReference {
  BodyId id{};
  bool found = false;
  bool sound = false;  ///< false if it is not there or has problems of its own
};

/// Builds a Scene from a document.  A body or joint with problems is still entered under its name, so that
/// what refers to it is checked as well.
class SceneReader {
 public:
  explicit SceneReader(Problems& problems) : problems_(problems) {}
  /// The scene; only good if no problem has been added.
  Scene read(const nlohmann::json& document, const std::string& default_name);

  /// The body that the key names; a problem if the key or the body is missing.
  BodyReference required_body(JsonObject& object, const char* key) const;
  /// The free axis {"joint", "axis"} of the key; a problem if key, joint or axis is missing, and nothing.
  std::optional<AxisId> required_axis(JsonObject& object, const char* key) const;
  const World& world() const { return scene_.world; }
  Pose pose_of(const BodyReference& body) const { return body.found ? scene_.world.pose(body.id) : Pose{}; }

 private:
  void read_top_level(JsonObject& top);
  void read_generate(const JsonNode& node);
  void read_body(const JsonNode& node);
  void read_joint(const JsonNode& node);
  void read_force(const JsonNode& node);
  void read_probe(const JsonNode& node);
  void check_gaps();
  /// "axes" of a joint: limits, motor, friction and spring by axis; applied to the joint if it is there.
  void read_axes(const JsonNode& node, JointId joint);

  /// -1 if there is none of that name (a problem) or it has problems of its own.
  JointId find_joint(const JsonNode& name) const;

  Problems& problems_;
  Scene scene_;
  std::unordered_map<std::string, std::string> path_of_body_, path_of_joint_;  // names of the file
  std::set<int> unsound_bodies_;
  std::set<std::string> probe_names_;
  bool has_unread_block_ = false;         // a generate block with problems: its names are not known
  std::vector<std::string> joint_paths_;  // by joint id; empty: its gap is not checked
};

/// Joints that tie axes of other joints together, by type; nothing if an axis has problems.
std::shared_ptr<const Joint> read_gear(const SceneReader& reader, JsonObject& joint);
std::shared_ptr<const Joint> read_rack_and_pinion(const SceneReader& reader, JsonObject& joint);
std::shared_ptr<const Joint> read_differential(const SceneReader& reader, JsonObject& joint);
std::shared_ptr<const Joint> read_driver(const SceneReader& reader, JsonObject& joint);

/// [[x, y], ...], x increasing.
std::vector<Curve::Point> read_curve_points(const JsonNode& node);

/// The "settings" object.
Settings read_settings(const JsonNode& node, const Settings& defaults);
/// A rotation: [w, x, y, z], {"axis", "angle_deg" | "angle_rad"} or {"rpy_deg" | "rpy_rad"}.
Quat read_orientation(const JsonNode& node);

}  // namespace taut
