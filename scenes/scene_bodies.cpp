#include <functional>
#include <numbers>
#include <sstream>

#include "core/check.h"
#include "scenes/drawing.h"
#include "scenes/scene_reader.h"

namespace taut {
namespace {

/// A shape of uniform density in a file.
struct Uniform {
  double volume;
  std::function<MassProperties(double mass)> mass_properties;
  PlacedShape drawn;
};

double length(JsonObject& shape, const char* key) {
  return shape.get_required(key, &JsonNode::positive, 1.0);
}
Vec3 lengths(JsonObject& shape, const char* key) {
  return shape.get_required(key, &JsonNode::positive_vector, Vec3(Vec3::Ones()));
}

/// Shape types: the one place that knows them.
using ShapeReader = Uniform (*)(JsonObject& shape);
constexpr std::pair<const char*, ShapeReader> kShapes[] = {
    {"box",
     [](JsonObject& s) {
       const Vec3 size = lengths(s, "size");
       return Uniform{
           box_volume(size), [=](double mass) { return MassProperties::box(size, mass); }, {Box{size}}};
     }},
    {"sphere",
     [](JsonObject& s) {
       const double r = length(s, "radius");
       return Uniform{
           sphere_volume(r), [=](double mass) { return MassProperties::sphere(r, mass); }, {Sphere{r}}};
     }},
    {"ellipsoid",
     [](JsonObject& s) {
       const Vec3 radii = lengths(s, "radii");
       return Uniform{ellipsoid_volume(radii),
                      [=](double mass) { return MassProperties::ellipsoid(radii, mass); },
                      {Ellipsoid{radii}}};
     }},
    {"rod",
     [](JsonObject& s) {
       const double l = length(s, "length"), r = length(s, "radius");
       return Uniform{cylinder_volume(r, l), [=](double mass) { return MassProperties::rod(l, r, mass); },
                      rod_shape(l, r)};
     }},
    {"cylinder",
     [](JsonObject& s) {
       const double r = length(s, "radius"), l = length(s, "length");
       return Uniform{cylinder_volume(r, l),
                      [=](double mass) { return MassProperties::cylinder(r, l, mass); },
                      {Cylinder{r, l}}};
     }},
    {"capsule",
     [](JsonObject& s) {
       const double r = length(s, "radius"), l = s.get_required("length", &JsonNode::not_negative, 1.0);
       return Uniform{capsule_volume(r, l),
                      [=](double mass) { return MassProperties::capsule(r, l, mass); },
                      {Capsule{r, l}}};
     }},
    {"cone",
     [](JsonObject& s) {
       const double r = length(s, "radius"), h = length(s, "height");
       return Uniform{
           cone_volume(r, h), [=](double mass) { return MassProperties::cone(r, h, mass); }, {Cone{r, h}}};
     }},
};

std::optional<Uniform> read_shape(const JsonNode& node) {
  const std::size_t before = node.problems().size();
  JsonObject shape(node);
  const auto type = shape.required("type");
  if (!type) return std::nullopt;
  const ShapeReader read = type->choice(kShapes);
  if (node.problems().size() != before) return std::nullopt;
  const Uniform solid = read(shape);
  shape.reject_unknown_keys();
  if (node.problems().size() != before) return std::nullopt;
  return solid;
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

/// mass or density, inertia or shape.  A fixed body needs none of them.
/// @param drawn the shape, if there is one
MassProperties read_mass_properties(JsonObject& body, bool fixed, std::optional<PlacedShape>& drawn) {
  MassProperties result(1, Vec3(1, 1, 1));
  std::optional<JsonNode> mass_node = body.find("mass"), density = body.find("density");
  std::optional<JsonNode> inertia = body.find("inertia"), shape = body.find("shape");
  if (fixed && !mass_node && !density && !inertia && !shape) return result;
  mass_node = body.one_of({"mass", "density"});
  inertia = body.one_of({"inertia", "shape"});

  const std::size_t before = body.node().problems().size();
  double mass = mass_node ? mass_node->positive() : 1;
  if (shape) {
    const auto solid = read_shape(*shape);
    if (density && solid) mass *= solid->volume;
    if (solid && body.node().problems().size() == before)
      shape->guard([&] {
        result = solid->mass_properties(mass);
        drawn = solid->drawn;
      });
  } else {
    if (density && inertia && mass_node->path() == density->path())
      density->problem("needs a shape; give the mass with an inertia");
    if (inertia) read_inertia(*inertia, mass, result);
  }
  return result;
}

Quat read_quaternion(const JsonNode& node) {
  const std::size_t before = node.problems().size();
  const std::vector<double> q = node.numbers(4, "a quaternion of 4 numbers w, x, y, z");
  const double norm = Eigen::Vector4d(q[0], q[1], q[2], q[3]).norm();
  if (std::abs(norm - 1) <= kUnitTolerance) return Quat(q[0], q[1], q[2], q[3]);
  if (node.problems().size() == before) {
    std::ostringstream message;
    message.precision(10);
    message << "must be a quaternion of length 1 to " << kUnitTolerance << ", its length is " << norm;
    node.problem(message.str());
  }
  return Quat::Identity();
}

}  // namespace

Quat read_orientation(const JsonNode& node) {
  if (node.is_array()) return read_quaternion(node);
  if (!node.json().is_object()) {
    node.problem("must be a quaternion [w, x, y, z], an axis with an angle, or roll, pitch and yaw");
    return Quat::Identity();
  }
  constexpr double kDegree = std::numbers::pi / 180;
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

void SceneReader::read_body(const JsonNode& node) {
  const std::size_t before = problems_.size();
  JsonObject body(node);
  BodySpec spec;
  const auto name = body.find("name");
  if (name) spec.name = name->string();
  spec.fixed = body.get("fixed", &JsonNode::boolean, false);
  std::optional<PlacedShape> drawn;
  spec.mass = read_mass_properties(body, spec.fixed, drawn);
  spec.pose.p = body.get("position", &JsonNode::vector, Vec3(Vec3::Zero()));
  if (const auto orientation = body.find("orientation")) spec.pose.q = read_orientation(*orientation);
  spec.twist.v = body.get("velocity", &JsonNode::vector, Vec3(Vec3::Zero()));
  spec.twist.w = body.get("angular_velocity", &JsonNode::vector, Vec3(Vec3::Zero()));
  if (const auto in_body_axes = body.find("angular_velocity_body")) {
    if (body.find("angular_velocity")) in_body_axes->problem("angular_velocity is given as well");
    spec.twist.w = spec.pose.q * in_body_axes->vector();
  }
  body.reject_unknown_keys();
  if (spec.fixed && !(spec.twist.v.isZero(0) && spec.twist.w.isZero(0)))
    node.problem("a fixed body cannot have a velocity");

  if (!spec.name.empty() && scene_.world.has_body(spec.name)) {
    const auto owner = path_of_body_.find(spec.name);
    name->problem("name is already taken by " + (owner != path_of_body_.end() ? owner->second
                                                 : spec.name == "ground"      ? "the ground"
                                                                              : "a generated body"));
    return;
  }
  const bool sound = problems_.size() == before;
  if (!sound) {  // a stand-in of that name
    const std::string own_name = spec.name;
    spec = BodySpec{};
    spec.name = own_name;
  }
  node.guard([&] {
    const BodyId id = scene_.world.add_body(spec);
    path_of_body_[scene_.world.name(id)] = node.path();
    if (!sound) unsound_bodies_.insert(id.index);
    if (drawn) draw(scene_, id, *drawn);
  });
}

}  // namespace taut
