#include "core/joints/joints.h"
#include "scenes/builders/drawing.h"
#include "scenes/builders/hanging_chain.h"
#include "scenes/files/scene_reader.h"
#include "scenes/support/format.h"

// Bodies of a scene file that are given by their ends: rods, capsules, beams, and cables of many links.
namespace taut {
namespace {

/// More links than this are a mistake: to find how so many hang takes some ten seconds.
constexpr int kMostLinks = 100'000;
/// A cable that is longer than its span by less than this part is straight.
constexpr double kSlack = 1e-6;

/// Turns x to the direction and y to `across` as far as it is perpendicular to it; both of any length.
Quat frame_along(const Vec3& x, const Vec3& across) {
  Mat3 axes;
  axes.col(0) = x.normalized();
  axes.col(1) = (across - across.dot(axes.col(0)) * axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return Quat(axes).normalized();
}

/// A level direction across x: so that z is up as far as it can be, or along world x if x is up itself.
Vec3 level_across(const Vec3& x, const Vec3& up) {
  const Vec3 across = up.cross(x);
  if (across.norm() > 1e-6 * up.norm() * x.norm()) return across;  // of length 0 but for round-off
  return x.cross(std::abs(x.normalized().x()) < 0.5 ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitY()));
}

/// A cable between two points that do not move: straight, it would need an infinite tension.
void note_no_slack(const JsonNode& node, const Vec3& span, double length, const Vec3& gravity) {
  const double distance = span.norm();
  if (length > (1 + kSlack) * distance || span.cross(gravity).norm() <= kSlack * distance) return;
  node.slip(
      format("has no slack between its ends, so that no tension can carry its weight; give \"length\" "
             "more than %.6g",
             distance));
}

PlacedShape capsule_along_x(double length, double radius) {
  PlacedShape rod = rod_shape(length, radius);
  return {Capsule{radius, length}, rod.pose};
}

/// "from" and "to": their middle and difference.  A problem if they are the same point.
struct Span {
  Vec3 middle, d = Vec3::UnitX();
};
Span read_span(JsonObject& keys) {
  const std::size_t before = keys.node().problems().size();
  const Vec3 from = keys.get_required("from", &JsonNode::vector, Vec3(Vec3::Zero()));
  const Vec3 to = keys.get_required("to", &JsonNode::vector, Vec3(Vec3::UnitX()));
  if (keys.node().problems().size() != before) return {};
  if (from == to) {
    keys.find("to")->problem("is the same point as \"from\"");
    return {};
  }
  return {(from + to) / 2, to - from};
}

double positive_of(JsonObject& keys, const char* key) {
  return keys.get_required(key, &JsonNode::positive, 1.0);
}

/// The kinds of bodies by their ends.
using ReadEnds = PlacedShape (*)(JsonObject& keys, double length);
constexpr std::pair<const char*, ReadEnds> kEndKinds[] = {
    {"rod", [](JsonObject& k, double length) { return rod_shape(length, positive_of(k, "radius")); }},
    {"capsule",
     [](JsonObject& k, double length) { return capsule_along_x(length, positive_of(k, "radius")); }},
    {"beam",
     [](JsonObject& k, double length) {
       const double width = positive_of(k, "width");
       return PlacedShape{Box{Vec3(length, width, positive_of(k, "height"))}};
     }},
};

/// The normal of the plane that a chain hangs in; of a straight one, level if that can be.
Vec3 across_links(const std::vector<Vec3>& nodes) {
  const Vec3 first = nodes[1] - nodes[0];
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < nodes.size(); ++i)
    if (const Vec3 other = first.cross(nodes[i + 1] - nodes[i]); other.norm() > normal.norm()) normal = other;
  return normal.norm() > 1e-6 * first.squaredNorm() ? normal : level_across(first, Vec3::UnitZ());
}

}  // namespace

std::optional<BodyByEnds> SceneReader::read_body_by_ends(JsonObject& body) const {
  std::optional<BodyByEnds> result;
  std::string kind;
  for (const auto& [key, read_kind] : kEndKinds) {
    const auto node = body.find(key);
    if (!node) continue;
    if (result) {
      node->problem(quoted_list({kind}) + " is given as well");
      continue;
    }
    kind = key;
    const std::size_t before = problems_.size();
    JsonObject keys(*node);
    const Span span = read_span(keys);
    const bool placed = node->json().is_object() && problems_.size() == before;
    Vec3 up = Vec3::UnitZ();
    if (kind == "beam") up = keys.get("up", &JsonNode::unit_vector, up);
    result = BodyByEnds{FileShape{*node, read_kind(keys, span.d.norm()), {}, {}, {}, {}},
                        {frame_along(span.d, level_across(span.d, up)), span.middle},
                        placed,
                        false};
    read_surface(keys, result->shape);
    keys.reject_unknown_keys();
    node->guard_if_sound(before, [&] { check_shape(result->shape.placed.shape); });
    result->sound = problems_.size() == before;
  }
  for (const char* key : {"shape", "shapes", "inertia", "position", "orientation"})
    if (const auto other = result ? body.find(key) : std::nullopt)
      other->problem("has no place here: " + quoted_list({kind}) + " says it");
  return result;
}

void SceneReader::check_link_names(JsonObject& cable, const std::string& name, int links,
                                   std::size_t before) {
  for (int i = 0; i < links && problems_.size() == before; ++i)
    if (const std::string link = name + "_" + std::to_string(i); scene_.world.has_body(link))
      cable.find("name")->problem("makes the body " + quoted_list({link}) + ", which is there already");
}

void SceneReader::add_links(const JsonNode& node, const Cable& cable) {
  const auto& [name, nodes, link, radius, link_mass, surface, ends] = cable;
  const Vec3 across = across_links(nodes);
  BodyId last = ends[0].id;
  Vec3 p_last = ends[0].found ? pose_of(ends[0]).local(nodes[0]) : Vec3(Vec3::Zero());
  bool joined = ends[0].found && ends[0].placed;
  const auto join = [&](BodyId next, const Vec3& p_next, int k) {
    const JointId id = scene_.world.add_joint(cable.name + "_joint_" + std::to_string(k),
                                              std::make_shared<const Ball>(last, next, p_last, p_next));
    path_of_joint_[scene_.world.name(id)] = node.path();
    joint_paths_.resize(id.index + 1);
  };
  FileShape shape = surface;
  shape.placed = capsule_along_x(link, radius);
  const int n = static_cast<int>(nodes.size()) - 1;
  for (int i = 0; i < n; ++i) {
    BodySpec spec;
    spec.name = name + "_" + std::to_string(i);
    spec.mass = MassProperties::rod(link, radius, link_mass);
    spec.pose = {frame_along(nodes[i + 1] - nodes[i], across), (nodes[i] + nodes[i + 1]) / 2};
    const BodyId id = scene_.world.add_body(spec);
    path_of_body_[spec.name] = node.path();
    add_shapes(id, {shape}, Vec3::Zero());
    if (joined) join(id, Vec3(-link / 2, 0, 0), i);
    last = id;
    p_last = Vec3(link / 2, 0, 0);
    joined = true;
  }
  if (ends[1].found && ends[1].placed) join(ends[1].id, pose_of(ends[1]).local(nodes[n]), n);
}

/// A chain of links with ball joints: bodies "name_0" ..., joints "name_joint_0" ..., where that of an end
/// which nothing holds is left out.
void SceneReader::read_cable(const JsonNode& node) {
  const std::size_t before = problems_.size();
  JsonObject cable(node);
  const std::string name = cable.get_required("name", &JsonNode::string, std::string());
  const Span span = read_span(cable);
  const Vec3 from = span.middle - span.d / 2, to = span.middle + span.d / 2;
  const int n = cable.get_required("links", &JsonNode::positive_integer, 1);
  if (n > kMostLinks) cable.find("links")->problem("must be at most " + std::to_string(kMostLinks));
  const double radius = positive_of(cable, "radius"),
               length = cable.get("length", &JsonNode::positive, span.d.norm());
  const auto mass = cable.one_of({"mass", "density"});
  const double amount = mass ? mass->positive() : 1;
  FileShape surface{node, {}, {}, {}, {}, {}};
  read_surface(cable, surface);
  knows_all_ = true;
  BodyReference ends[2];
  const char* const keys[2] = {"a", "b"};
  for (int side = 0; side < 2; ++side)
    if (cable.find(keys[side])) ends[side] = required_body(cable, keys[side]);
  cable.reject_unknown_keys();
  check_link_names(cable, name, n, before);
  std::vector<Vec3> nodes;
  const auto length_node = cable.find("length");
  const JsonNode& says_length = length_node ? *length_node : node;
  says_length.guard_if_sound(before,
                             [&] { nodes = hanging_chain(from, to, n, length, scene_.world.gravity()); });
  const bool is_held = ends[0].found && ends[1].found && scene_.world.is_fixed(ends[0].id) &&
                       scene_.world.is_fixed(ends[1].id);
  if (n > 1 && is_held) note_no_slack(says_length, span.d, length, scene_.world.gravity());
  // Without it, whatever begins with its name is not known.
  const auto leave_out = [&] { unread_blocks_.push_back({name.empty() ? name : name + "_", {}}); };
  if (problems_.size() != before) return leave_out();

  const double link = length / n;
  const bool by_density = mass->path().ends_with("density");
  const double link_mass = by_density ? amount * std::numbers::pi * radius * radius * link : amount / n;
  node.guard([&] { add_links(node, {name, nodes, link, radius, link_mass, surface, {ends[0], ends[1]}}); });
  if (problems_.size() != before) leave_out();
}

}  // namespace taut
