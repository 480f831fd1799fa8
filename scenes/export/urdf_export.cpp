#include "scenes/export/urdf_export.h"

#include <map>

#include "core/joints/axis_coupling.h"
#include "scenes/export/model_tree.h"

namespace taut {
namespace {

/// Angles about x, y and z of the fixed frame.
Vec3 rpy_of(const Quat& q) {
  const Mat3 R = q.normalized().toRotationMatrix();
  const double across = std::hypot(R(0, 0), R(1, 0));
  if (across > 1e-9)
    return {std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), across), std::atan2(R(1, 0), R(0, 0))};
  return {std::atan2(-R(1, 2), R(1, 1)), std::atan2(-R(2, 0), across), 0};
}

/// The sizes of a shape as <geometry>; false for those without counterpart.
struct GeometryOfShape {
  pugi::xml_node geometry;
  bool operator()(const Sphere& s) const { return set("sphere", {{"radius", words(s.radius)}}); }
  bool operator()(const Box& s) const { return set("box", {{"size", words(s.size)}}); }
  bool operator()(const Cylinder& s) const {
    return set("cylinder", {{"radius", words(s.radius)}, {"length", words(s.length)}});
  }
  bool operator()(const Capsule& s) const {
    return set("capsule", {{"radius", words(s.radius)}, {"length", words(s.length)}});
  }
  template <typename Other>
  bool operator()(const Other&) const {
    return false;
  }
  bool set(const char* name, const std::map<std::string, std::string>& sizes) const {
    pugi::xml_node node = pugi::xml_node(geometry).append_child(name);
    for (const auto& [key, value] : sizes) node.append_attribute(key.c_str()) = value.c_str();
    return true;
  }
};

class UrdfWriter {
 public:
  UrdfWriter(const Scene& scene, std::vector<std::string>& notices)
      : scene_(scene), world_(scene.world), notices_(notices), tree_(model_tree(scene.world)) {}

  std::string write() {
    root_ = document_.append_child("robot");
    root_.append_attribute("name") = scene_.name.c_str();
    frames_[0] = {};
    write_link(kGround, "world");
    for (const TreeBody& body : tree_.bodies) {
      // The frame of a link is at its joint, in the axes of the body.
      frames_[body.body.index] = {world_.pose(body.body).q,
                                  body.joint.index < 0 ? world_.pose(body.body).p : body.anchor};
      write_link(body.body, world_.name(body.body));
    }
    for (const TreeBody& body : tree_.bodies) write_joint(body);
    for (JointId id : tree_.others) write_other(id);
    for (int f = 0; f < world_.force_count(); ++f)
      notices_.push_back(force_label(world_, ForceId{f}) + ": has no counterpart");
    bool moves = false;
    for (int b = 1; b < world_.body_count(); ++b)
      moves = moves || !world_.twist(BodyId{b}).v.isZero(0) || !world_.twist(BodyId{b}).w.isZero(0);
    if (moves) notices_.emplace_back("velocities at the start have no counterpart");
    note_what_no_model_has(world_, notices_);
    notices_.emplace_back("gravity, friction of contacts, and who may touch whom have no counterpart");
    return xml_text(document_);
  }

 private:
  Pose seen_from(int frame, const Pose& X_W) const {
    const Pose& F = frames_.at(frame);
    return {(F.q.conjugate() * X_W.q).normalized(), F.local(X_W.p)};
  }
  static void place(pugi::xml_node node, const Pose& pose) {
    pugi::xml_node origin = node.append_child("origin");
    origin.append_attribute("xyz") = words(pose.p).c_str();
    origin.append_attribute("rpy") = words(rpy_of(pose.q)).c_str();
  }
  static void set(pugi::xml_node parent, const char* name, const char* key, const std::string& value) {
    parent.append_child(name).append_attribute(key) = value.c_str();
  }

  void write_link(BodyId body, const std::string& name) {
    pugi::xml_node link = root_.append_child("link");
    link.append_attribute("name") = name.c_str();
    if (!world_.is_fixed(body) && body != kGround) {
      pugi::xml_node inertial = link.append_child("inertial");
      place(inertial, seen_from(body.index, world_.pose(body)));
      const MassProperties& mass = world_.mass_properties(body);
      set(inertial, "mass", "value", words(mass.mass()));
      pugi::xml_node tensor = inertial.append_child("inertia");
      constexpr const char* kLetters = "xyz";
      for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
          tensor.append_attribute((std::string("i") + kLetters[i] + kLetters[j]).c_str()) =
              words(mass.inertia_B()(i, j)).c_str();
    }
    for (int s = 0; s < world_.shape_count(); ++s)
      if (world_.shape(ShapeId{s}).body == body) write_shape(link, world_.shape(ShapeId{s}));
  }

  void write_shape(pugi::xml_node link, const ShapeRecord& record) {
    for (const char* kind : {"collision", "visual"}) {
      pugi::xml_node node = link.append_child(kind);
      place(node, seen_from(record.body.index, world_.pose(record.body) * record.pose));
      if (std::visit(GeometryOfShape{node.append_child("geometry")}, *record.shape)) continue;
      link.remove_child(node);
      return notices_.push_back(world_.name(record.body) +
                                ": a shape has no counterpart (value: " + shape_name(*record.shape) + ")");
    }
  }

  void write_joint(const TreeBody& body) {
    pugi::xml_node node = root_.append_child("joint");
    const std::string name =
        body.joint.index < 0 ? world_.name(body.body) + "_joint" : world_.name(body.joint);
    const bool one = body.axes.size() == 1, chain = body.axes.size() > 1 || body.ball;
    if (body.ball)
      write_loop(body.joint, common_points(world_, body.joint));
    else if (chain)
      notices_.push_back(name + ": this joint has no counterpart, its link is free (value: " +
                         std::string(world_.joint(body.joint).type()) + ")");
    const AxisWords law = one ? axis_words(world_, body.axes[0].id, notices_) : AxisWords{};
    const bool limited = law.lower || law.upper;
    const char* type = chain || body.free      ? "floating"
                       : !one                  ? "fixed"
                       : !body.axes[0].angular ? "prismatic"
                       : limited               ? "revolute"
                                               : "continuous";
    node.append_attribute("name") = name.c_str();
    node.append_attribute("type") = type;
    place(node, seen_from(body.parent.index, frames_.at(body.body.index)));
    set(node, "parent", "link", body.parent == kGround ? "world" : world_.name(body.parent));
    set(node, "child", "link", world_.name(body.body));
    if (one) write_law(node, body, law);
  }

  void write_law(pugi::xml_node node, const TreeBody& body, const AxisWords& law) {
    const TreeAxis& axis = body.axes[0];
    names_[axis.id] = world_.name(body.joint);
    set(node, "axis", "xyz", words(Vec3(world_.pose(body.body).q.conjugate() * axis.direction)));
    if (world_.axis_properties(axis.id).motor)
      notices_.push_back(world_.axis_label(axis.id) + ": a motor has no counterpart");
    if (law.stiffness > 0) notices_.push_back(world_.axis_label(axis.id) + ": a spring has no counterpart");
    if (law.damping > 0 || law.friction > 0) {
      pugi::xml_node dynamics = node.append_child("dynamics");
      dynamics.append_attribute("damping") = words(law.damping).c_str();
      dynamics.append_attribute("friction") = words(law.friction).c_str();
    }
    if (axis.angular && !law.lower && !law.upper) return;
    constexpr double kFar = 1e10;
    pugi::xml_node limit = node.append_child("limit");
    limit.append_attribute("lower") = words(law.lower ? *law.lower - law.value : -kFar).c_str();
    limit.append_attribute("upper") = words(law.upper ? *law.upper - law.value : kFar).c_str();
    limit.append_attribute("effort") = words(kFar).c_str();
    limit.append_attribute("velocity") = words(kFar).c_str();
  }

  /// <loop_joint>: a frame of two links that stays together, its origin, or its axis z as well, or all of it:
  /// an extension that Drake reads as well.
  void write_loop(JointId id, const std::vector<Vec3>& points) {
    const Joint& joint = world_.joint(id);
    const bool hinge = joint.type() == "hinge", fixed = joint.type() == "fixed";
    Pose frame{Quat::Identity(), points[0]};  // in the world
    if (hinge) frame.q = rotation_between(Vec3::UnitZ(), (points[1] - points[0]).normalized());
    pugi::xml_node node = root_.append_child("loop_joint");
    node.append_attribute("name") = world_.name(id).c_str();
    node.append_attribute("type") = hinge ? "continuous" : fixed ? "fixed" : "ball";
    if (hinge) set(node, "axis", "xyz", "0 0 1");
    for (const auto& [key, body] : {std::pair("link1", joint.a()), std::pair("link2", joint.b())}) {
      const Pose at = seen_from(body.index, frame);
      pugi::xml_node end = node.append_child(key);
      end.append_attribute("link") = body == kGround ? "world" : world_.name(body).c_str();
      end.append_attribute("xyz") = words(at.p).c_str();
      end.append_attribute("rpy") = words(rpy_of(at.q)).c_str();
    }
    if (world_.has_axis_properties(id))
      notices_.push_back(world_.name(id) +
                         ": what acts along the axes of a joint that closes a loop has no counterpart");
  }

  void write_other(JointId id) {
    if (!world_.is_attached(id)) return;
    if (const std::vector<Vec3> points = common_points(world_, id); !points.empty())
      return write_loop(id, points);
    const auto* coupling = dynamic_cast<const AxisCoupling*>(&world_.joint(id));
    const bool gear = coupling && coupling->terms().size() == 2 &&
                      names_.contains(coupling->terms()[0].first) &&
                      names_.contains(coupling->terms()[1].first);
    if (!gear)
      return notices_.push_back(world_.name(id) + ": this joint has no counterpart (value: " +
                                std::string(world_.joint(id).type()) + ")");
    const auto& [driving, driven] = std::pair(coupling->terms()[0], coupling->terms()[1]);
    for (pugi::xml_node joint : root_.children("joint"))
      if (names_.at(driven.first) == joint.attribute("name").value()) {
        pugi::xml_node mimic = joint.append_child("mimic");
        mimic.append_attribute("joint") = names_.at(driving.first).c_str();
        mimic.append_attribute("multiplier") = words(-driving.second / driven.second).c_str();
      }
  }

  const Scene& scene_;
  const World& world_;
  std::vector<std::string>& notices_;
  ModelTree tree_;
  pugi::xml_document document_;
  pugi::xml_node root_;
  std::map<int, Pose> frames_;           // of links in the world, by body
  std::map<AxisId, std::string> names_;  // of joints with one axis
};

}  // namespace

std::string urdf_of(const Scene& scene, std::vector<std::string>& notices) {
  return UrdfWriter(scene, notices).write();
}

}  // namespace taut
