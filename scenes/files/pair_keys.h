#pragma once

#include <optional>

#include "scenes/files/scene_reader.h"

namespace taut {

/// Where the points and axes of a joint or spring are given.
inline constexpr std::pair<const char*, bool> kIsBodyFrame[] = {{"world", false}, {"body", true}};

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
        reader_(reader),
        object_(keys),
        pose_a_(reader.pose_of(a)),
        pose_b_(reader.pose_of(b)),
        frame_(keys.find("frame")) {
    if (frame_) in_body_ = frame_->choice(kIsBodyFrame);
  }

  /// "anchor", or "anchor_a" and "anchor_b".
  Pair points() {
    Pair p = pair("anchor", "anchor_a", "anchor_b", &JsonNode::vector, local_point);
    if (in_body_) p.a -= a.centre, p.b -= b.centre;
    anchors = p;
    return p;
  }
  /// The same of what lies between two points: both are asked for if none is given.
  Pair two_points() {
    for (const char* key : {"anchor", "anchor_a", "anchor_b"})
      if (object_.find(key)) return points();
    object_.required("anchor_a");
    object_.required("anchor_b");
    return {Vec3::Zero(), Vec3::Zero()};
  }
  /// A point of B only: "anchor" in the world's frame or "anchor_b".
  Vec3 point_of_b() {
    const Vec3 p = one("anchor", "anchor_b", pose_b_, &JsonNode::vector, local_point);
    return in_body_ ? Vec3(p - b.centre) : p;
  }
  /// A point of a list, of A.
  Vec3 point_on_a(const Vec3& p) const { return in_body_ ? Vec3(p - a.centre) : local_point(pose_a_, p); }
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
  Vec3 axis_of_a() { return one("axis", "axis_a", pose_a_, &JsonNode::unit_vector, turned); }
  /// "orientation" of B in A; the present one if it is not given.
  Quat orientation_of_b_in_a() {
    if (const auto node = object_.find("orientation")) return read_orientation(*node);
    return (pose_a_.q.conjugate() * pose_b_.q).normalized();
  }
  struct Frames {
    Quat q_AF, q_BG;
  };
  /// "frame_orientation" in the world of frames on A and B that agree at the start, or "orientation_a" and
  /// "orientation_b" in body axes; nothing if none is there.
  std::optional<Frames> frames() {
    const auto shared = object_.find("frame_orientation"), own_a = object_.find("orientation_a"),
               own_b = object_.find("orientation_b");
    if (shared) {
      for (const auto& own : {own_a, own_b})
        if (own) own->problem("\"frame_orientation\" is given as well");
      const Quat q_WF = read_orientation(*shared);
      return Frames{(pose_a_.q.conjugate() * q_WF).normalized(), (pose_b_.q.conjugate() * q_WF).normalized()};
    }
    if (!own_a && !own_b) return {};
    Frames result{Quat::Identity(), Quat::Identity()};
    if (const auto node = object_.required("orientation_a")) result.q_AF = read_orientation(*node);
    if (const auto node = object_.required("orientation_b")) result.q_BG = read_orientation(*node);
    return result;
  }
  /// The same joint with its angles 0 in the starting poses.
  template <typename AnyJoint>
  std::shared_ptr<const Joint> zeroed(const AnyJoint& joint) const {
    return std::make_shared<const AnyJoint>(joint.zeroed(pose_a_, pose_b_));
  }
  const Pose& pose_a() const { return pose_a_; }
  const Pose& pose_b() const { return pose_b_; }
  JsonObject& object() { return object_; }
  const World& world() const { return reader_.world(); }

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
  std::optional<Pair> anchors;  ///< what points() has read

 private:
  using ToLocal = Vec3 (*)(const Pose&, const Vec3&);
  static Vec3 local_point(const Pose& pose, const Vec3& p_W) { return pose.local(p_W); }
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

  /// A vector of one body only, under the key for both in the world's frame or under its own.
  Vec3 one(const char* both, const char* key, const Pose& pose, Vec3 (JsonNode::*read)() const,
           ToLocal to_local) {
    const auto shared = object_.find(both), own = object_.find(key);
    if (shared && !own) {
      reject_in_body_frame(*shared, quoted_list({key}));
      return to_local(pose, ((*shared).*read)());
    }
    if (shared) own->problem(quoted_list({both}) + " is given as well");
    const auto node = own ? separate(key) : object_.required(in_body_ ? key : both);
    return node ? local(pose, ((*node).*read)(), to_local) : Vec3(Vec3::UnitZ());
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

  const SceneReader& reader_;
  JsonObject& object_;
  Pose pose_a_, pose_b_;
  std::optional<JsonNode> frame_;
  bool in_body_ = false, frame_missed_ = false;
};

}  // namespace taut
