#include "core/joints/joints.h"
#include "scenes/files/pair_keys.h"

namespace taut {
namespace {

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

/// With frames it has free axes.
std::shared_ptr<const Joint> read_ball(PairKeys& k) {
  const auto p = k.points();
  const Ball ball(k.a.id, k.b.id, p.a, p.b);
  const auto frames = k.frames();
  return std::make_shared<const Ball>(frames ? ball.with_axes(frames->q_AF, frames->q_BG) : ball);
}

/// "locked" lists "x", "y", "z", "angle_x", ... of the frames.
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
  const PairKeys::Frames world_axes{k.pose_a().q.conjugate(), k.pose_b().q.conjugate()};
  const PairKeys::Frames f = k.frames().value_or(world_axes);
  return k.joint<SixDof>(p.a, f.q_AF, p.b, f.q_BG, locks);
}

std::shared_ptr<const Joint> read_rope(PairKeys& k) {
  const auto p = k.two_points();
  const double restitution = k.object().get("restitution", &JsonNode::zero_to_one, 0.0);
  return k.joint<Rope>(p.a, p.b, k.length("length", p, &JsonNode::positive), restitution);
}

/// Joint types: a new one adds its entry here (and to the schema and scenes/files/FORMAT.md).
struct JointReader {
  JointFromPair pair;             ///< a joint of two bodies; null: …
  JointFromKeys other = nullptr;  ///< … one of axes, or of "points"
};
/// Those that turn about a point, which is therefore on both bodies, or near them.
bool turns_about_a_point(std::string_view type) {
  return type == "ball" || type == "hinge" || type == "universal" || type == "hinge2";
}
constexpr std::pair<const char*, JointReader> kJointTypes[] = {
    {"ball", {read_ball}},
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
       const auto p = k.two_points();
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
    {"rope", {read_rope, read_rope_over_points}},
    {"pulley", {nullptr, read_pulley}},
    {"point_on_curve", {read_point_on_curve}},
    {"pose_driver", {read_pose_driver}},
    {"gear", {nullptr, read_gear}},
    {"rack_and_pinion", {nullptr, read_rack_and_pinion}},
    {"differential", {nullptr, read_differential}},
    {"driver", {nullptr, read_driver}},
};

}  // namespace

/// "" if it has none, or one that is taken (a problem): it is unnamed as far as all the rest goes.
std::string SceneReader::free_joint_name(JsonObject& joint) {
  const auto node = joint.find("name");
  std::string name = node ? node->string() : "";
  if (name.empty()) return name;
  const auto owner = path_of_joint_.find(name);
  const bool of_file = owner != path_of_joint_.end();
  if (of_file || scene_.world.has_joint(name)) {
    node->problem("name is already taken by " + (of_file ? owner->second : "a generated joint"));
    return "";
  }
  path_of_joint_[name] = joint.node().path();
  return name;
}

SceneReader::JointOfFile SceneReader::read_joint_of_pair(JsonObject& joint, std::size_t before,
                                                         JointFromPair make) {
  const JsonNode& node = joint.node();
  JointOfFile result;
  PairKeys keys(*this, joint);
  guard_item(node, before, [&] { result.made = make(keys); });
  joint.reject_unknown_keys();
  result.bodies_found = keys.a.found && keys.b.found;
  result.bodies_placed = keys.a.placed && keys.b.placed;
  if (result.made && result.bodies_placed && keys.a.shaped && keys.b.shaped && keys.anchors &&
      turns_about_a_point(result.made->type()))
    anchors_.push_back({node, keys.a.id, keys.b.id, keys.anchors->a, keys.anchors->b});
  if (!result.bodies_found) return result;
  const World& world = scene_.world;
  if (keys.a.id == keys.b.id)
    joint.find("b")->problem("joins a body to itself");
  else if (result.bodies_placed && world.is_fixed(keys.a.id) && world.is_fixed(keys.b.id))
    node.problem("joins two fixed bodies", world.name(keys.a.id) + ", " + world.name(keys.b.id));
  return result;
}

SceneReader::JointOfFile SceneReader::read_joint_of_axes(JsonObject& joint, std::size_t before,
                                                         JointFromKeys make) {
  JointOfFile result;
  guard_item(joint.node(), before, [&] { result.made = make(*this, joint); });
  joint.reject_unknown_keys();
  if (!result.made) return result;
  for (BodyId body : result.made->bodies())
    result.bodies_placed = result.bodies_placed && !unplaced_bodies_.contains(body.index);
  return result;
}

void SceneReader::read_joint(const JsonNode& node) {
  knows_all_ = true;
  JsonObject joint(node);
  const std::string name = free_joint_name(joint);
  const std::size_t before = problems_.size();
  const auto type = joint.required("type");
  const auto known_type = type ? type->choice_or_meant(kJointTypes) : std::nullopt;
  if (!known_type) {  // its keys are not known
    misses_joint_ = true;
    return;
  }
  const JointReader read_type = *known_type;
  for (const char* key : {"axes", "compliance", "break", "attached"}) joint.find(key);
  const bool of_axes = !read_type.pair || (read_type.other && joint.find("points"));
  const auto [made, bodies_found, bodies_placed] = of_axes
                                                       ? read_joint_of_axes(joint, before, read_type.other)
                                                       : read_joint_of_pair(joint, before, read_type.pair);
  JointId id;
  if (made && bodies_found && problems_.size() == before)
    node.guard([&, &made = made, placed = bodies_placed] {
      id = scene_.world.add_joint(name, made);
      path_of_joint_[scene_.world.name(id)] = node.path();
      joint_paths_.resize(id.index + 1);
      if (placed) joint_paths_[id.index] = node.path();
    });
  misses_joint_ = misses_joint_ || id.index < 0;
  if (const auto axes = joint.find("axes")) read_axes(*axes, id);
  read_joint_properties(joint, id);
}

}  // namespace taut
