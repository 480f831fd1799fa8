#include <algorithm>
#include <cmath>

#include "core/math/so3.h"
#include "scenes/import/rigid_groups.h"
#include "scenes/import/scene_document.h"

// Joints, forces and probes of a scene document.
namespace taut::model {
namespace {

/// Gaps at the start beyond this [m or rad] are closed before the first step.
constexpr double kOpen = 1e-9;

/// Names of several axes as one.
std::string joined_names(const Link& link, const JointSegment& segment) {
  std::string name;
  for (int k = segment.first; k < segment.first + segment.count; ++k)
    if (!link.axes[k].name.empty()) name += (name.empty() ? "" : "+") + link.axes[k].name;
  return name;
}

}  // namespace

void SceneDocument::write_joints(SceneJson& document) {
  SceneJson joints = SceneJson::array();
  joints_.resize(model_.links.size());
  for (int i = 0; i < static_cast<int>(model_.links.size()); ++i) {
    const Link& link = model_.links[i];
    if (link.free || stands_still(model_, i)) continue;
    if (link.axes.empty()) write_fixed(joints, i);
    for (std::size_t k = 0; k < segments_[i].size(); ++k)
      joints_[i].push_back(write_segment(joints, link, segments_[i][k],
                                         k == 0 ? body(link.parent) : between_[i][k - 1],
                                         k + 1 == segments_[i].size() ? bodies_[i] : between_[i][k]));
  }
  for (const Loop& loop : model_.loops) write_loop(joints, loop);
  for (const AxisRelation& relation : model_.relations) write_relation(joints, relation);
  write_armatures(document["bodies"], joints);
  document["joints"] = std::move(joints);
  for (const Wire& wire : model_.wires) write_wire(document, wire);
}

void SceneDocument::write_fixed(SceneJson& joints, int i) {
  const Link& link = model_.links[i];
  const std::string name = unique(joint_names_, link.joint_name, bodies_[i] + "_joint");
  joints_[i].push_back(name);
  joints.push_back({{"name", name},
                    {"type", "fixed"},
                    {"a", body(link.parent)},
                    {"b", bodies_[i]},
                    {"anchor", vector_json(link.X_WL.p)}});
}

/// The joint of the name of its axes, or of the fallback; @returns its name.
std::string SceneDocument::write_segment(SceneJson& joints, const Link& link, const JointSegment& segment,
                                         const std::string& a, const std::string& b) {
  const LinkAxis& first = link.axes[segment.first];
  const auto axis_W = [&](int k) {
    return vector_json((link.X_WL.q * link.axes[segment.first + k].axis).normalized());
  };
  const std::string name = unique(joint_names_, joined_names(link, segment), b + "_joint");
  SceneJson json{{"name", name}, {"type", segment.type}, {"a", a}, {"b", b}};
  if (segment.turned) std::swap(json["a"], json["b"]);
  if (segment.type == "universal") {
    json["frame"] = "world";
    json["anchor_a"] = json["anchor_b"] = vector_json(segment.anchor);
    json["axis_a"] = axis_W(0), json["axis_b"] = axis_W(1);
  } else {
    json["anchor"] = vector_json(segment.anchor);
    if (segment.type == "ball")
      json["frame_orientation"] = quaternion_json(link.X_WL.q);
    else if (segment.type == "six_dof")
      json["frame_orientation"] = quaternion_json(segment.frame), json["locked"] = locked_by(segment);
    else
      json["axis"] = axis_W(0);
    if (segment.type == "screw") json["pitch"] = first.pitch;
  }
  if (SceneJson axes = axes_json(link, segment); !axes.empty()) json["axes"] = std::move(axes);
  joints.push_back(std::move(json));
  return name;
}

SceneJson SceneDocument::axes_json(const Link& link, const JointSegment& segment) {
  SceneJson axes = SceneJson::object();
  if (segment.type == "ball") {
    ball_axes(axes, link.axes[segment.first]);
    return axes;
  }
  for (int k = 0; k < segment.count; ++k)
    if (SceneJson axis = axis_json(link.axes[segment.first + k]); !axis.empty())
      axes[segment.keys[k]] = std::move(axis);
  return axes;
}

/// What acts along an axis.  The scene's values are 0 at the start.
SceneJson SceneDocument::axis_json(const LinkAxis& axis) const {
  const AxisLaw& law = axis.law;
  SceneJson json = SceneJson::object();
  if (law.lower > -kNoLimit) json["limits"]["lower"] = law.lower - axis.start;
  if (law.upper < kNoLimit) json["limits"]["upper"] = law.upper - axis.start;
  if (law.friction > 0) json["friction"]["static"] = law.friction;
  if (law.stiffness > 0) json["spring"] = {{"stiffness", law.stiffness}, {"rest", law.rest - axis.start}};
  if (law.damping > 0) json["spring"]["damping"] = law.damping;
  if (axis.drive.any()) json["motor"] = motor_json(axis);
  return json;
}

/// A servo to where stiffness and constant, or damping and constant, balance; a constant force is a motor
/// that never reaches its speed.
SceneJson SceneDocument::motor_json(const LinkAxis& axis) {
  constexpr double kOutOfReach = 1e6;  // [rad/s or m/s]
  const AxisDrive& drive = axis.drive;
  const double most = std::min(drive.most, axis.most_drive);
  if (drive.stiffness == 0 && drive.damping == 0)
    return {{"velocity", std::copysign(kOutOfReach, drive.constant)},
            {"max_force", std::min(std::abs(drive.constant), most)}};
  SceneJson json = SceneJson::object();
  if (drive.stiffness > 0)
    json = {{"position", drive.constant / drive.stiffness - axis.start}, {"stiffness", drive.stiffness}};
  else
    json = {{"velocity", drive.constant / drive.damping}};
  if (drive.damping > 0) json["damping"] = drive.damping;
  if (most < kNoLimit) json["max_force"] = most;
  return json;
}

void SceneDocument::ball_axes(SceneJson& axes, const LinkAxis& axis) {
  for (const char* turn : {"turn_x", "turn_y", "turn_z"}) {
    if (axis.law.damping > 0) axes[turn]["friction"]["viscous"] = axis.law.damping;
    if (axis.law.friction > 0) axes[turn]["friction"]["static"] = axis.law.friction;
  }
  if (axis.law.upper < kNoLimit || axis.law.lower > -kNoLimit)
    note(axis.place, "a limit of the whole angle of a ball joint: has no counterpart");
  if (axis.law.stiffness == 0) return;
  for (const char* bend : {"swing", "twist"})
    axes[bend]["spring"] = {{"stiffness", axis.law.stiffness}, {"rest", 0}};
  note(axis.place,
       "the stiffness of a ball joint: that of swing and of twist, which is the same for small angles");
}

void SceneDocument::write_loop(SceneJson& joints, const Loop& loop) {
  const Pose A = world(loop.a), B = world(loop.b);
  if (stands_still(model_, loop.a.link) && stands_still(model_, loop.b.link))
    return note(loop.place, "joins two bodies that never move: left out");
  if (loop.a.link == loop.b.link) return note(loop.place, "joins a body to itself: left out");
  if (!loop.axes.empty()) return write_closing_joint(joints, loop);
  SceneJson json{{"name", unique(joint_names_, loop.name, "loop")},
                 {"type", loop.fixed   ? "fixed"
                          : loop.hinge ? "hinge"
                                       : "ball"},
                 {"a", body(loop.a.link)},
                 {"b", body(loop.b.link)},
                 {"frame", "world"},
                 {"anchor_a", vector_json(A.p)},
                 {"anchor_b", vector_json(B.p)}};
  const double gap = std::max((A.p - B.p).norm(), write_turn_of_loop(json, loop, A, B));
  open_ = open_ || (loop.active && gap > kOpen);
  if (!loop.active) json["attached"] = false;
  joints.push_back(std::move(json));
}

/// The rotation or the axes that it keeps; @returns how far they are off.
double SceneDocument::write_turn_of_loop(SceneJson& json, const Loop& loop, const Pose& A,
                                         const Pose& B) const {
  if (loop.fixed) {
    const double off = log_so3(A.q.conjugate() * B.q).norm();  // of what is to be 1
    const Quat q_AB = pose(loop.a.link).q.conjugate() * A.q * B.q.conjugate() * pose(loop.b.link).q;
    if (off > kOpen) json["orientation"] = quaternion_json(q_AB);
    return off;
  }
  if (!loop.hinge) return 0;
  const Vec3 axis_A = (A.q * *loop.hinge).normalized(), axis_B = (B.q * *loop.hinge).normalized();
  json["axis_a"] = vector_json(axis_A), json["axis_b"] = vector_json(axis_B);
  return (axis_A - axis_B).norm();
}

/// A joint of two links that others join as well.
void SceneDocument::write_closing_joint(SceneJson& joints, const Loop& loop) {
  Link link;
  link.X_WL = pose(loop.b.link);
  link.axes = loop.axes;
  link.name = body(loop.b.link);
  const std::vector<JointSegment> segments = joint_segments(link);
  if (segments.size() > 1)
    return note(loop.place, "closes a loop with axes that no single joint has: left out");
  write_segment(joints, link, segments[0], body(loop.a.link), body(loop.b.link));
}

SceneJson SceneDocument::axis_reference(const AxisName& axis) const {
  const auto& segments = segments_[axis.link];
  const auto& joints = joints_[axis.link];  // none where a link has become one body with another
  for (std::size_t s = 0; s < std::min(segments.size(), joints.size()); ++s) {
    const int k = axis.axis - segments[s].first;
    if (k >= 0 && k < static_cast<int>(segments[s].keys.size()))
      return {{"joint", joints[s]}, {"axis", segments[s].keys[k]}};
  }
  return {};
}

void SceneDocument::write_relation(SceneJson& joints, const AxisRelation& relation) {
  const SceneJson driven = axis_reference(relation.driven);
  const SceneJson driving = relation.driving ? axis_reference(*relation.driving) : SceneJson();
  const SceneJson other = relation.other ? axis_reference(*relation.other) : SceneJson();
  if (driven.empty() || (relation.driving && driving.empty()) || (relation.other && other.empty()))
    return note(relation.place, "a relation of an axis that is none of its own: has no counterpart");
  SceneJson json{{"name", unique(joint_names_, relation.name, "relation")}};
  if (relation.other) {
    json.update({{"type", "differential"}, {"input", driven}, {"left", driving}, {"right", other}});
  } else if (relation.driving) {
    json.update({{"type", "gear"}, {"driving", driving}, {"driven", driven}, {"ratio", relation.ratio}});
  } else {
    const double start = model_.links[relation.driven.link].axes[relation.driven.axis].start;
    const double value = relation.value - start;
    json.update(
        {{"type", "driver"}, {"of", driven}, {"motion", {{"linear", {{"value", value}, {"rate", 0}}}}}});
    open_ = open_ || (relation.active && std::abs(value) > kOpen);
  }
  if (!relation.active) json["attached"] = false;
  joints.push_back(std::move(json));
}

void SceneDocument::write_armatures(SceneJson& bodies, SceneJson& joints) {
  for (int i = 0; i < static_cast<int>(model_.links.size()); ++i)
    for (int k = 0; k < static_cast<int>(model_.links[i].axes.size()); ++k)
      if (model_.links[i].axes[k].armature > 0 && !stands_still(model_, i))
        write_armature(bodies, joints, {i, k});
}

/// A mass on a slide of the ground, across gravity, that goes 1 m as the axis goes 1 rad or 1 m: ½ a θ̇².
void SceneDocument::write_armature(SceneJson& bodies, SceneJson& joints, const AxisName& name) {
  const LinkAxis& axis = model_.links[name.link].axes[name.axis];
  const SceneJson reference = axis_reference(name);
  if (reference.empty()) return;
  const std::string body =
      unique(body_names_, (axis.name.empty() ? bodies_[name.link] : axis.name) + "_armature", "");
  const std::string slide = unique(joint_names_, body + "_slide", ""),
                    tie = unique(joint_names_, body + "_tie", "");
  const Vec3 at = pose(name.link).point(axis.anchor);
  Vec3 across, other;
  complete_frame(model_.gravity.isZero(0) ? Vec3(Vec3::UnitZ()) : Vec3(model_.gravity.normalized()), across,
                 other);
  constexpr double kGyration = 0.05;  // [m], of what never turns
  const Vec3 moments = Vec3::Constant(axis.armature * kGyration * kGyration);
  bodies.push_back({{"name", body},
                    {"mass", axis.armature},
                    {"inertia", vector_json(moments)},
                    {"position", vector_json(at)}});
  if (axis.rate != 0) bodies.back()["velocity"] = vector_json(axis.rate * across);
  joints.push_back({{"name", slide},
                    {"type", "slider"},
                    {"a", ground_},
                    {"b", body},
                    {"anchor", vector_json(at)},
                    {"axis", vector_json(across)}});
  joints.push_back({{"name", tie},
                    {"type", "gear"},
                    {"driving", reference},
                    {"driven", {{"joint", slide}, {"axis", "displacement"}}},
                    {"ratio", 1}});
  note(axis.place, "\"armature\": a body of this mass on a slide of the ground goes along with the axis");
}

void SceneDocument::write_wire(SceneJson& document, const Wire& wire) {
  if (std::ranges::all_of(wire.points, [&](const LinkFrame& p) { return stands_still(model_, p.link); }))
    return note(wire.place, "a wire between points that never move: left out");
  if (std::ranges::all_of(wire.points, [&](const LinkFrame& p) { return p.link == wire.points[0].link; }))
    return note(wire.place, "a wire between points of one body: left out");
  if (wire.longest < kNoLimit) write_rope(document, wire);
  if (wire.bar) write_bar(document, wire);
  if (wire.stiffness > 0 || wire.damping > 0) write_wire_spring(document, wire);
}

SceneJson SceneDocument::wire_ends(const Wire& wire) const {
  const LinkFrame &a = wire.points.front(), &b = wire.points.back();
  return {{"a", body(a.link)},
          {"b", body(b.link)},
          {"frame", "world"},
          {"anchor_a", vector_json(world(a).p)},
          {"anchor_b", vector_json(world(b).p)}};
}

void SceneDocument::write_rope(SceneJson& document, const Wire& wire) {
  double length = 0;
  for (std::size_t k = 1; k < wire.points.size(); ++k)
    length += (world(wire.points[k]).p - world(wire.points[k - 1]).p).norm();
  open_ = open_ || length > wire.longest + kOpen;
  const std::string name = unique(joint_names_, wire.name, "rope");
  SceneJson json{{"name", name}, {"type", "rope"}, {"length", wire.longest}};
  if (wire.points.size() == 2) {
    json.update(wire_ends(wire));
  } else {
    json["frame"] = "world";
    for (const LinkFrame& point : wire.points)
      json["points"].push_back({{"body", body(point.link)}, {"point", vector_json(world(point).p)}});
  }
  document["joints"].push_back(std::move(json));
}

void SceneDocument::write_bar(SceneJson& document, const Wire& wire) {
  if (wire.pulley) return write_pulley(document, wire);
  open_ = open_ || (wire.bar_active &&
                    std::abs((world(wire.points[1]).p - world(wire.points[0]).p).norm() - *wire.bar) > kOpen);
  SceneJson json{
      {"name", unique(joint_names_, wire.name, "bar")}, {"type", "distance"}, {"length", *wire.bar}};
  json.update(wire_ends(wire));
  if (!wire.bar_active) json["attached"] = false;
  document["joints"].push_back(std::move(json));
}

void SceneDocument::write_pulley(SceneJson& document, const Wire& wire) {
  SceneJson json{{"name", unique(joint_names_, wire.name, "pulley")},
                 {"type", "pulley"},
                 {"length", *wire.bar},
                 {"ratio", wire.ratio},
                 {"frame", "world"}};
  for (const LinkFrame& point : wire.points)
    json["points"].push_back({{"body", body(point.link)}, {"point", vector_json(world(point).p)}});
  if (!wire.bar_active) json["attached"] = false;
  document["joints"].push_back(std::move(json));
}

void SceneDocument::write_wire_spring(SceneJson& document, const Wire& wire) {
  if (wire.points.size() > 2)
    return note(wire.place, "the spring of a wire through several points: has no counterpart");
  SceneJson json{{"type", "spring-damper"}, {"rest_length", wire.rest}};
  if (wire.slack > 0)
    json["table"] = {{-1, -wire.stiffness}, {0, 0}, {wire.slack, 0}, {wire.slack + 1, wire.stiffness}};
  else
    json["stiffness"] = wire.stiffness;
  if (wire.damping > 0) json["damping"] = wire.damping;
  json.update(wire_ends(wire));
  document["forces"].push_back(std::move(json));
}

SceneJson SceneDocument::probe_json(const ModelProbe& probe, bool& known) {
  SceneJson json{{"quantity", probe.quantity}};
  if (probe.quantity.starts_with("axis")) {
    const SceneJson axis = probe.axis ? axis_reference(*probe.axis) : SceneJson();
    known = !axis.empty();
    json["axis"] = axis;
  } else if (probe.quantity.starts_with("reaction")) {
    known = probe.at.link != kWorld && !joints_[probe.at.link].empty();
    if (known) json["joint"] = joints_[probe.at.link].back();
    if (known && !segments_[probe.at.link].empty() && segments_[probe.at.link].back().turned)
      note(probe.place,
           "a sensor of a joint that slides behind a hinge: its probe is of what acts on the parent");
  } else if (probe.quantity != "momentum" && probe.quantity != "angular-momentum" &&
             probe.quantity != "energy") {
    json["body"] = body(probe.at.link);
    const Vec3 centre =
        probe.at.link == kWorld ? Vec3(Vec3::Zero()) : model_.links[probe.at.link].inertia.centre;
    if (probe.quantity == "position" || probe.quantity == "velocity")
      json["point"] = vector_json(probe.at.X_LF.p - centre);
  }
  return json;
}

void SceneDocument::write_probes(SceneJson& document) {
  for (const ModelProbe& probe : model_.probes) {
    bool known = true;
    SceneJson json = probe_json(probe, known);
    if (!known) {
      note(probe.place, "a sensor of an axis or joint that the scene does not have: left out");
      continue;
    }
    json["name"] = unique(probe_names_, probe.name, probe.quantity);
    document["probes"].push_back(std::move(json));
  }
}

}  // namespace taut::model
