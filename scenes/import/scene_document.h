#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "scenes/import/joint_segments.h"
#include "scenes/import/robot_model.h"

namespace taut::model {

using SceneJson = nlohmann::ordered_json;

/// Writes a model as a document taut-scene/1.  Body axes are those of the link, their origin is the centre of
/// mass.
class SceneDocument {
 public:
  /// Notices are added to the model's.  The model has no links without mass that move.
  explicit SceneDocument(RobotModel& model) : model_(model) {}
  SceneJson write();

 private:
  using TakenNames = std::map<std::string, int>;  // with the last number behind each
  /// One that nothing of this kind has yet: `name`, or `fallback`, with a number if need be.
  static std::string unique(TakenNames& taken, const std::string& name, const std::string& fallback);
  void name_bodies();
  void note_points_on_levers(const Link& link, const std::string& name);
  void note(const ModelPlace& place, const std::string& message) {
    model_.notices.push_back({place, message, 1});
  }
  const std::string& body(int link) const { return link == kWorld ? ground_ : bodies_[link]; }
  Pose pose(int link) const { return link == kWorld ? Pose{} : model_.links[link].X_WL; }
  Twist motion(int link) const { return link == kWorld ? Twist{} : motions_[link]; }
  Pose world(const LinkFrame& frame) const { return pose(frame.link) * frame.X_LF; }

  // scene_document.cpp
  SceneJson body_json(const std::string& name, const Link& link, const LinkInertia& inertia,
                      const Twist& motion) const;
  void gather_motions();
  SceneJson shapes_json(const std::vector<LinkShape>& shapes, const Vec3& centre) const;
  void write_bodies(SceneJson& document);
  std::vector<LinkInertia> shares_between(std::size_t link) const;
  void gather_surfaces();
  void gather_classes();
  void write_materials(SceneJson& document) const;
  std::uint32_t partners(int contact_class) const;

  // pair_document.cpp
  void write_pairs(SceneJson& document);
  void forbid_neighbours(std::map<std::pair<int, int>, bool>& rules) const;
  void allow_joined(std::map<std::pair<int, int>, bool>& rules);
  bool has_shapes(int link) const;
  bool joined_directly(int a, int b) const;
  bool may_meet(int a, int b) const;

  // joint_document.cpp
  void write_joints(SceneJson& document);
  void write_fixed(SceneJson& joints, int link);
  std::string write_segment(SceneJson& joints, const Link& link, const JointSegment& segment,
                            const std::string& a, const std::string& b);
  SceneJson axes_json(const Link& link, const JointSegment& segment);
  SceneJson axis_json(const LinkAxis& axis) const;
  static SceneJson motor_json(const LinkAxis& axis);
  void ball_axes(SceneJson& axes, const LinkAxis& axis);
  void write_loop(SceneJson& joints, const Loop& loop);
  double write_turn_of_loop(SceneJson& json, const Loop& loop, const Pose& A, const Pose& B) const;
  void write_closing_joint(SceneJson& joints, const Loop& loop);
  void write_relation(SceneJson& joints, const AxisRelation& relation);
  void write_armatures(SceneJson& bodies, SceneJson& joints);
  void write_armature(SceneJson& bodies, SceneJson& joints, const AxisName& name);
  SceneJson axis_reference(const AxisName& axis) const;
  void write_wire(SceneJson& document, const Wire& wire);
  SceneJson wire_ends(const Wire& wire) const;
  void write_rope(SceneJson& document, const Wire& wire);
  void write_bar(SceneJson& document, const Wire& wire);
  void write_pulley(SceneJson& document, const Wire& wire);
  void write_wire_spring(SceneJson& document, const Wire& wire);
  void write_probes(SceneJson& document);
  SceneJson probe_json(const ModelProbe& probe, bool& known);

  RobotModel& model_;
  std::string ground_ = "ground";
  std::vector<std::string> bodies_;                  // by link
  std::vector<std::vector<std::string>> between_;    // by link: bodies between its joints
  std::vector<std::vector<JointSegment>> segments_;  // by link
  std::vector<std::vector<std::string>> joints_;     // by link: names of the joints of its segments
  std::vector<Twist> motions_;  // by link: at the start, of its point at the origin of the world
  TakenNames body_names_{{"ground", 1}}, joint_names_, probe_names_;
  std::map<Surface, std::string> surfaces_;
  std::map<TouchKind, int> classes_;
  bool open_ = false;  // a joint is open at the start
};

SceneJson vector_json(const Vec3& v);
SceneJson quaternion_json(const Quat& q);

}  // namespace taut::model
