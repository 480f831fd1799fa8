#include "scenes/import/urdf_reader.h"

#include <cmath>
#include <deque>
#include <map>

#include "scenes/import/link_inertia.h"
#include "scenes/import/mesh_shape.h"
#include "scenes/import/sdf_sensor.h"
#include "scenes/import/xml_values.h"

namespace taut::model {
namespace {

struct UrdfJoint {
  pugi::xml_node node;
  std::string name, type, parent, child;
  Pose origin;  ///< of the joint's frame in the parent's
};

class UrdfReader {
 public:
  UrdfReader(XmlFiles& files, const pugi::xml_node& robot) : files_(files), robot_(robot) {}

  RobotModel read() {
    if (const char* name = files_.find(robot_, "name")) model_.name = name;
    const auto each = [&](const char* name, void (UrdfReader::*read_one)(const pugi::xml_node&)) {
      for (const pugi::xml_node& node : files_.children(robot_, name))
        files_.attempt([&] { (this->*read_one)(node); });
    };
    each("joint", &UrdfReader::read_joint);
    each("link", &UrdfReader::read_link);
    files_.throw_problems();  // what follows would lack what is wrong
    if (link_nodes_.empty()) files_.fail(robot_, "has no links");
    read_starts();
    place_links(root());
    files_.throw_problems();
    each("loop_joint", &UrdfReader::read_loop);
    relate();
    for (const pugi::xml_node& node : robot_.children("gazebo"))
      if (node.child("sensor") || node.child("mu1")) files_.attempt([&] { read_gazebo(node); });
    files_.throw_problems();
    return std::move(model_);
  }

 private:
  Pose origin_of(const pugi::xml_node& parent) {
    const pugi::xml_node origin = files_.child(parent, "origin");
    if (!origin) return {};
    return {from_rpy(vector(files_, origin, "rpy", Vec3::Zero())),
            vector(files_, origin, "xyz", Vec3::Zero())};
  }

  void read_joint(const pugi::xml_node& node) {
    UrdfJoint joint{node,           files_.required(node, "name"), files_.required(node, "type"), {}, {},
                    origin_of(node)};
    const pugi::xml_node parent = files_.child(node, "parent"), child = files_.child(node, "child");
    if (!parent || !child) files_.fail(node, "joint \"" + joint.name + "\" needs <parent> and <child>");
    joint.parent = files_.required(parent, "link");
    joint.child = files_.required(child, "link");
    if (!joint_of_child_.try_emplace(joint.child, joints_.size()).second)
      files_.fail(node, "link \"" + joint.child + "\" is the child of two joints");
    if (!joint_by_name_.try_emplace(joint.name, joints_.size()).second)
      files_.fail(node, "there is another joint of this name (value: " + joint.name + ")");
    joints_.push_back(std::move(joint));
  }

  void read_link(const pugi::xml_node& node) {
    const std::string name = files_.required(node, "name");
    if (!link_nodes_.try_emplace(name, node).second)
      files_.fail(node, "there is another link of this name (value: " + name + ")");
    order_.push_back(name);
  }

  std::string root() {
    std::string found;
    for (const UrdfJoint& joint : joints_)
      for (const std::string& name : {joint.parent, joint.child})
        files_.attempt([&] {
          if (!link_nodes_.contains(name))
            files_.fail(joint.node, "joint \"" + joint.name + "\" names a link that is not there" +
                                        near_name(name, link_nodes_) + " (value: " + name + ")");
        });
    files_.throw_problems();
    for (const std::string& name : order_) {
      if (joint_of_child_.contains(name)) continue;
      if (!found.empty())
        files_.fail(link_nodes_.at(name),
                    "neither \"" + found + "\" nor \"" + name + "\" has a parent: no tree");
      found = name;
    }
    if (found.empty()) files_.fail(robot_, "no link is without a parent: the joints go round");
    return found;
  }

  /// Values of the joints at the start: 0, and what follows from it for those that mimic others.
  void read_starts() {
    start_.assign(joints_.size(), 0);
    for (std::size_t i = 0; i < joints_.size(); ++i) start_[i] = start_of(i, 0);
  }
  double start_of(std::size_t i, int depth) {
    const pugi::xml_node mimic = files_.child(joints_[i].node, "mimic");
    if (!mimic) return 0;
    if (depth > kMostElementsDeep) files_.fail(mimic, "joints mimic each other in a circle");
    const auto driving = joint_by_name_.find(files_.required(mimic, "joint"));
    if (driving == joint_by_name_.end())
      files_.fail(mimic, "there is no joint of this name" +
                             near_name(mimic.attribute("joint").value(), joint_by_name_) +
                             " (value: " + mimic.attribute("joint").value() + ")");
    return number(files_, mimic, "multiplier", 1) * start_of(driving->second, depth + 1) +
           number(files_, mimic, "offset", 0);
  }

  /// From the root to the leaves.
  void place_links(const std::string& root) {
    std::multimap<std::string, std::size_t> children;
    for (std::size_t i = 0; i < joints_.size(); ++i) children.emplace(joints_[i].parent, i);
    const bool is_world = root == "world" && !files_.child(link_nodes_.at(root), "inertial");
    std::deque<std::string> waiting{root};
    if (is_world) {
      index_[root] = kWorld;
      model_.ground_shapes = shapes_of(link_nodes_.at(root));
    } else {
      add_link(root, nullptr);
    }
    while (!waiting.empty()) {
      const std::string name = std::move(waiting.front());
      waiting.pop_front();
      for (auto [i, end] = children.equal_range(name); i != end; ++i) {
        add_link(joints_[i->second].child, &joints_[i->second]);
        waiting.push_back(joints_[i->second].child);
      }
    }
    for (const std::string& name : order_)
      if (!index_.contains(name))
        files_.fail(link_nodes_.at(name),
                    "link \"" + name + "\" is not joined to \"" + root + "\": its joints go round");
    if (!is_world) hold_root();
  }

  /// What has a mass is free, all else is fixed to the world.
  void hold_root() {
    double mass = 0;
    std::vector<bool> fixed(model_.links.size(), false);
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      const Link& link = model_.links[i];
      fixed[i] = i == 0 || (link.axes.empty() && !link.free && fixed[link.parent]);
      if (fixed[i]) mass += link.inertia.mass;
    }
    Link& root = model_.links[0];
    root.free = mass > 0;
    note(link_nodes_.at(root.name), root.free
                                        ? "\"" + root.name + "\" has no parent and is free"
                                        : "\"" + root.name + "\" has no parent and no mass: it is fixed");
  }

  void add_link(const std::string& name, const UrdfJoint* joint) {
    const pugi::xml_node& node = link_nodes_.at(name);
    Link link;
    link.name = name;
    link.place = files_.place(node);
    files_.attempt([&] { link.inertia = inertia_of(node); });
    link.shapes = shapes_of(node);
    if (joint) {
      link.parent = index_.at(joint->parent);
      files_.attempt([&] { read_motion_of(link, *joint); });
    }
    index_[name] = static_cast<int>(model_.links.size());
    model_.links.push_back(std::move(link));
  }

  LinkInertia inertia_of(const pugi::xml_node& link) {
    const pugi::xml_node node = files_.child(link, "inertial");
    if (!node) return {};
    const pugi::xml_node mass = files_.child(node, "mass"), tensor = files_.child(node, "inertia");
    const Pose X = origin_of(node);
    LinkInertia result;
    if (mass) result.mass = not_negative(files_, mass, "value", required_number(files_, mass, "value"));
    const auto moment = [&](const char* key) { return tensor ? required_number(files_, tensor, key) : 0.0; };
    const double xx = moment("ixx"), yy = moment("iyy"), zz = moment("izz");
    const double xy = moment("ixy"), xz = moment("ixz"), yz = moment("iyz");
    result.inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return in_frame(X, result);
  }

  std::vector<LinkShape> shapes_of(const pugi::xml_node& link) {
    std::vector<LinkShape> shapes;
    for (const pugi::xml_node& node : files_.children(link, "collision"))
      files_.attempt([&] {
        const pugi::xml_node geometry = files_.child(node, "geometry");
        if (!geometry) files_.fail(node, "<collision> needs <geometry>");
        const Pose X = origin_of(node);
        const char* name = files_.find(node, "name");
        if (auto shape = shape_of(geometry)) {
          LinkShape placed;
          placed.shape = std::move(*shape);
          placed.X_LS = X;
          if (name) placed.name = name;
          shapes.push_back(std::move(placed));
        }
      });
    return shapes;
  }

  /// Files have shapes of size 0 for places without one.
  std::optional<Shape> shape_of(const pugi::xml_node& geometry) {
    const auto size = [&](const pugi::xml_node& node, const char* key) {
      return not_negative(files_, node, key, required_number(files_, node, key));
    };
    std::optional<Shape> shape;
    double least = 0;
    if (const auto box = files_.child(geometry, "box")) {
      const Vec3 edges = vector(files_, box, "size", Vec3::Zero());
      least = not_negative(files_, box, "size", edges.minCoeff());
      shape = Box{edges};
    } else if (const auto sphere = files_.child(geometry, "sphere")) {
      least = size(sphere, "radius");
      shape = Sphere{least};
    } else if (const auto round = files_.child(geometry, "cylinder")) {
      const Cylinder cylinder{size(round, "radius"), size(round, "length")};
      least = std::min(cylinder.radius, cylinder.length);
      shape = cylinder;
    } else if (const auto egg = files_.child(geometry, "drake:ellipsoid")) {
      const Vec3 radii(size(egg, "a"), size(egg, "b"), size(egg, "c"));
      least = radii.minCoeff();
      shape = Ellipsoid{radii};
    } else if (const auto capsule = files_.child_or(geometry, "capsule", "drake:capsule")) {
      shape = Capsule{least = size(capsule, "radius"), size(capsule, "length")};
    } else if (const auto mesh = files_.child(geometry, "mesh")) {
      return hull_of(mesh);
    } else {
      const std::string given = geometry.first_child().name();
      files_.fail(geometry,
                  "<geometry> has none of box, sphere, cylinder, capsule, drake:ellipsoid and mesh" +
                      meant_type(given, {"box", "sphere", "cylinder", "capsule", "drake:ellipsoid", "mesh"}));
    }
    if (least > 0) return shape;
    note(geometry, "<geometry> of size 0: left out");
    return {};
  }

  std::optional<Shape> hull_of(const pugi::xml_node& mesh) {
    const Vec3 scale = vector(files_, mesh, "scale", Vec3::Ones());
    const std::string name = files_.required(mesh, "filename");
    try {
      return mesh_hull(files_.folder(mesh), name, scale);
    } catch (const std::invalid_argument& error) {
      note(mesh, std::string("<mesh>: its shape is left out: ") + error.what());
      return {};
    }
  }

  /// The motion that a joint gives its child, and where the child is.
  void read_motion_of(Link& link, const UrdfJoint& joint) {
    link.joint_name = joint.name;
    const double start = start_[joint_by_name_.at(joint.name)];
    Pose moved;
    if (joint.type == "revolute" || joint.type == "continuous") {
      link.axes = {axis_of(joint, LinkAxis::Kind::kHinge, start)};
      moved.q = exp_so3(start * link.axes[0].axis);
    } else if (joint.type == "prismatic") {
      link.axes = {axis_of(joint, LinkAxis::Kind::kSlide, start)};
      moved.p = start * link.axes[0].axis;
    } else if (joint.type == "planar") {
      link.axes = planar_axes(joint);
    } else if (joint.type == "ball" || joint.type == "spherical") {
      link.axes = {axis_of(joint, LinkAxis::Kind::kBall, 0)};
    } else if (joint.type == "floating") {
      link.free = true;
    } else if (joint.type != "fixed") {
      files_.fail(joint.node, "joint \"" + joint.name + "\" has an unknown type" +
                                  meant_type(joint.type, {"revolute", "continuous", "prismatic", "fixed",
                                                          "floating", "planar", "ball", "spherical"}) +
                                  " (value: " + joint.type + ")");
    }
    const Pose X_WP = link.parent == kWorld ? Pose{} : model_.links[link.parent].X_WL;
    link.X_WL = X_WP * joint.origin * moved;
    link.X_WL.q.normalize();
    // Before the motion a slide was where the joint is.
    for (LinkAxis& axis : link.axes) axis.anchor = Vec3::Zero();
  }

  LinkAxis axis_of(const UrdfJoint& joint, LinkAxis::Kind kind, double start) {
    LinkAxis axis;
    axis.kind = kind;
    axis.name = joint.name;
    axis.start = start;
    axis.place = files_.place(joint.node);
    if (const auto node = files_.child(joint.node, "axis"))
      axis.axis = direction(files_, node, "xyz", vector(files_, node, "xyz", Vec3::UnitX()));
    else
      axis.axis = Vec3::UnitX();
    const auto limit = files_.child(joint.node, "limit");
    const bool endless = joint.type == "continuous";
    if (limit) note_motor_limits(limit);
    if (limit && endless && (limit.attribute("lower") || limit.attribute("upper"))) {
      files_.find(limit, "lower"), files_.find(limit, "upper");
      note(limit, "<limit> of a continuous joint: \"lower\" and \"upper\" do not count");
    }
    if (limit && !endless) {
      axis.law.lower = number(files_, limit, "lower", 0);
      axis.law.upper = number(files_, limit, "upper", 0);
      if (axis.law.lower > axis.law.upper)
        files_.fail(limit, "\"lower\" is above \"upper\" at joint \"" + joint.name + "\"");
      if (axis.law.lower == axis.law.upper)
        note(limit, "<limit> leaves no freedom: the joint stays where it starts");
    }
    if (const auto dynamics = files_.child(joint.node, "dynamics")) {
      axis.law.damping = not_negative(files_, dynamics, "damping", number(files_, dynamics, "damping", 0));
      axis.law.friction = not_negative(files_, dynamics, "friction", number(files_, dynamics, "friction", 0));
    }
    return axis;
  }

  /// What a motor of the joint may at most do; no motor is in the file.
  void note_motor_limits(const pugi::xml_node& limit) {
    const char *effort = files_.find(limit, "effort"), *velocity = files_.find(limit, "velocity");
    if (effort || velocity)
      note(limit,
           "<limit>: \"effort\" and \"velocity\" bound a motor, and a URDF has none: nothing to bound");
  }

  /// Two slides across the normal and a turn about it.
  std::vector<LinkAxis> planar_axes(const UrdfJoint& joint) {
    LinkAxis turn = axis_of(joint, LinkAxis::Kind::kHinge, 0);
    LinkAxis x = turn, y = turn;
    x.kind = y.kind = LinkAxis::Kind::kSlide;
    complete_frame(turn.axis, x.axis, y.axis);
    turn.law.lower = -kNoLimit, turn.law.upper = kNoLimit;
    x.name += "_x", y.name += "_y";
    return {x, y, turn};
  }

  /// Two frames of links that stay together, an extension: their origins do, and of a hinge an axis, which
  /// has the same components in both.  Without a type it is a ball.
  void read_loop(const pugi::xml_node& node) {
    Loop loop;
    loop.place = files_.place(node);
    if (const char* name = files_.find(node, "name")) loop.name = name;
    loop.a = loop_end(node, "link1");
    loop.b = loop_end(node, "link2");
    const char* given = files_.find(node, "type");
    const std::string type = given ? given : "ball";
    if (type == "revolute" || type == "continuous") {
      const pugi::xml_node axis = files_.child(node, "axis");
      loop.hinge = axis ? direction(files_, axis, "xyz", vector(files_, axis, "xyz", Vec3::UnitX()))
                        : Vec3(Vec3::UnitX());
    } else if (type == "fixed") {
      loop.fixed = true;
    } else if (type != "ball" && type != "spherical") {
      files_.fail(node, "<loop_joint> is none of revolute, continuous, ball, spherical and fixed (value: " +
                            type + ")");
    }
    model_.loops.push_back(std::move(loop));
  }
  LinkFrame loop_end(const pugi::xml_node& loop, const char* key) {
    const pugi::xml_node node = files_.child(loop, key);
    if (!node) files_.fail(loop, std::string("<loop_joint> needs <") + key + ">");
    const auto link = index_.find(files_.required(node, "link"));
    if (link == index_.end())
      files_.fail(node, "there is no link of this name" + near_name(node.attribute("link").value(), index_) +
                            " (value: " + node.attribute("link").value() + ")");
    return {link->second,
            {from_rpy(vector(files_, node, "rpy", Vec3::Zero())), vector(files_, node, "xyz", Vec3::Zero())}};
  }

  void relate() {
    for (const UrdfJoint& joint : joints_) {
      const pugi::xml_node mimic = files_.child(joint.node, "mimic");
      const Link* link = mimic ? &model_.links[index_.at(joint.child)] : nullptr;
      if (!mimic) continue;
      const std::size_t driving = joint_by_name_.at(mimic.attribute("joint").value());
      AxisRelation relation;
      relation.name = joint.name + "_mimic";
      relation.driven = {index_.at(joint.child), 0};
      relation.driving = AxisName{index_.at(joints_[driving].child), 0};
      relation.ratio = number(files_, mimic, "multiplier", 1);
      relation.place = files_.place(mimic);
      const Link& other = model_.links[relation.driving->link];
      if (link->axes.size() != 1 || other.axes.size() != 1 || relation.ratio == 0)
        note(mimic, "<mimic> of joints that do not move, or by a multiplier of 0: left out");
      else
        model_.relations.push_back(std::move(relation));
    }
  }

  /// Sensors of a link or a joint, and the friction of a link; what else there is has no counterpart.
  void read_gazebo(const pugi::xml_node& node) {
    files_.accept(node);
    if (!node.child("sensor") && !node.attribute("reference"))
      return note(node, "<gazebo>: friction of no link: left out");
    const std::string name = files_.required(node, "reference");
    const auto link = index_.find(name);
    const auto joint = joint_by_name_.find(name);
    if (link != index_.end()) read_friction(node, link->second);
    if (link == index_.end() && !node.child("sensor"))
      return note(node, "<gazebo>: friction of no link that is there: left out");
    if (link == index_.end() && joint == joint_by_name_.end())
      files_.fail(node, "there is no link or joint of this name" + near_name(name, index_) +
                            " (value: " + name + ")");
    const bool of_joint = link == index_.end();
    const int at = of_joint ? index_.at(joints_[joint->second].child) : link->second;
    for (const pugi::xml_node& sensor : files_.children(node, "sensor"))
      read_sdf_sensor(files_, sensor, {at, {}}, of_joint, model_);
  }

  /// Coulomb's coefficient of all shapes of a link, as a text or as `value`.
  void read_friction(const pugi::xml_node& gazebo, int link) {
    const auto coefficient = [&](const char* name) -> std::optional<double> {
      const pugi::xml_node node = files_.child(gazebo, name);
      if (!node) return {};
      const char* given = files_.find(node, "value");
      const std::string text(given ? std::string_view(given) : text_of(node));
      return not_negative(files_, node, name, exactly(files_, node, name, text, 1)[0]);
    };
    const auto first = coefficient("mu1"), second = coefficient("mu2");
    if (!first) return;
    if (second && *second != *first)
      note(gazebo, "<gazebo>: friction that differs by direction: \"mu1\" is taken");
    for (LinkShape& shape : model_.shapes_of(link)) shape.surface.sliding = *first;
  }

  void note(const pugi::xml_node& node, const std::string& message) {
    model_.notices.push_back({files_.place(node), message, 1});
  }

  XmlFiles& files_;
  pugi::xml_node robot_;
  RobotModel model_;
  std::vector<UrdfJoint> joints_;
  std::vector<std::string> order_;  // of the links in the file
  std::map<std::string, pugi::xml_node> link_nodes_;
  std::map<std::string, std::size_t> joint_of_child_, joint_by_name_;
  std::map<std::string, int> index_;  // of links in the model
  std::vector<double> start_;         // by joint
};

}  // namespace

RobotModel read_urdf(XmlFiles& files, const pugi::xml_node& robot) { return UrdfReader(files, robot).read(); }

}  // namespace taut::model
