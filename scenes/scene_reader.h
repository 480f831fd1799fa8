#pragma once

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
  Pose pose_of(const BodyReference& body) const { return body.found ? scene_.world.pose(body.id) : Pose{}; }

 private:
  void read_top_level(JsonObject& top);
  void read_generate(const JsonNode& node);
  void read_body(const JsonNode& node);
  void read_joint(const JsonNode& node);
  void read_force(const JsonNode& node);
  void read_probe(const JsonNode& node);
  void check_gaps();

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

/// The "settings" object.
Settings read_settings(const JsonNode& node, const Settings& defaults);
/// A rotation: [w, x, y, z], {"axis", "angle_deg" | "angle_rad"} or {"rpy_deg" | "rpy_rad"}.
Quat read_orientation(const JsonNode& node);

}  // namespace taut
