#include <algorithm>
#include <numbers>
#include <sstream>

#include "core/base/check.h"
#include "core/world/solid.h"
#include "scenes/builders/drawing.h"
#include "scenes/files/scene_reader.h"
#include "scenes/files/shape_reader.h"

namespace taut {
namespace {

std::optional<PlacedShape> read_solid(const JsonNode& node) {
  const std::size_t before = node.problems().size();
  JsonObject keys(node);
  const std::optional<PlacedShape> solid = read_primitive(keys);
  keys.reject_unknown_keys();
  return node.problems().size() == before ? solid : std::nullopt;
}

/// 3 principal moments or a 3×3 matrix [kg m²].
void read_inertia(const JsonNode& node, double mass, MassProperties& result) {
  const std::size_t before = node.problems().size();
  const char* expected = "3 principal moments or a 3x3 matrix";
  const bool is_matrix = node.is_array() && !node.json().empty() && node.json()[0].is_array();
  if (!is_matrix) {
    const std::vector<double> moments = node.numbers(3, expected);
    if (node.problems().size() == before)
      node.guard([&] { result = MassProperties(mass, Vec3(moments[0], moments[1], moments[2])); });
    return;
  }
  if (node.json().size() != 3) return node.problem(std::string("must be ") + expected);
  Mat3 inertia;
  int row = 0;
  for (const JsonNode& item : node.items()) inertia.row(row++) = item.vector();
  if (node.problems().size() == before) node.guard([&] { result = MassProperties(mass, inertia); });
}

}  // namespace

/// The mass and its centre from the collision shapes: with one density for all, one for each, or scaled to a
/// mass.
FileMass mass_of_shapes(JsonObject& body, const std::vector<FileShape>& shapes) {
  const std::size_t before = body.node().problems().size();
  const auto mass = body.find("mass"), density = body.find("density");
  const auto with_density = std::count_if(shapes.begin(), shapes.end(),
                                          [](const FileShape& shape) { return shape.density.has_value(); });
  const bool all = with_density == static_cast<long>(shapes.size());
  if (mass || density || !all) body.one_of({"mass", "density"});
  if (mass && with_density > 0 && !all)
    mass->problem("all of the shapes or none of them must have a density");
  const double total = mass ? mass->positive() : 0, common = density ? density->positive() : 1;
  std::vector<PlacedShape> parts;
  for (const FileShape& shape : shapes) {
    parts.push_back(shape.placed);
    if (!shape.density) parts.back().density = common;
    shape.node.guard([&] { (void)solid_properties(shape.placed.shape); });
  }
  FileMass result;
  if (body.node().problems().size() == before)
    body.node().guard([&] {
      const Solid solid = solid_of(parts);
      const double scale = mass ? total / solid.mass.mass() : 1;
      result.properties = MassProperties(scale * solid.mass.mass(), Mat3(scale * solid.mass.inertia_B()));
      result.centre = solid.centre;
    });
  return result;
}

namespace {

/// Of shapes with problems: what is wrong with the amount is a problem of its own.
FileMass unknown_mass(JsonObject& body) {
  const auto mass = body.find("mass"), density = body.find("density");
  if (mass || density) (void)body.one_of({"mass", "density"})->positive();
  return {};
}

/// From a mass or density with an inertia or a solid.
FileMass mass_of_keys(JsonObject& body, const std::optional<JsonNode>& mass_node,
                      const std::optional<JsonNode>& density, const std::optional<JsonNode>& inertia,
                      const std::optional<JsonNode>& shape) {
  FileMass result;
  const std::size_t before = body.node().problems().size();
  double mass = mass_node ? mass_node->positive() : 1;
  if (shape) {
    const auto solid = read_solid(*shape);
    if (solid && body.node().problems().size() == before)
      shape->guard([&] {
        if (density) mass *= solid_properties(solid->shape).volume;
        result.properties = primitive_mass(*solid, mass);
        result.drawn = solid;
      });
  } else {
    if (density && inertia && mass_node->path() == density->path())
      density->problem("needs a shape; give the mass with an inertia");
    if (inertia) read_inertia(*inertia, mass, result.properties);
  }
  return result;
}

}  // namespace

FileMass read_mass(JsonObject& body, bool fixed, const std::vector<FileShape>& shapes) {
  std::optional<JsonNode> mass_node = body.find("mass"), density = body.find("density");
  std::optional<JsonNode> inertia = body.find("inertia"), shape = body.find("shape");
  const bool with_density = std::any_of(shapes.begin(), shapes.end(),
                                        [](const FileShape& each) { return each.density.has_value(); });
  const bool needs_none = fixed && !mass_node && !density && !inertia && !shape && !with_density;
  const auto list = body.find("shapes");
  if (list && !list->json().empty() && !inertia && !shape && !needs_none) {
    const bool sound = shapes.size() == list->json().size();
    return sound ? mass_of_shapes(body, shapes) : unknown_mass(body);
  }
  for (const FileShape& each : shapes)
    if (each.density) each.density->problem("has no effect, since the mass does not come from the shapes");
  if (needs_none) return {};
  mass_node = body.one_of({"mass", "density"});
  inertia = body.one_of({"inertia", "shape"}, {"shapes", "rod", "capsule", "beam"});
  return mass_of_keys(body, mass_node, density, inertia, shape);
}

Quat read_orientation(const JsonNode& node) {
  if (node.is_array()) return node.quaternion();
  if (!node.json().is_object()) {
    node.problem("must be a quaternion [w, x, y, z], an axis with an angle, or roll, pitch and yaw");
    return Quat::Identity();
  }
  if (const nlohmann::json& by_letters = node.json();
      by_letters.size() == 4 &&
      std::ranges::all_of(std::initializer_list<const char*>{"w", "x", "y", "z"}, [&](const char* key) {
        return by_letters.contains(key) && by_letters[key].is_number();
      })) {
    node.problem("a quaternion is a list here, [w, x, y, z]: " +
                 nlohmann::json{by_letters["w"], by_letters["x"], by_letters["y"], by_letters["z"]}.dump());
    return Quat::Identity();
  }
  JsonObject object(node);
  Quat q = Quat::Identity();
  if (object.find("rpy_deg") || object.find("rpy_rad")) {
    // Roll about world x, then pitch about world y, then yaw about world z.
    const auto angles = object.one_of({"rpy_deg", "rpy_rad"});
    const Vec3 rpy = (object.find("rpy_deg") ? kDegree : 1.0) * angles->vector();
    q = exp_so3(rpy.z() * Vec3::UnitZ()) * exp_so3(rpy.y() * Vec3::UnitY()) *
        exp_so3(rpy.x() * Vec3::UnitX());
  } else {
    const Vec3 axis = object.get_required("axis", &JsonNode::unit_vector, Vec3(Vec3::UnitZ()));
    const auto angle = object.one_of({"angle_deg", "angle_rad"});
    if (angle) q = exp_so3((object.find("angle_deg") ? kDegree : 1.0) * angle->number() * axis);
  }
  object.reject_unknown_keys();
  if (q.coeffs().allFinite() && std::abs(q.norm() - 1) <= kUnitTolerance) return q.normalized();
  node.problem("angles are too large to be computed with");
  return Quat::Identity();
}

namespace {

/// By its ends, or as the keys about its mass say.
FileMass mass_of_body(JsonObject& body, bool fixed, const std::optional<BodyByEnds>& ends,
                      const std::vector<FileShape>& shapes) {
  if (!ends) return read_mass(body, fixed, shapes);
  const auto mass = body.find("mass"), density = body.find("density");
  const bool needs_mass = !fixed || mass || density;
  if (!needs_mass) return {};
  return ends->sound ? mass_of_shapes(body, shapes) : unknown_mass(body);
}

/// Of the frame of the file.
struct FilePose {
  Pose pose;
  bool placed = false;    ///< it is known
  bool complete = false;  ///< nothing is left to defaults
};

FilePose read_pose(JsonObject& body, const std::optional<BodyByEnds>& ends) {
  const std::size_t before = body.node().problems().size();
  const auto position = body.find("position"), orientation = body.find("orientation");
  if (ends) return {ends->pose, ends->placed, true};
  FilePose result;
  if (position) result.pose.p = position->vector();
  if (orientation) result.pose.q = read_orientation(*orientation);
  result.placed = body.node().json().is_object() && body.node().problems().size() == before;
  result.complete = position && orientation;
  return result;
}

/// @param q orientation of the body
Twist read_twist(JsonObject& body, const Quat& q) {
  Twist twist;
  twist.v = body.get("velocity", &JsonNode::vector, Vec3(Vec3::Zero()));
  twist.w = body.get(in_angles("angular_velocity"), &JsonNode::vector, Vec3(Vec3::Zero()));
  if (const auto in_body_axes = body.find(in_angles("angular_velocity_body"))) {
    if (body.find(in_angles("angular_velocity"))) in_body_axes->problem("angular_velocity is given as well");
    twist.w = q * in_body_axes->vector();
  }
  return twist;
}

}  // namespace

void SceneReader::read_body(const JsonNode& node) {
  const std::size_t before = problems_.size();
  JsonObject body(node);
  BodySpec spec;
  const auto name = body.find("name");
  if (name) spec.name = name->string();
  spec.fixed = body.get("fixed", &JsonNode::boolean, false);
  const auto shape_list = body.find("shapes");
  const std::optional<BodyByEnds> ends = read_body_by_ends(body);
  std::vector<FileShape> shapes;
  if (ends && ends->sound)
    shapes = {ends->shape};
  else if (shape_list && !ends)
    shapes = read_shapes(*shape_list);
  const FileMass mass = mass_of_body(body, spec.fixed, ends, shapes);
  spec.mass = mass.properties;
  FilePose at = read_pose(body, ends);
  spec.pose = at.pose;
  spec.pose.p += spec.pose.q * mass.centre;
  spec.twist = read_twist(body, spec.pose.q);
  const std::size_t before_keys = problems_.size();
  body.reject_unknown_keys();
  if (problems_.size() != before_keys && !at.complete) at.placed = false;  // one may be misspelt
  if (spec.fixed && !(spec.twist.v.isZero(0) && spec.twist.w.isZero(0)))
    node.problem("a fixed body cannot have a velocity");

  if (!spec.name.empty() && scene_.world.has_body(spec.name)) return refuse_name(*name);
  enter_body(node, std::move(spec), mass, shapes, at.placed, problems_.size() == before);
}

/// One that is not sound has a stand-in of its name, where it is.
void SceneReader::enter_body(const JsonNode& node, BodySpec spec, const FileMass& mass,
                             const std::vector<FileShape>& shapes, bool placed, bool sound) {
  if (!sound) {
    spec.mass = FileMass().properties;
    spec.twist = {};
    if (!placed) spec.pose = {};
  }
  node.guard([&] {
    const BodyId id = scene_.world.add_body(spec);
    path_of_body_[scene_.world.name(id)] = node.path();
    if (!placed) unplaced_bodies_.insert(id.index);
    if (!mass.centre.isZero(0)) centre_of_body_[id.index] = mass.centre;
    if (!sound) {
      unshaped_bodies_.insert(id.index);
      return;
    }
    if (mass.drawn && shapes.empty()) {
      draw(scene_, id, *mass.drawn);
      if (!spec.fixed && !node.json().contains("shapes")) untouchable_.push_back(node);
    }
    add_shapes(id, shapes, mass.centre);
  });
}

/// For a body whose name another one has.  Which of them is meant elsewhere is not known.
void SceneReader::refuse_name(const JsonNode& name) {
  const std::string text = name.string();
  const auto owner = path_of_body_.find(text);
  name.problem("name is already taken by " + (owner != path_of_body_.end() ? owner->second
                                              : text == "ground"           ? "the ground"
                                                                           : "a generated body"));
  const int other = scene_.world.body(text).index;
  if (other != kGround.index) unplaced_bodies_.insert(other), unshaped_bodies_.insert(other);
  misses_body_ = true;
}

}  // namespace taut
