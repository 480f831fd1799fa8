#include "core/joints.h"
#include "scenes/scene_reader.h"

namespace taut {
namespace {

/// Where the points and axes of a joint or spring are given.
enum class Frame { kWorld, kBody };
constexpr std::pair<const char*, Frame> kFrames[] = {{"world", Frame::kWorld}, {"body", Frame::kBody}};

/// What joints and springs have in common: the two bodies, and points and axes on both that the file gives in
/// the world's frame or in each body's own.  Here they are all in body axes, points from the centre of mass.
class PairKeys {
 public:
  struct Pair {
    Vec3 a, b;
  };

  PairKeys(const SceneReader& reader, JsonObject& keys)
      : a(reader.required_body(keys, "a")),
        b(reader.required_body(keys, "b")),
        object_(keys),
        pose_a_(reader.pose_of(a)),
        pose_b_(reader.pose_of(b)),
        frame_(keys.find("frame")) {
    if (frame_) in_body_ = frame_->choice(kFrames) == Frame::kBody;
  }

  /// "anchor", or "anchor_a" and "anchor_b".
  Pair points() {
    return pair("anchor", "anchor_a", "anchor_b", &JsonNode::vector,
                [](const Pose& pose, const Vec3& p_W) { return pose.local(p_W); });
  }
  /// "axis", or "axis_a" and "axis_b".
  Pair axes() { return pair("axis", "axis_a", "axis_b", &JsonNode::unit_vector, turned); }
  /// Two different axes, so always "axis_a" and "axis_b".
  Pair two_axes() {
    Pair axes{Vec3::UnitX(), Vec3::UnitY()};
    if (const auto node = separate("axis_a")) axes.a = local(pose_a_, node->unit_vector(), turned);
    if (const auto node = separate("axis_b")) axes.b = local(pose_b_, node->unit_vector(), turned);
    return axes;
  }
  /// An axis of A only: "axis" in the world's frame or "axis_a".
  Vec3 axis_of_a() {
    const auto shared = object_.find("axis"), own = object_.find("axis_a");
    if (shared && !own) {
      reject_in_body_frame(*shared, "\"axis_a\"");
      return turned(pose_a_, shared->unit_vector());
    }
    if (shared) own->problem("\"axis\" is given as well");
    const auto node = own ? separate("axis_a") : object_.required(in_body_ ? "axis_a" : "axis");
    return node ? local(pose_a_, node->unit_vector(), turned) : Vec3(Vec3::UnitZ());
  }
  /// "orientation" of B in A; the present one if it is not given.
  Quat orientation_of_b_in_a() {
    if (const auto node = object_.find("orientation")) return read_orientation(*node);
    return (pose_a_.q.conjugate() * pose_b_.q).normalized();
  }
  /// The same joint with its angles 0 in the starting poses.
  template <typename AnyJoint>
  std::shared_ptr<const Joint> zeroed(const AnyJoint& joint) const {
    return std::make_shared<const AnyJoint>(joint.zeroed(pose_a_, pose_b_));
  }
  const Pose& pose_a() const { return pose_a_; }
  const Pose& pose_b() const { return pose_b_; }
  JsonObject& object() { return object_; }

  /// A length, by default the present distance of the points.
  double length(const char* key, const Pair& points, double (JsonNode::*read)() const) {
    if (const auto node = object_.find(key)) return ((*node).*read)();
    return (pose_b_.point(points.b) - pose_a_.point(points.a)).norm();
  }

  template <typename AnyJoint, typename... Arguments>
  std::shared_ptr<const Joint> joint(const Arguments&... arguments) const {
    return std::make_shared<const AnyJoint>(a.id, b.id, arguments...);
  }

  const BodyReference a, b;

 private:
  using ToLocal = Vec3 (*)(const Pose&, const Vec3&);
  static Vec3 turned(const Pose& pose, const Vec3& v_W) { return pose.q.conjugate() * v_W; }
  Vec3 local(const Pose& pose, const Vec3& v, ToLocal to_local) const {
    return in_body_ ? v : to_local(pose, v);
  }

  /// `both` is one world vector for A and B, the others are one for each.
  Pair pair(const char* both, const char* key_a, const char* key_b, Vec3 (JsonNode::*read)() const,
            ToLocal to_local) {
    const auto shared = object_.find(both), own_a = object_.find(key_a), own_b = object_.find(key_b);
    if (shared) {
      for (const auto& own : {own_a, own_b})
        if (own) own->problem(quoted_list({both}) + " is given as well");
      reject_in_body_frame(*shared, quoted_list({key_a}) + " and " + quoted_list({key_b}));
      const Vec3 v_W = ((*shared).*read)();
      return {to_local(pose_a_, v_W), to_local(pose_b_, v_W)};
    }
    Pair result{Vec3::Zero(), Vec3::Zero()};
    if (!own_a && !own_b && !in_body_) {
      object_.required(both);
      return result;
    }
    if (const auto node = separate(key_a)) result.a = local(pose_a_, ((*node).*read)(), to_local);
    if (const auto node = separate(key_b)) result.b = local(pose_b_, ((*node).*read)(), to_local);
    return result;
  }

  /// A vector for one body.  Its frame must be said: a guess would put the joint at a wrong place.
  std::optional<JsonNode> separate(const char* key) {
    const auto node = object_.required(key);
    if (node && !frame_ && !frame_missed_) {
      object_.node().problem("\"frame\" is missing: \"world\" or \"body\" for " + quoted_list({key}), "");
      frame_missed_ = true;
    }
    return node;
  }

  void reject_in_body_frame(const JsonNode& node, const std::string& instead) const {
    if (in_body_) node.problem("is in the world's frame, but \"frame\" is \"body\"; give " + instead);
  }

  JsonObject& object_;
  Pose pose_a_, pose_b_;
  std::optional<JsonNode> frame_;
  bool in_body_ = false, frame_missed_ = false;
};

std::shared_ptr<const Joint> read_screw(PairKeys& k) {
  const auto p = k.points(), axis = k.axes();
  const double pitch = k.object().get_required("pitch", &JsonNode::number, 1.0);
  Vec3 u, v;
  complete_frame(axis.a, u, v);
  const Vec3 u_B = across(k.pose_b().q.conjugate() * (k.pose_a().q * u), axis.b);
  return k.joint<Screw>(p.a, axis.a, u, p.b, axis.b, u_B, pitch);
}

/// The x direction is across the normal; its angle is 0 at the start.
std::shared_ptr<const Joint> read_planar(PairKeys& k) {
  const auto p = k.points(), axis = k.axes();
  Vec3 u, v;
  complete_frame(axis.a, u, v);
  const Vec3 u_B = across(k.pose_b().q.conjugate() * (k.pose_a().q * u), axis.b);
  return k.joint<Planar>(p.a, axis.a, u, p.b, axis.b, u_B);
}

/// "locked" lists of "x", "y", "z", "angle_x", ... in the frame "frame_orientation" of the world.
std::shared_ptr<const Joint> read_six_dof(PairKeys& k) {
  static constexpr std::pair<const char*, int> kNames[] = {{"x", 0},       {"y", 1},       {"z", 2},
                                                           {"angle_x", 3}, {"angle_y", 4}, {"angle_z", 5}};
  const auto p = k.points();
  SixDof::Locks locks;
  if (const auto node = k.object().required("locked"))
    for (const JsonNode& item : node->items()) {
      const int i = item.choice(kNames);
      bool& lock = i < 3 ? locks.translation[i] : locks.rotation[i - 3];
      if (lock) item.problem("is given twice");
      lock = true;
    }
  Quat q_WF = Quat::Identity();
  if (const auto node = k.object().find("frame_orientation")) q_WF = read_orientation(*node);
  return k.joint<SixDof>(p.a, (k.pose_a().q.conjugate() * q_WF).normalized(), p.b,
                         (k.pose_b().q.conjugate() * q_WF).normalized(), locks);
}

std::shared_ptr<const Joint> read_rope(PairKeys& k) {
  const auto p = k.points();
  const double restitution = k.object().get("restitution", &JsonNode::not_negative, 0.0);
  return k.joint<Rope>(p.a, p.b, k.length("length", p, &JsonNode::positive), restitution);
}

/// Joint types: a new one adds its entry here (and to the schema and scenes/README.md).
struct JointReader {
  std::shared_ptr<const Joint> (*pair)(PairKeys& k);  ///< a joint of two bodies, or null and …
  std::shared_ptr<const Joint> (*coupling)(const SceneReader& reader, JsonObject& joint) = nullptr;
};
constexpr std::pair<const char*, JointReader> kJointTypes[] = {
    {"ball", {[](PairKeys& k) {
       const auto p = k.points();
       return k.joint<Ball>(p.a, p.b);
     }}},
    {"hinge", {[](PairKeys& k) {
       const auto p = k.points(), axis = k.axes();
       return k.zeroed(Hinge(k.a.id, k.b.id, p.a, axis.a, p.b, axis.b));
     }}},
    {"slider", {[](PairKeys& k) {
       const auto p = k.points();
       const Vec3 axis_A = k.axis_of_a();
       return k.joint<Slider>(p.a, axis_A, p.b, k.orientation_of_b_in_a());
     }}},
    {"fixed", {[](PairKeys& k) {
       const auto p = k.points();
       return k.joint<Fixed>(p.a, p.b, k.orientation_of_b_in_a());
     }}},
    {"universal", {[](PairKeys& k) {
       const auto p = k.points(), axis = k.two_axes();
       return k.zeroed(Universal(k.a.id, k.b.id, p.a, axis.a, p.b, axis.b));
     }}},
    {"distance", {[](PairKeys& k) {
       const auto p = k.points();
       return k.joint<Distance>(p.a, p.b, k.length("length", p, &JsonNode::positive));
     }}},
    {"cylindrical", {[](PairKeys& k) {
       const auto p = k.points(), axis = k.axes();
       return k.zeroed(Cylindrical(k.a.id, k.b.id, p.a, axis.a, p.b, axis.b));
     }}},
    {"screw", {read_screw}},
    {"planar", {read_planar}},
    {"point_on_line", {[](PairKeys& k) {
       const auto p = k.points();
       return k.joint<PointOnLine>(p.a, k.axis_of_a(), p.b);
     }}},
    {"hinge2", {[](PairKeys& k) {
       const auto p = k.points(), axis = k.two_axes();
       return k.zeroed(Hinge2(k.a.id, k.b.id, p.a, axis.a, p.b, axis.b));
     }}},
    {"six_dof", {read_six_dof}},
    {"rope", {read_rope}},
    {"gear", {nullptr, read_gear}},
    {"rack_and_pinion", {nullptr, read_rack_and_pinion}},
    {"differential", {nullptr, read_differential}},
    {"driver", {nullptr, read_driver}},
};

/// Force types: a new one adds its entry here.  The World does not check what acts on a missing body, so the
/// reader's problems are asked first.
using ForceReader = std::shared_ptr<const Force> (*)(const SceneReader& reader, JsonObject& force);

std::shared_ptr<const Force> read_point_force(const SceneReader& reader, JsonObject& force) {
  const BodyId body = reader.required_body(force, "body").id;
  const Vec3 p_BP = force.get("point", &JsonNode::vector, Vec3(Vec3::Zero()));
  const Vec3 f = force.get_required("force", &JsonNode::vector, Vec3(Vec3::Zero()));
  return std::make_shared<PointForce>(body, p_BP, f, force.get("follows_body", &JsonNode::boolean, false));
}

std::shared_ptr<const Force> read_torque(const SceneReader& reader, JsonObject& force) {
  const BodyId body = reader.required_body(force, "body").id;
  const Vec3 torque = force.get_required("torque", &JsonNode::vector, Vec3(Vec3::Zero()));
  return std::make_shared<BodyTorque>(body, torque, force.get("follows_body", &JsonNode::boolean, false));
}

std::shared_ptr<const Force> read_spring_damper(const SceneReader& reader, JsonObject& force) {
  PairKeys keys(reader, force);
  const auto p = keys.points();
  const double stiffness = force.get_required("stiffness", &JsonNode::not_negative, 0.0);
  const double rest_length = keys.length("rest_length", p, &JsonNode::not_negative);
  const double damping = force.get("damping", &JsonNode::not_negative, 0.0);
  return std::make_shared<SpringDamper>(keys.a.id, keys.b.id, p.a, p.b, stiffness, rest_length, damping);
}

constexpr std::pair<const char*, ForceReader> kForceTypes[] = {
    {"point-force", read_point_force},
    {"torque", read_torque},
    {"spring-damper", read_spring_damper},
};

}  // namespace

void SceneReader::read_joint(const JsonNode& node) {
  const std::size_t before = problems_.size();
  JsonObject joint(node);
  const auto name_node = joint.find("name");
  const std::string name = name_node ? name_node->string() : "";
  const auto type = joint.required("type");
  const std::size_t before_type = problems_.size();
  const JointReader read_type = type ? type->choice(kJointTypes) : JointReader{};
  if (!type || problems_.size() != before_type) {  // its keys are not known
    if (!name.empty()) path_of_joint_.emplace(name, node.path());
    return;
  }
  const auto axes = joint.find("axes");
  std::shared_ptr<const Joint> made;
  bool bodies_found = true, bodies_sound = true;
  if (read_type.coupling) {
    node.guard_if_sound(before, [&] { made = read_type.coupling(*this, joint); });
    joint.reject_unknown_keys();
  } else {
    PairKeys keys(*this, joint);
    node.guard_if_sound(before, [&] { made = read_type.pair(keys); });
    joint.reject_unknown_keys();
    bodies_found = keys.a.found && keys.b.found;
    bodies_sound = keys.a.sound && keys.b.sound;
    if (bodies_found) {
      if (keys.a.id == keys.b.id)
        joint.find("b")->problem("joins a body to itself");
      else if (bodies_sound && scene_.world.is_fixed(keys.a.id) && scene_.world.is_fixed(keys.b.id))
        node.problem("joins two fixed bodies",
                     scene_.world.name(keys.a.id) + ", " + scene_.world.name(keys.b.id));
    }
  }

  const auto owner = path_of_joint_.find(name);
  if (!name.empty() && (owner != path_of_joint_.end() || scene_.world.has_joint(name)))
    name_node->problem("name is already taken by " +
                       (owner != path_of_joint_.end() ? owner->second : "a generated joint"));
  else if (!name.empty())
    path_of_joint_[name] = node.path();
  JointId id;
  if (made && bodies_found && problems_.size() == before)
    node.guard([&] {
      id = scene_.world.add_joint(name, made);
      path_of_joint_[scene_.world.name(id)] = node.path();
      joint_paths_.resize(id.index + 1);
      if (bodies_sound) joint_paths_[id.index] = node.path();
    });
  if (axes) read_axes(*axes, id);
}

void SceneReader::read_force(const JsonNode& node) {
  const std::size_t before = problems_.size();
  JsonObject force(node);
  const auto type = force.required("type");
  if (!type) return;
  const ForceReader read_type = type->choice(kForceTypes);
  if (problems_.size() != before) return;
  std::shared_ptr<const Force> made;
  node.guard_if_sound(before, [&] { made = read_type(*this, force); });
  force.reject_unknown_keys();
  if (made && problems_.size() == before) node.guard([&] { scene_.world.add_force(made); });
}

}  // namespace taut
