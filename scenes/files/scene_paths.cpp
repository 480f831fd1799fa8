#include "core/joints/joints.h"
#include "scenes/files/pair_keys.h"

// Joints in a scene file that have a course: wires over points, a point on a curve, a body on a given way.
namespace taut {
namespace {

/// "points" of a wire: [{"body", "point"}, ...] with "frame"; nothing if one of the bodies is not there.
std::optional<std::vector<WirePoint>> read_wire(const SceneReader& reader, JsonObject& joint) {
  const auto frame = joint.required("frame"), list = joint.required("points");
  const bool in_body = frame && frame->choice(kIsBodyFrame);
  std::vector<WirePoint> points;
  bool found = list.has_value();
  for (const JsonNode& item : list ? list->items("an array of points") : std::vector<JsonNode>()) {
    JsonObject keys(item);
    const BodyReference body = reader.required_body(keys, "body");
    const Vec3 p = keys.get_required("point", &JsonNode::vector, Vec3(Vec3::Zero()));
    keys.reject_unknown_keys();
    found = found && body.found;
    points.push_back({body.id, in_body ? Vec3(p - body.centre) : reader.pose_of(body).local(p)});
  }
  if (!found) return {};
  return points;
}

/// Present distance of two points of a wire.
double section(const SceneReader& reader, const WirePoint& P, const WirePoint& Q) {
  const World& world = reader.world();
  return (world.pose(Q.body).point(Q.p_BP) - world.pose(P.body).point(P.p_BP)).norm();
}

/// A number or a motion, as a motion.  In degrees it must be a number: a motion has keys in degrees.
Motion number_or_motion(const JsonNode& node, bool angular) {
  const bool is_number = node.json().is_number() || node.unit() != 1;
  return is_number ? linear_motion(node.number(), 0) : read_motion(node, angular);
}

/// "turns": [{"axis", "angle": motion}, ...].
std::vector<Turning> read_turns(const JsonNode& list) {
  std::vector<Turning> turns;
  for (const JsonNode& item : list.items("an array of turns")) {
    JsonObject keys(item);
    Turning turn;
    turn.axis = keys.get_required("axis", &JsonNode::unit_vector, Vec3(Vec3::UnitZ()));
    if (const auto angle = keys.required(in_angles("angle"))) turn.angle = number_or_motion(*angle, true);
    keys.reject_unknown_keys();
    turns.push_back(std::move(turn));
  }
  return turns;
}

/// The same motion of the centres of mass, from one of the frames of the file: p += q c_B − c_A.
PoseMotion between_centres(PoseMotion motion, const Vec3& centre_A, const Vec3& centre_B) {
  if (centre_A.isZero(0) && centre_B.isZero(0)) return motion;
  return [=](double t) {
    PosePoint at = motion(t);
    const Vec3 r = at.pose.q * centre_B;
    const Vec3 &w = at.velocity.w, v = w.cross(r);
    at.pose.p += r - centre_A;
    at.acceleration.v += at.acceleration.w.cross(r) + w.cross(v);
    at.velocity.v += v;
    return at;
  };
}

}  // namespace

std::shared_ptr<const Joint> read_rope_over_points(const SceneReader& reader, JsonObject& joint) {
  const auto points = read_wire(reader, joint);
  const double restitution = joint.get("restitution", &JsonNode::zero_to_one, 0.0);
  double length = 0;
  for (std::size_t i = 1; points && i < points->size(); ++i)
    length += section(reader, (*points)[i - 1], (*points)[i]);
  length = joint.get("length", &JsonNode::positive, length);
  std::optional<double> stop;
  if (const auto node = joint.find("stop")) stop = node->not_negative();
  if (!points) return nullptr;
  return std::make_shared<Rope>(*points, length, restitution, stop);
}

std::shared_ptr<const Joint> read_pulley(const SceneReader& reader, JsonObject& joint) {
  const auto points = read_wire(reader, joint);
  const double ratio = joint.get("ratio", &JsonNode::positive, 1.0);
  const auto length_node = joint.find("length");
  double length = length_node ? length_node->positive() : 0;
  if (!points) return nullptr;
  if (points->size() != 4) {
    joint.find("points")->problem(
        "must be 4 points: of A, where the wire meets and leaves the sheaves, of B");
    return nullptr;
  }
  const auto& [a, c1, c2, b] = std::tie((*points)[0], (*points)[1], (*points)[2], (*points)[3]);
  if (!length_node) length = section(reader, a, c1) + ratio * section(reader, c2, b);
  return std::make_shared<Pulley>(a, c1, c2, b, length, ratio);
}

std::shared_ptr<const Joint> read_point_on_curve(PairKeys& k) {
  std::vector<Vec3> points;
  if (const auto list = k.object().required("points"))
    for (const Vec3& p : list->vectors()) points.push_back(k.point_on_a(p));
  std::vector<double> parameters;
  if (const auto list = k.object().find("parameters")) {
    parameters = list->numbers();
  } else {  // the distances of the points
    for (std::size_t i = 0; i < points.size(); ++i)
      parameters.push_back(i == 0 ? 0 : parameters.back() + (points[i] - points[i - 1]).norm());
  }
  const bool closed = k.object().get("closed", &JsonNode::boolean, false);
  const Vec3 p_BQ = k.point_of_b();
  return k.joint<PointOnCurve>(CubicSpline<3>(parameters, points, closed), p_BQ);
}

std::shared_ptr<const Joint> read_pose_driver(PairKeys& k) {
  const Pose start{(k.pose_a().q.conjugate() * k.pose_b().q).normalized(), k.pose_a().local(k.pose_b().p)};
  const double time = k.world().time();
  std::vector<Turning> turns;
  if (const auto node = k.object().find("turns")) turns = read_turns(*node);
  const Quat turned = pose_motion({}, turns)(time).pose.q;
  Quat q = (turned.conjugate() * start.q).normalized();
  if (const auto node = k.object().find("orientation")) q = read_orientation(*node);
  // The origins of the frames of the file, seen from that of A.
  const Vec3 p = start.p + k.a.centre - start.q * k.b.centre;
  std::array<Motion, 3> position{linear_motion(p[0], 0), linear_motion(p[1], 0), linear_motion(p[2], 0)};
  if (const auto node = k.object().find("position")) {
    const std::vector<JsonNode> items = node->items("an array of 3 numbers or motions");
    if (items.size() != 3 && node->is_array()) node->problem("must be an array of 3 numbers or motions");
    for (std::size_t i = 0; i < 3 && items.size() == 3; ++i) position[i] = number_or_motion(items[i], false);
  }
  return k.joint<PoseDriver>(between_centres(pose_motion(position, turns, q), k.a.centre, k.b.centre));
}

}  // namespace taut
