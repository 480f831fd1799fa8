#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "scenes/builders/scene.h"
#include "scenes/files/json_reader.h"

namespace taut {

/// A body or joint name of the file looked up in the world.
struct BodyReference {
  BodyId id{};
  bool found = false;
  bool placed = false;  ///< its pose is known; false if it is not there
  bool shaped = false;  ///< its shapes are known; false if it is not there
  /// Its centre of mass in the frame that the file gives the body, which points of the file are in.
  Vec3 centre = Vec3::Zero();
};

/// A collision shape of the file, at a pose in its body's frame of the file.
struct FileShape {
  JsonNode node;
  PlacedShape placed;
  std::optional<JsonNode> density;
  Material material;
  MaterialId named;
  CollisionFilter filter;
};

/// A body that is given by its ends: its one shape, and its frame with x from one to the other.
struct BodyByEnds {
  FileShape shape;
  Pose pose;
  bool placed = false;  ///< its ends are known
  bool sound = false;   ///< no key has a problem
};

/// What the keys of a body say about its mass.
struct FileMass {
  MassProperties properties{1, Vec3(1, 1, 1)};
  Vec3 centre = Vec3::Zero();        ///< of mass, in the frame of the file
  std::optional<PlacedShape> drawn;  ///< the solid that gives the mass, if it does not collide
};
/// mass or density, with inertia, shape or the collision shapes.  A fixed body needs none of them.
FileMass read_mass(JsonObject& body, bool fixed, const std::vector<FileShape>& shapes);
/// The same of a body whose only source of mass are these shapes.
FileMass mass_of_shapes(JsonObject& body, const std::vector<FileShape>& shapes);

class PairKeys;
class SceneReader;

/// A joint by its keys; null if what it refers to has problems.  @{
using JointFromKeys = std::shared_ptr<const Joint> (*)(const SceneReader& reader, JsonObject& joint);
using JointFromPair = std::shared_ptr<const Joint> (*)(PairKeys& keys);  /// @}

/// Builds a Scene from a document.  A body or joint with problems is still entered under its name, with what
/// is known of it, so that what refers to it is checked as well.
class SceneReader {
 public:
  /// Mesh files are looked for in the folder.
  SceneReader(Problems& problems, std::filesystem::path folder)
      : problems_(problems), folder_(std::move(folder)) {}
  /// The scene; only good if no problem has been added.
  Scene read(const nlohmann::json& document, const std::string& default_name);

  /// The body that the key names; a problem if the key or the body is missing.
  BodyReference required_body(JsonObject& object, const char* key) const;
  BodyReference find_body(const JsonNode& name) const;  ///< or of a name by itself
  /// The joint of the key; -1 if it is missing (a problem) or has problems of its own.
  JointId required_joint(JsonObject& object, const char* key) const;
  /// A probe of the file by name; a problem if there is none, and null.
  const Probe* find_probe(const JsonNode& name) const;
  /// The free axis {"joint", "axis"} of the key; a problem if key, joint or axis is missing, and nothing.
  std::optional<AxisId> required_axis(JsonObject& object, const char* key) const;
  const World& world() const { return scene_.world; }
  const std::vector<Probe>& probes() const { return scene_.probes; }
  Pose pose_of(const BodyReference& body) const { return body.found ? scene_.world.pose(body.id) : Pose{}; }

 private:
  void read_top_level(JsonObject& top);
  void check_settings(const JsonNode& node);
  void read_generate(const JsonNode& node);
  void add_block(Scene built, const JsonNode& node, const std::string& prefix, const Pose& placement);
  void read_materials(const JsonNode& node);
  void read_ground(const JsonNode& node);
  void read_body(const JsonNode& node);
  void enter_body(const JsonNode& node, BodySpec spec, const FileMass& mass,
                  const std::vector<FileShape>& shapes, bool placed, bool sound);
  void refuse_name(const JsonNode& name);
  /// "rod", "capsule" or "beam", if the body has one of them.
  std::optional<BodyByEnds> read_body_by_ends(JsonObject& body) const;
  void read_cable(const JsonNode& node);
  /// A cable that hangs: its links are between these nodes, and each end is on a body or free.
  struct Cable {
    std::string name;
    std::vector<Vec3> nodes;
    double link = 0, radius = 0, link_mass = 0;  // length, radius and mass of a link
    FileShape surface;
    BodyReference ends[2];
  };
  void check_link_names(JsonObject& cable, const std::string& name, int links, std::size_t before);
  void add_links(const JsonNode& node, const Cable& cable);
  /// "shapes": those without problems.
  std::vector<FileShape> read_shapes(const JsonNode& list) const;
  std::optional<FileShape> read_shape_of_body(const JsonNode& node) const;
  /// "material", "groups" and "collides_with".
  void read_surface(JsonObject& keys, FileShape& shape) const;
  void add_shapes(BodyId body, const std::vector<FileShape>& shapes, const Vec3& centre);
  /// The name of a material, or one in place.
  Material material_of(const JsonNode& node) const;
  /// The material of the name; a problem if there is none or it is no name, and none.
  MaterialId named_material(const JsonNode& node) const;
  void read_material_pair(const JsonNode& node);
  void read_pair(const JsonNode& node);
  /// All shapes of a body, or the one that the key counts.
  std::vector<ShapeId> shapes_of_pair(JsonObject& pair, const char* body_key, const char* shape_key) const;
  void read_joint(const JsonNode& node);
  std::string free_joint_name(JsonObject& joint);
  /// A joint that the keys describe, null if they do not, and what is known of its bodies.
  struct JointOfFile {
    std::shared_ptr<const Joint> made;
    bool bodies_found = true, bodies_placed = true;
  };
  JointOfFile read_joint_of_pair(JsonObject& joint, std::size_t before, JointFromPair make);
  JointOfFile read_joint_of_axes(JsonObject& joint, std::size_t before, JointFromKeys make);
  void read_force(const JsonNode& node);
  void read_probe(const JsonNode& node);
  void read_event(const JsonNode& node);
  void check_gaps();
  void note_many_turns(JsonObject& axis) const;
  void note_far_anchors() const;
  void note_untouchable() const;
  /// "axes" of a joint: axis properties (core/axes) by axis; applied to the joint if it is there.
  void read_axes(const JsonNode& node, JointId joint);
  /// "compliance", "break" and "attached"; applied to the joint if it is there.
  void read_joint_properties(JsonObject& joint, JointId id);

  /// -1 if there is none of that name (a problem) or it has problems of its own.
  JointId find_joint(const JsonNode& name) const;
  bool may_be_generated(const std::string& name) const;
  bool may_be_counted(const std::string& name, const char* stem, bool misses_some) const;
  /// Runs what reads an item.  What it throws as bad input is a problem of the item, unless there are others
  /// beyond the first `before` or it refers to what is not known (knows_all_, which is true at its start).
  template <typename Function>
  void guard_item(const JsonNode& node, std::size_t before, Function function) const {
    node.guard_if([&] { return knows_all_ && problems_.size() == before; }, std::move(function));
  }

  Problems& problems_;
  std::filesystem::path folder_;
  Scene scene_;
  std::set<std::pair<MaterialId, MaterialId>> material_pairs_;
  std::unordered_map<int, Vec3> centre_of_body_;                               // where it is not 0
  std::unordered_map<std::string, std::string> path_of_body_, path_of_joint_;  // names of the file
  std::set<int> unplaced_bodies_, unshaped_bodies_;  // whose pose or shapes are not known
  std::set<std::string> probe_names_, event_names_;
  /// A generate block with problems: what the names look like that it may have made, if its builder is known.
  struct UnreadBlock {
    std::string prefix;
    std::optional<std::set<std::string>> looks;
  };
  std::vector<UnreadBlock> unread_blocks_;
  bool misses_body_ = false, misses_joint_ = false;  // of the file; so names by index are not known
  bool misses_probe_ = false;
  bool knows_start_ = true;               // "time" and "assemble"
  mutable bool knows_all_ = true;         // that the item refers to which is being read
  std::vector<std::string> joint_paths_;  // by joint id; empty: its gap is not checked
  /// The point of a joint that two bodies turn about, from the centre of mass of each, in its axes.
  struct FileAnchor {
    JsonNode node;
    BodyId a, b;
    Vec3 p_AP, p_BQ;
  };
  std::vector<FileAnchor> anchors_;
  std::vector<JsonNode> untouchable_;  // bodies that move, and have a shape for their mass alone
};

/// Joints over points of several bodies.
std::shared_ptr<const Joint> read_pulley(const SceneReader& reader, JsonObject& joint);
std::shared_ptr<const Joint> read_rope_over_points(const SceneReader& reader, JsonObject& joint);

/// Joints that tie axes of other joints together, by type; nothing if an axis has problems.
std::shared_ptr<const Joint> read_gear(const SceneReader& reader, JsonObject& joint);
std::shared_ptr<const Joint> read_rack_and_pinion(const SceneReader& reader, JsonObject& joint);
std::shared_ptr<const Joint> read_differential(const SceneReader& reader, JsonObject& joint);
std::shared_ptr<const Joint> read_driver(const SceneReader& reader, JsonObject& joint);

class PairKeys;
/// Joints of two bodies with a course in space or time.
std::shared_ptr<const Joint> read_point_on_curve(PairKeys& keys);
std::shared_ptr<const Joint> read_pose_driver(PairKeys& keys);

/// {"linear": ...}, {"harmonic": ...}, {"table": ...} and so on: one of the functions of time of
/// core/state/motion.h; of an angle, also in degrees.
Motion read_motion(const JsonNode& node, bool angular);
/// [[x, y], ...], x increasing; without regard to the unit of the node.
std::vector<Curve::Point> read_curve_points(const JsonNode& node);
/// A curve if the object has one by that key, whose unit is that of x.
std::optional<Curve> read_curve(JsonObject& object, JsonKey key);

/// The "settings" object.
Settings read_settings(const JsonNode& node, const Settings& defaults);
/// A rotation: [w, x, y, z], {"axis", "angle_deg" | "angle_rad"} or {"rpy_deg" | "rpy_rad"}.
Quat read_orientation(const JsonNode& node);

}  // namespace taut
