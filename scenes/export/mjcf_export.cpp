#include "scenes/export/mjcf_export.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/joints/axis_coupling.h"
#include "scenes/export/mjcf_actuators.h"
#include "scenes/export/mjcf_velocities.h"
#include "scenes/export/model_tree.h"

namespace taut {
namespace {

Pose seen_from(const Pose& X_WA, const Pose& X_WB) {
  return {(X_WA.q.conjugate() * X_WB.q).normalized(), X_WA.local(X_WB.p)};
}
std::string quat_words(const Quat& q) { return words(q.w()) + ' ' + words(Vec3(q.vec())); }

/// The sizes of a shape as a geom; nothing for those without counterpart.
struct GeomOfShape {
  pugi::xml_node geom;
  void set(const char* type, const std::string& size) const {
    pugi::xml_node node = geom;
    node.append_attribute("type") = type;
    if (!size.empty()) node.append_attribute("size") = size.c_str();
  }
  bool operator()(const Sphere& s) const { return set("sphere", words(s.radius)), true; }
  bool operator()(const Box& s) const { return set("box", words(Vec3(s.size / 2))), true; }
  bool operator()(const Capsule& s) const {
    return set("capsule", words(s.radius) + ' ' + words(s.length / 2)), true;
  }
  bool operator()(const Cylinder& s) const {
    return set("cylinder", words(s.radius) + ' ' + words(s.length / 2)), true;
  }
  bool operator()(const Ellipsoid& s) const { return set("ellipsoid", words(s.radii)), true; }
  bool operator()(const HalfSpace&) const { return set("plane", "0 0 1"), true; }
  bool operator()(const ConvexHull&) const { return set("mesh", ""), true; }
  bool operator()(const HeightField&) const { return set("hfield", ""), true; }
  template <typename Other>
  bool operator()(const Other&) const {
    return false;
  }
};

class MjcfWriter {
 public:
  MjcfWriter(const Scene& scene, std::vector<std::string>& notices)
      : scene_(scene),
        world_(scene.world),
        notices_(notices),
        tree_(model_tree(scene.world)),
        actuators_(scene, tree_, notices) {}

  std::string write() {
    root_ = document_.append_child("mujoco");
    root_.append_attribute("model") = scene_.name.c_str();
    root_.append_child("compiler").append_attribute("angle") = "radian";
    pugi::xml_node option = root_.append_child("option");
    option.append_attribute("timestep") = words(scene_.dt).c_str();
    option.append_attribute("gravity") = words(world_.gravity()).c_str();
    if (!scene_.settings.contacts) option.append_child("flag").append_attribute("contact") = "disable";
    asset_ = root_.append_child("asset");
    nodes_[0] = root_.append_child("worldbody");
    write_shapes(kGround);
    for (const TreeBody& body : tree_.bodies) write_body(body);
    write_excludes();
    equality_ = root_.append_child("equality");
    tendon_ = root_.append_child("tendon");
    for (JointId joint : tree_.others) write_other(joint);
    for (int f = 0; f < world_.force_count(); ++f) write_force(ForceId{f});
    write_key();
    for (pugi::xml_node node : {asset_, equality_, tendon_})
      if (!node.first_child()) root_.remove_child(node);
    note_what_no_model_has(world_, notices_);
    return xml_text(document_);
  }

 private:
  /// How it starts, beside what is said of each joint: controls and velocities.
  void write_key() {
    const std::string controls = actuators_.write(root_), rates = mjcf_velocities(world_, tree_, notices_);
    if (controls.empty() && rates.empty()) return;
    pugi::xml_node key = root_.append_child("keyframe").append_child("key");
    key.append_attribute("name") = "start";
    if (!rates.empty()) key.append_attribute("qvel") = rates.c_str();
    if (!controls.empty()) key.append_attribute("ctrl") = controls.c_str();
  }

  void write_body(const TreeBody& body) {
    pugi::xml_node node = nodes_[body.parent.index].append_child("body");
    nodes_[body.body.index] = node;
    node.append_attribute("name") = world_.name(body.body).c_str();
    place(node, seen_from(world_.pose(body.parent), world_.pose(body.body)));
    if (body.free) node.append_child("freejoint");
    write_joint(node, body);
    if (!world_.is_fixed(body.body)) write_inertia(node, world_.mass_properties(body.body));
    write_shapes(body.body);
  }

  static void place(pugi::xml_node node, const Pose& pose) {
    node.append_attribute("pos") = words(pose.p).c_str();
    if (!pose.q.vec().isZero(0)) node.append_attribute("quat") = quat_words(pose.q).c_str();
  }

  static void write_inertia(pugi::xml_node body, const MassProperties& mass) {
    pugi::xml_node node = body.append_child("inertial");
    const Mat3& I = mass.inertia_B();
    node.append_attribute("pos") = "0 0 0";
    node.append_attribute("mass") = words(mass.mass()).c_str();
    node.append_attribute("fullinertia") =
        (words(Vec3(I.diagonal())) + ' ' + words(Vec3(I(0, 1), I(0, 2), I(1, 2)))).c_str();
  }

  void write_joint(pugi::xml_node node, const TreeBody& body) {
    const Pose& X_WB = world_.pose(body.body);
    const auto add = [&](const std::string& name, const char* type) {
      pugi::xml_node joint = node.append_child("joint");
      joint.append_attribute("name") = name.c_str();
      joint.append_attribute("type") = type;
      joint.append_attribute("pos") = words(X_WB.local(body.anchor)).c_str();
      return joint;
    };
    if (body.ball) {
      add(world_.name(body.joint), "ball");
      if (world_.has_axis_properties(body.joint))
        notices_.push_back(world_.name(body.joint) +
                           ": what acts along the axes of a ball joint has no counterpart");
    }
    for (const TreeAxis& axis : body.axes) {
      const std::string name = body.axes.size() == 1 ? world_.name(body.joint) : world_.axis_label(axis.id);
      names_[axis.id] = name;
      pugi::xml_node joint = add(name, axis.angular ? "hinge" : "slide");
      joint.append_attribute("axis") = words(Vec3(X_WB.q.conjugate() * axis.direction)).c_str();
      write_law(joint, axis_words(world_, axis.id, notices_));
      actuators_.add(axis, body.body, name);
    }
  }

  static void write_law(pugi::xml_node joint, const AxisWords& law) {
    constexpr double kFar = 1e10;  // in place of one limit of two
    const auto set = [&](const char* key, double value) {
      if (value != 0) joint.append_attribute(key) = words(value).c_str();
    };
    set("ref", law.value);
    set("stiffness", law.stiffness);
    if (law.stiffness > 0) set("springref", law.rest);
    set("damping", law.damping);
    set("frictionloss", law.friction);
    if (!law.lower && !law.upper) return;
    joint.append_attribute("limited") = "true";
    joint.append_attribute("range") =
        (words(law.lower.value_or(-kFar)) + ' ' + words(law.upper.value_or(kFar))).c_str();
  }

  void write_shapes(BodyId body) {
    for (int s = 0; s < world_.shape_count(); ++s) {
      const ShapeRecord& record = world_.shape(ShapeId{s});
      if (record.body != body) continue;
      pugi::xml_node geom = nodes_[body.index].append_child("geom");
      if (!std::visit(GeomOfShape{geom}, *record.shape)) {
        nodes_[body.index].remove_child(geom);
        notices_.push_back(world_.name(body) +
                           ": a shape has no counterpart (value: " + shape_name(*record.shape) + ")");
        continue;
      }
      if (const auto* hull = std::get_if<ConvexHull>(record.shape.get()))
        geom.append_attribute("mesh") = mesh(*hull).c_str();
      Pose pose = record.pose;
      if (const auto* field = std::get_if<HeightField>(record.shape.get())) {
        geom.append_attribute("hfield") = this->field(*field).c_str();
        pose = pose * Pose{Quat::Identity(), Vec3(0, 0, std::ranges::min(field->heights))};
      }
      place(geom, pose);
      write_surface(geom, record);
    }
  }

  std::string mesh(const ConvexHull& hull) {
    std::string name = "hull_" + std::to_string(++meshes_), corners;
    for (const Vec3& point : hull.points) corners += (corners.empty() ? "" : "  ") + words(point);
    pugi::xml_node node = asset_.append_child("mesh");
    node.append_attribute("name") = name.c_str();
    node.append_attribute("vertex") = corners.c_str();
    return name;
  }

  /// Heights from the lowest one on, the first row at +y, over a base that is as deep as the field is wide.
  std::string field(const HeightField& field) {
    const std::string name = "field_" + std::to_string(++fields_);
    const auto [low, high] = std::ranges::minmax(field.heights);
    const double range = high - low, x = (field.nx - 1) * field.dx / 2, y = (field.ny - 1) * field.dy / 2;
    pugi::xml_node node = asset_.append_child("hfield");
    node.append_attribute("name") = name.c_str();
    node.append_attribute("nrow") = field.ny;
    node.append_attribute("ncol") = field.nx;
    node.append_attribute("size") =
        (words(Vec3(x, y, range > 0 ? range : 1)) + ' ' + words(2 * std::max({x, y, range}))).c_str();
    std::string heights;
    for (int j = field.ny - 1; j >= 0; --j)
      for (int i = 0; i < field.nx; ++i) {
        const double height = field.heights[static_cast<std::size_t>(i) +
                                            static_cast<std::size_t>(field.nx) * static_cast<std::size_t>(j)];
        heights += (heights.empty() ? "" : " ") + words(height - low);
      }
    node.append_attribute("elevation") = heights.c_str();
    return name;
  }

  static void write_surface(pugi::xml_node geom, const ShapeRecord& record) {
    const Material& m = record.material;
    geom.append_attribute("friction") =
        words(Vec3(m.dynamic_friction, m.spinning_friction, m.rolling_friction)).c_str();
    geom.append_attribute("condim") = m.rolling_friction > 0    ? 6
                                      : m.spinning_friction > 0 ? 4
                                      : m.dynamic_friction > 0  ? 3
                                                                : 1;
    if (record.filter.groups == 1 && record.filter.mask == 0xffffffff) return;
    geom.append_attribute("contype") = static_cast<int>(record.filter.groups & 0x7fffffff);
    geom.append_attribute("conaffinity") = static_cast<int>(record.filter.mask & 0x7fffffff);
  }

  /// Bodies that would touch there, and may not.
  void write_excludes() {
    std::set<BodyId> with_shapes;
    for (int s = 0; s < world_.shape_count(); ++s) with_shapes.insert(world_.shape(ShapeId{s}).body);
    constexpr std::size_t kMostBodies = 2000;
    if (with_shapes.size() > kMostBodies) {
      notices_.emplace_back("more than 2000 bodies: who may not touch whom is left out");
      return;
    }
    pugi::xml_node contact = root_.append_child("contact");
    for (BodyId a : with_shapes)
      for (BodyId b : with_shapes) {
        if (!(a < b) || world_.may_collide(a, b) || (world_.is_fixed(a) && world_.is_fixed(b))) continue;
        pugi::xml_node node = contact.append_child("exclude");
        node.append_attribute("body1") = body_name(a).c_str();
        node.append_attribute("body2") = body_name(b).c_str();
      }
    if (!contact.first_child()) root_.remove_child(contact);
  }
  std::string body_name(BodyId body) const { return body == kGround ? "world" : world_.name(body); }

  void write_other(JointId id) {
    const Joint& joint = world_.joint(id);
    if (!world_.is_attached(id)) return;
    if (const auto* coupling = dynamic_cast<const AxisCoupling*>(&joint);
        coupling && write_coupling(id, *coupling))
      return;
    const std::string_view type = joint.type();
    if (type == "ball" || type == "hinge" || type == "fixed") return write_closing(id);
    if (type == "distance" || type == "rope") return write_line(id);
    notices_.push_back(world_.name(id) + ": this joint has no counterpart (value: " + std::string(type) +
                       ")");
  }

  /// A hinge is two points of its axis.
  void write_closing(JointId id) {
    const Joint& joint = world_.joint(id);
    const auto add = [&](const char* kind) {
      pugi::xml_node node = equality_.append_child(kind);
      node.append_attribute("body1") = body_name(joint.a()).c_str();
      node.append_attribute("body2") = body_name(joint.b()).c_str();
      return node;
    };
    if (joint.type() == "fixed") return void(add("weld"));
    if (joint.type() == "hinge" && world_.has_axis_properties(id))
      notices_.push_back(world_.name(id) +
                         ": what acts along the axis of a hinge that closes a loop has no counterpart");
    for (const Vec3& point : common_points(world_, id))
      add("connect").append_attribute("anchor") = words(world_.pose(joint.a()).local(point)).c_str();
  }

  /// driven = ratio · driving: a polynomial of degree 1; more axes are a sum that stays as it is.
  bool write_coupling(JointId id, const AxisCoupling& coupling) {
    const AxisCoupling::Terms& terms = coupling.terms();
    for (const auto& [axis, factor] : terms)
      if (!names_.contains(axis)) return false;
    if (terms.size() < 2 || coupling.type() == "driver") return false;
    if (terms.size() > 2) return write_sum(world_.name(id), terms), true;
    const double ratio = -terms[0].second / terms[1].second;
    pugi::xml_node node = equality_.append_child("joint");
    node.append_attribute("name") = world_.name(id).c_str();
    node.append_attribute("joint1") = names_.at(terms[1].first).c_str();
    node.append_attribute("joint2") = names_.at(terms[0].first).c_str();
    node.append_attribute("polycoef") = ("0 " + words(ratio) + " 0 0 0").c_str();
    return true;
  }

  void write_sum(const std::string& name, const AxisCoupling::Terms& terms) {
    pugi::xml_node sum = tendon_.append_child("fixed");
    sum.append_attribute("name") = name.c_str();
    for (const auto& [axis, factor] : terms) {
      pugi::xml_node part = sum.append_child("joint");
      part.append_attribute("joint") = names_.at(axis).c_str();
      part.append_attribute("coef") = words(factor).c_str();
    }
    write_constant(name);
  }

  /// The length of a tendon.
  void write_constant(const std::string& tendon) {
    pugi::xml_node node = equality_.append_child("tendon");
    node.append_attribute("name") = tendon.c_str();
    node.append_attribute("tendon1") = tendon.c_str();
  }

  pugi::xml_node line(const std::vector<WirePoint>& points, const std::string& name) {
    pugi::xml_node node = tendon_.append_child("spatial");
    node.append_attribute("name") = name.c_str();
    for (const WirePoint& point : points) {
      const std::string site_name = name + " " + std::to_string(++sites_);
      pugi::xml_node site = nodes_[point.body.index].append_child("site");
      site.append_attribute("name") = site_name.c_str();
      site.append_attribute("pos") = words(point.p_BP).c_str();
      node.append_child("site").append_attribute("site") = site_name.c_str();
    }
    return node;
  }

  double length(const std::vector<WirePoint>& points) const {
    double sum = 0;
    for (std::size_t k = 1; k < points.size(); ++k)
      sum += (world_.pose(points[k].body).point(points[k].p_BP) -
              world_.pose(points[k - 1].body).point(points[k - 1].p_BP))
                 .norm();
    return sum;
  }

  void write_line(JointId id) {
    const std::vector<WirePoint> points = world_.joint(id).course();
    pugi::xml_node node = line(points, world_.name(id));
    if (world_.joint(id).type() == "distance") {
      write_constant(world_.name(id));
      return;
    }
    const AxisId axis = world_.axis(id, "length");
    if (world_.axis_properties(axis).motor)
      notices_.push_back(world_.axis_label(axis) +
                         ": a winch has no counterpart, its rope stays as long as it is");
    const auto& limits = world_.axis_properties(axis).limits ? world_.axis_properties(axis).limits
                                                             : world_.axis_info(axis).limits;
    node.append_attribute("limited") = "true";
    node.append_attribute("range") = ("0 " + words(limits ? limits->upper : length(points))).c_str();
  }

  void write_force(ForceId id) {
    const LineSpring* spring = world_.force(id).spring();
    if (!spring || spring->law.table || spring->law.damping_table)
      return notices_.push_back(force_label(world_, id) + ": has no counterpart");
    pugi::xml_node node =
        line({{spring->a, spring->p_AP}, {spring->b, spring->p_BQ}}, "spring_" + std::to_string(id.index));
    node.append_attribute("stiffness") = words(spring->law.stiffness).c_str();
    node.append_attribute("damping") = words(spring->law.damping).c_str();
    node.append_attribute("springlength") = words(spring->law.rest).c_str();
  }

  const Scene& scene_;
  const World& world_;
  std::vector<std::string>& notices_;
  ModelTree tree_;
  MjcfActuators actuators_;
  pugi::xml_document document_;
  pugi::xml_node root_, asset_, equality_, tendon_;
  std::map<int, pugi::xml_node> nodes_;  // by body
  std::map<AxisId, std::string> names_;  // of joints there
  int meshes_ = 0, fields_ = 0, sites_ = 0;
};

}  // namespace

std::string mjcf_of(const Scene& scene, std::vector<std::string>& notices) {
  return MjcfWriter(scene, notices).write();
}

}  // namespace taut
