#include "scenes/import/sdf_reader.h"

#include <algorithm>
#include <charconv>
#include <map>

#include "scenes/import/height_picture.h"
#include "scenes/import/link_inertia.h"
#include "scenes/import/mesh_shape.h"
#include "scenes/import/sdf_sensor.h"
#include "scenes/import/xml_values.h"

namespace taut::model {
namespace {

/// Frames that are given relative to each other.
constexpr int kMostFramesDeep = 200;

class SdfModelReader {
 public:
  SdfModelReader(XmlFiles& files, const pugi::xml_node& model_node, RobotModel& model)
      : files_(files), node_(model_node), model_(model) {}

  void read() {
    files_.find(node_, "name");
    X_WM_ = raw_pose(node_);
    static_ = flag(node_, "static", false);
    own_touch_ = flag(node_, "self_collide", false);
    gather_frames();
    const auto each = [&](const char* name, void (SdfModelReader::*read_one)(const pugi::xml_node&)) {
      bool all = true;
      for (const pugi::xml_node& node : files_.children(node_, name))
        all = files_.attempt([&] { (this->*read_one)(node); }) && all;
      return all && is_whole_;
    };
    // What follows would lack what is wrong.
    if (each("link", &SdfModelReader::read_link) && each("joint", &SdfModelReader::read_joint))
      each("joint", &SdfModelReader::relate);
  }

 private:
  // --- values of elements
  std::optional<std::string> find_text(const pugi::xml_node& parent, const char* name) {
    const pugi::xml_node child = files_.child(parent, name);
    if (!child) return {};
    return std::string(text_of(child));
  }
  std::string text(const pugi::xml_node& parent, const char* name) {
    if (auto found = find_text(parent, name)) return *found;
    files_.fail(parent, std::string("<") + parent.name() + "> needs <" + name + ">");
  }
  bool flag(const pugi::xml_node& parent, const char* name, bool fallback) {
    const auto found = find_text(parent, name);
    return found ? *found == "true" || *found == "1" : fallback;
  }
  double value(const pugi::xml_node& parent, const char* name, double fallback) {
    const auto found = find_text(parent, name);
    return found ? exactly(files_, parent, name, *found, 1)[0] : fallback;
  }
  Vec3 triple(const pugi::xml_node& parent, const char* name) {
    const auto v = exactly(files_, parent, name, text(parent, name), 3);
    return {v[0], v[1], v[2]};
  }
  double length(const pugi::xml_node& parent, const char* name) {
    text(parent, name);
    return positive(files_, parent, name, value(parent, name, 0));
  }
  /// In the frame that it is given in.
  Pose raw_pose(const pugi::xml_node& parent) {
    const auto found = find_text(parent, "pose");
    if (!found || found->empty()) return {};
    const auto v = exactly(files_, parent, "pose", *found, 6);
    return {from_rpy({v[3], v[4], v[5]}), Vec3(v[0], v[1], v[2])};
  }

  // --- frames
  void gather_frames() {
    for (const char* kind : {"link", "frame", "joint"})
      for (const pugi::xml_node& node : files_.children(node_, kind))
        frames_.try_emplace(files_.required(node, "name"), node);
  }

  /// The pose in the model of a frame by its name.
  Pose frame(const pugi::xml_node& from, const std::string& name, int depth = 0) {
    if (name.empty() || name == "__model__" || name == "world") return {};
    const auto found = frames_.find(name);
    if (found == frames_.end())
      files_.fail(from,
                  "there is no frame of this name" + near_name(name, frames_) + " (value: " + name + ")");
    return pose_in_model(found->second, depth + 1);
  }

  /// Links are placed in the model, joints in their child, unless the pose says otherwise.
  Pose pose_in_model(const pugi::xml_node& node, int depth = 0) {
    if (depth > kMostFramesDeep)
      files_.fail(node, "frames are relative to each other in a circle, or more than 200 deep");
    std::string base;
    if (std::string_view(node.name()) == "joint") base = text(node, "child");
    if (const char* attached = files_.find(node, "attached_to")) base = attached;
    if (const pugi::xml_node pose = files_.child(node, "pose"))
      for (const char* key : {"relative_to", "frame"})
        if (const char* given = files_.find(pose, key); given && *given) base = given;
    return frame(node, base, depth) * raw_pose(node);
  }

  // --- links
  void read_link(const pugi::xml_node& node) {
    Link link;
    link.name = files_.required(node, "name");
    link.place = files_.place(node);
    link.X_WL = X_WM_ * pose_in_model(node);
    link.X_WL.q.normalize();
    link.free = !static_;
    link.inertia = inertia_of(node);
    for (const pugi::xml_node& shape : files_.children(node, "collision"))
      is_whole_ = files_.attempt([&] { read_collision(link, shape); }) && is_whole_;
    const int index = static_cast<int>(model_.links.size());
    for (const pugi::xml_node& sensor : files_.children(node, "sensor"))
      read_sdf_sensor(files_, sensor, {index, {}}, false, model_);
    if (!index_.try_emplace(link.name, index).second)
      files_.fail(node, "there is another link of this name (value: " + link.name + ")");
    model_.links.push_back(std::move(link));
  }

  LinkInertia inertia_of(const pugi::xml_node& link) {
    const pugi::xml_node node = files_.child(link, "inertial");
    LinkInertia result;
    result.mass = node ? not_negative(files_, node, "mass", value(node, "mass", 1)) : 1;
    result.inertia.setIdentity();
    if (!node) {
      if (!static_)
        note(link, "<link> without <inertial>: its mass is 1 kg, and its moments of inertia are 1 kg m²");
      return result;
    }
    if (const pugi::xml_node tensor = files_.child(node, "inertia")) {
      const auto moment = [&](const char* key, double fallback) { return value(tensor, key, fallback); };
      const double xx = moment("ixx", 1), yy = moment("iyy", 1), zz = moment("izz", 1);
      const double xy = moment("ixy", 0), xz = moment("ixz", 0), yz = moment("iyz", 0);
      result.inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    }
    return in_frame(raw_pose(node), result);
  }

  void read_collision(Link& link, const pugi::xml_node& node) {
    const pugi::xml_node geometry = files_.child(node, "geometry");
    if (!geometry) files_.fail(node, "<collision> needs <geometry>");
    LinkShape shape;
    if (const char* name = files_.find(node, "name")) shape.name = name;
    shape.X_LS = raw_pose(node);
    if (!own_touch_) shape.touches.type = own_bits(), shape.touches.affinity = ~own_bits() & 0x7fffffff;
    if (const auto surface = files_.child(node, "surface")) {
      if (const auto friction = files_.child(surface, "friction"))
        if (const auto ode = files_.child(friction, "ode")) shape.surface.sliding = value(ode, "mu", 1);
      if (const auto contact = files_.child(surface, "contact")) {
        constexpr int kAll = 0xffff;
        shape.touches.collide = bitmask(contact, "collide_bitmask", kAll);
        shape.touches.category = bitmask(contact, "category_bitmask", shape.touches.collide);
      }
    }
    try {
      if (auto found = shape_of(geometry, shape.X_LS)) {
        shape.shape = std::move(*found);
        link.shapes.push_back(std::move(shape));
      }
    } catch (const ImportError&) {
      throw;
    } catch (const std::invalid_argument& error) {
      note(geometry, std::string("<geometry>: its shape is left out: ") + error.what());
    }
  }
  /// 16 bits, also in hexadecimal digits.
  int bitmask(const pugi::xml_node& parent, const char* name, int fallback) {
    const auto found = find_text(parent, name);
    if (!found) return fallback;
    const bool hexadecimal = found->starts_with("0x") || found->starts_with("0X");
    const char *begin = found->data() + (hexadecimal ? 2 : 0), *end = found->data() + found->size();
    int bits = -1;
    const auto [rest, error] = std::from_chars(begin, end, bits, hexadecimal ? 16 : 10);
    if (error != std::errc() || rest != end || bits < 0 || bits > 0xffff)
      files_.fail(parent, std::string("<") + name + "> must be a number of 16 bits (value: " + *found + ")");
    return bits;
  }
  /// Links of one model do not touch each other unless it says so.
  int own_bits() const { return 1 << std::min<std::size_t>(model_.models, 30); }

  std::optional<Shape> shape_of(const pugi::xml_node& geometry, Pose& X_LS) {
    if (const auto box = files_.child(geometry, "box")) return Box{triple(box, "size")};
    if (const auto ball = files_.child(geometry, "sphere")) return Sphere{length(ball, "radius")};
    if (const auto round = files_.child(geometry, "cylinder"))
      return Cylinder{length(round, "radius"), length(round, "length")};
    if (const auto capsule = files_.child_or(geometry, "capsule", "drake:capsule"))
      return Capsule{length(capsule, "radius"), length(capsule, "length")};
    if (const auto ellipsoid = files_.child(geometry, "ellipsoid"))
      return Ellipsoid{triple(ellipsoid, "radii")};
    if (const auto egg = files_.child(geometry, "drake:ellipsoid"))
      return Ellipsoid{{length(egg, "a"), length(egg, "b"), length(egg, "c")}};
    if (const auto plane = files_.child(geometry, "plane")) {
      const Vec3 normal = files_.child(plane, "normal") ? triple(plane, "normal") : Vec3(Vec3::UnitZ());
      X_LS.q = X_LS.q * rotation_between(Vec3::UnitZ(), direction(files_, plane, "normal", normal));
      files_.child(plane, "size");
      return HalfSpace{};
    }
    if (const auto cone = files_.child(geometry, "cone")) return cone_of(cone, X_LS);
    if (const auto map = files_.child(geometry, "heightmap")) return field_of(map, X_LS);
    if (const auto mesh = files_.child(geometry, "mesh")) {
      const Vec3 scale = files_.child(mesh, "scale") ? triple(mesh, "scale") : Vec3(Vec3::Ones());
      return mesh_hull(files_.folder(mesh), text(mesh, "uri"), scale);
    }
    note(geometry, "<geometry>: of this kind has no counterpart: left out");
    return {};
  }

  /// Its frame is in the middle of its length, with the apex at +z; the shape's is at the centre of its mass.
  Shape cone_of(const pugi::xml_node& node, Pose& X_LS) {
    const Cone cone{length(node, "radius"), length(node, "length")};
    X_LS = X_LS * Pose{Quat::Identity(), Vec3(0, 0, -cone.height / 4)};
    return cone;
  }

  /// A picture, with its first row at +y: its largest value is as high as the size says, black is 0.
  Shape field_of(const pugi::xml_node& node, Pose& X_LS) {
    const Vec3 size = files_.child(node, "size") ? triple(node, "size") : Vec3(Vec3::Ones());
    for (double edge : size) positive(files_, node, "size", edge);
    const std::string uri = text(node, "uri");
    HeightPicture picture = read_png(read_named_file(files_.folder(node), uri));
    const double most = std::ranges::max(picture.values);
    for (double& value : picture.values) value *= most > 0 ? size.z() / most : 0;
    turn_rows(picture.values, picture.width);
    if (files_.child(node, "pos")) X_LS = X_LS * Pose{Quat::Identity(), triple(node, "pos")};
    note(node, "<heightmap>: all that is below it is solid");
    return field_over(picture.width, picture.height, size, std::move(picture.values));
  }

  // --- joints
  int link_of(const pugi::xml_node& joint, const std::string& name) {
    if (name == "world") return kWorld;
    const auto found = index_.find(name);
    if (found == index_.end())
      files_.fail(joint,
                  "there is no link of this name" + near_name(name, index_) + " (value: " + name + ")");
    return found->second;
  }

  void read_joint(const pugi::xml_node& node) {
    const std::string name = files_.required(node, "name"), type = files_.required(node, "type");
    if (type == "gearbox") return;
    const int parent = link_of(node, text(node, "parent")), child = link_of(node, text(node, "child"));
    if (parent == child) files_.fail(node, "joint \"" + name + "\" joins a link to itself");
    if (static_) return note(node, "<joint> of a static model: left out");
    if (child == kWorld) files_.fail(node, "the world cannot be a child");
    std::vector<LinkAxis> axes = axes_of(node, name, type, child);
    Link& link = model_.links[child];
    link_of_joint_[name] = kWorld;
    if (link.free && !leads_to(parent, child)) {
      link_of_joint_[name] = child;
      link.free = false;
      link.parent = parent;
      link.axes = std::move(axes);
      link.joint_name = name;
      return;
    }
    const Pose X_CJ = inverse(link.X_WL) * X_WM_ * pose_in_model(node);
    const Pose X_WP = parent == kWorld ? Pose{} : model_.links[parent].X_WL;
    Loop loop{name,
              {parent, inverse(X_WP) * link.X_WL * X_CJ},
              {child, X_CJ},
              axes.empty(),
              std::move(axes),
              true,
              files_.place(node)};
    model_.loops.push_back(std::move(loop));
  }

  /// Whether the way from the link to the world passes the other one.
  bool leads_to(int link, int other) const {
    while (link != kWorld && link != other && !model_.links[link].free) link = model_.links[link].parent;
    return link == other;
  }

  std::vector<LinkAxis> axes_of(const pugi::xml_node& node, const std::string& name, const std::string& type,
                                int child) {
    using Freedom = LinkAxis::Kind;
    if (type == "fixed") return {};
    if (type == "revolute" || type == "continuous")
      return {axis_of(node, "axis", name, Freedom::kHinge, child)};
    if (type == "prismatic") return {axis_of(node, "axis", name, Freedom::kSlide, child)};
    if (type == "ball") return {axis_of(node, "axis", name, Freedom::kBall, child)};
    if (type == "screw") {
      LinkAxis axis = axis_of(node, "axis", name, Freedom::kScrew, child);
      axis.pitch = value(node, "screw_thread_pitch", value(node, "thread_pitch", 1));
      return {axis};
    }
    if (type == "universal" || type == "revolute2")
      return {axis_of(node, "axis", name + "_1", Freedom::kHinge, child),
              axis_of(node, "axis2", name + "_2", Freedom::kHinge, child)};
    files_.fail(node, "joint \"" + name + "\" has an unknown type" +
                          meant_type(type, {"fixed", "revolute", "continuous", "prismatic", "ball", "screw",
                                            "universal", "revolute2", "gearbox"}) +
                          " (value: " + type + ")");
  }

  LinkAxis axis_of(const pugi::xml_node& joint, const char* key, const std::string& name, LinkAxis::Kind kind,
                   int child) {
    LinkAxis axis;
    axis.kind = kind;
    axis.name = name;
    axis.place = files_.place(joint);
    const Pose X_MJ = pose_in_model(joint), X_LM = inverse(model_.links[child].X_WL) * X_WM_;
    axis.anchor = X_LM.point(X_MJ.p);
    const pugi::xml_node node = files_.child(joint, key);
    if (!node) {
      if (kind == LinkAxis::Kind::kBall) return axis;
      files_.fail(joint, "joint \"" + name + "\" needs <" + key + ">");
    }
    axis.axis = X_LM.q * (axis_frame(node, X_MJ) * direction(files_, node, "xyz", triple(node, "xyz")));
    if (const auto limit = files_.child(node, "limit")) {
      const bool effort = files_.child(limit, "effort"), velocity = files_.child(limit, "velocity");
      if (effort || velocity)
        note(limit, "<limit>: <effort> and <velocity> bound a motor, and an SDF has none: nothing to bound");
      axis.law.lower = value(limit, "lower", -kNoLimit);
      axis.law.upper = value(limit, "upper", kNoLimit);
      if (std::abs(axis.law.lower) >= 1e16) axis.law.lower = -kNoLimit;  // what stands for none
      if (std::abs(axis.law.upper) >= 1e16) axis.law.upper = kNoLimit;
      if (axis.law.lower > axis.law.upper)
        files_.fail(limit, "<lower> is above <upper> at joint \"" + name + "\"");
    }
    if (const auto dynamics = files_.child(node, "dynamics")) {
      const auto of = [&](const char* what) {
        return not_negative(files_, dynamics, what, value(dynamics, what, 0));
      };
      axis.law.damping = of("damping");
      axis.law.friction = of("friction");
      axis.law.stiffness = of("spring_stiffness");
      axis.law.rest = value(dynamics, "spring_reference", 0);
    }
    return axis;
  }

  /// What <xyz> is given in, in the axes of the model.
  Quat axis_frame(const pugi::xml_node& axis, const Pose& X_MJ) {
    if (flag(axis, "use_parent_model_frame", false)) return Quat(1, 0, 0, 0);
    const char* given = files_.find(files_.child(axis, "xyz"), "expressed_in");
    return given && *given ? frame(axis, given).q : X_MJ.q;
  }

  /// Gearboxes, and mimics and sensors of a joint, which need the others.
  void relate(const pugi::xml_node& node) {
    if (std::string_view(node.attribute("type").value()) == "gearbox") return read_gearbox(node);
    if (static_) return;
    const std::string name = files_.required(node, "name");
    for (const char* key : {"axis", "axis2"})
      if (const auto axis = files_.child(node, key))
        if (const auto mimic = files_.child(axis, "mimic")) read_mimic(mimic, name, key);
    for (const pugi::xml_node& sensor : files_.children(node, "sensor"))
      read_sdf_sensor(files_, sensor, {link_of_joint_.at(name), {}}, true, model_);
  }

  /// The hinge, slide or screw that is the joint's axis of this key; none of one that closes a loop.
  std::optional<AxisName> axis_name(const std::string& joint, std::string_view key) const {
    const int link = link_of_joint_.at(joint);
    const int k = key == "axis2" ? 1 : 0;
    if (link == kWorld || k >= static_cast<int>(model_.links[link].axes.size())) return {};
    if (model_.links[link].axes[k].kind == LinkAxis::Kind::kBall) return {};
    return AxisName{link, k};
  }

  /// follower = multiplier (leader − reference) + offset.
  void read_mimic(const pugi::xml_node& node, const std::string& follower, const char* key) {
    const std::string leader = files_.required(node, "joint");
    if (!link_of_joint_.contains(leader))
      files_.fail(node, "there is no joint of this name (value: " + leader + ")");
    const char* of = files_.find(node, "axis");
    const auto driven = axis_name(follower, key), driving = axis_name(leader, of ? of : "axis");
    AxisRelation relation;
    relation.name = follower + "_mimic";
    relation.ratio = value(node, "multiplier", 1);
    relation.place = files_.place(node);
    const double constant = value(node, "offset", 0) - relation.ratio * value(node, "reference", 0);
    if (!driven || !driving || relation.ratio == 0)
      return note(node,
                  "<mimic> of joints that do not move or close a loop, or by a multiplier of 0: left out");
    if (constant != 0) note(node, "<mimic>: the relation holds as at the start, without its constant");
    relation.driven = *driven, relation.driving = *driving;
    model_.relations.push_back(std::move(relation));
  }

  /// theta_1 = −ratio theta_2: of the parent and of the child against the reference body.
  void read_gearbox(const pugi::xml_node& node) {
    const std::string name = files_.required(node, "name");
    const int parent = link_of(node, text(node, "parent")), child = link_of(node, text(node, "child"));
    const int reference = link_of(node, text(node, "gearbox_reference_body"));
    const double ratio = value(node, "gearbox_ratio", 1);
    const auto turns = [&](int link, const char* key) {
      const auto axis = axis_of(node, key, name, LinkAxis::Kind::kHinge, link);
      if (link == kWorld || model_.links[link].parent != reference || model_.links[link].axes.size() != 1 ||
          model_.links[link].axes[0].kind != LinkAxis::Kind::kHinge)
        return 0.0;
      const double along = axis.axis.dot(model_.links[link].axes[0].axis);
      return std::abs(std::abs(along) - 1) < 1e-6 ? along : 0.0;
    };
    const double first = turns(parent, "axis"), second = turns(child, "axis2");
    if (first == 0 || second == 0 || ratio == 0)
      return note(
          node,
          "<joint> \"" + name +
              "\": a gearbox of links that do not turn about these axes of the reference body: left out");
    AxisRelation relation;
    relation.name = name;
    relation.driven = {parent, 0};
    relation.driving = AxisName{child, 0};
    relation.ratio = first * second > 0 ? -ratio : ratio;
    relation.place = files_.place(node);
    model_.relations.push_back(std::move(relation));
  }

  void note(const pugi::xml_node& node, const std::string& message) {
    model_.notices.push_back({files_.place(node), message, 1});
  }

  XmlFiles& files_;
  pugi::xml_node node_;
  RobotModel& model_;
  Pose X_WM_;
  bool static_ = false, own_touch_ = false;
  bool is_whole_ = true;  // no part of a link is wrong
  std::map<std::string, pugi::xml_node> frames_;
  std::map<std::string, int> index_;
  std::map<std::string, int> link_of_joint_;  // the link that hangs on it; kWorld: it closes a loop
};

}  // namespace

RobotModel read_sdf(XmlFiles& files, const pugi::xml_node& sdf) {
  RobotModel model;
  std::vector<pugi::xml_node> models = files.children(sdf, "model");
  for (const pugi::xml_node& world : files.children(sdf, "world")) {
    if (const auto gravity = files.child(world, "gravity")) {
      const auto g = exactly(files, gravity, "gravity", text_of(gravity), 3);
      model.gravity = {g[0], g[1], g[2]};
    }
    for (const pugi::xml_node& node : files.children(world, "model")) models.push_back(node);
  }
  if (models.empty()) files.fail(sdf, "has no <model>");
  for (const pugi::xml_node& node : models) {
    files.attempt([&] { SdfModelReader(files, node, model).read(); });
    ++model.models;
  }
  files.throw_problems();
  if (models.size() == 1) model.name = models[0].attribute("name").value();
  return model;
}

}  // namespace taut::model
