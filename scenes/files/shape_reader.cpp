#include "scenes/files/shape_reader.h"

#include <cmath>

#include "collision/mesh/mesh_file.h"
#include "core/base/check.h"
#include "scenes/builders/drawing.h"

namespace taut {
namespace {

using Folder = const std::filesystem::path*;

double length(JsonObject& keys, const char* key) { return keys.get_required(key, &JsonNode::positive, 1.0); }
Vec3 lengths(JsonObject& keys, const char* key) {
  return keys.get_required(key, &JsonNode::positive_vector, Vec3(Vec3::Ones()));
}

/// What "file" and "scale" name, instead of the keys of a shape in place; nothing if there is no file.
std::optional<TriangleMesh> read_file(JsonObject& keys, Folder folder,
                                      std::initializer_list<const char*> in_place) {
  if (!folder) return {};
  const auto file = keys.find("file"), scale = keys.find("scale");
  if (!file) {
    if (scale) scale->problem("needs a \"file\"");
    return {};
  }
  const std::size_t before = file->problems().size();
  for (const char* key : in_place)
    if (const auto other = keys.find(key)) other->problem("\"file\" is given as well");
  const std::string name = file->string();
  const double factor = scale ? scale->positive() : 1;
  TriangleMesh mesh;
  if (file->problems().size() == before)
    file->guard([&] {
      const std::filesystem::path path = *folder / name;
      if (std::error_code error; !std::filesystem::exists(path, error))
        if (const std::string nearby = did_you_mean_file(path); !nearby.empty())
          return file->problem("there is no such file" + nearby);
      mesh = read_mesh(path, factor);
    });
  return mesh;
}

Shape read_hull(JsonObject& keys, Folder folder) {
  if (const auto mesh = read_file(keys, folder, {"points"})) return ConvexHull{mesh->vertices};
  return ConvexHull{keys.get_required("points", &JsonNode::vectors, std::vector<Vec3>())};
}

std::array<int, 3> read_triangle(const JsonNode& node) {
  std::array<int, 3> corners{};
  const char* expected = "3 indices of vertices, from 0";
  const std::size_t before = node.problems().size();
  const std::vector<double> numbers = node.numbers(3, expected);
  for (int i = 0; i < 3; ++i) {
    if (numbers[i] >= 0 && numbers[i] <= std::numeric_limits<int>::max() &&
        numbers[i] == std::floor(numbers[i]))
      corners[i] = static_cast<int>(numbers[i]);
    else if (node.problems().size() == before)
      node.problem(std::string("must be ") + expected);
  }
  return corners;
}

Shape read_triangle_mesh(JsonObject& keys, Folder folder) {
  if (auto mesh = read_file(keys, folder, {"vertices", "triangles"})) return std::move(*mesh);
  TriangleMesh mesh;
  mesh.vertices = keys.get_required("vertices", &JsonNode::vectors, std::vector<Vec3>());
  if (const auto triangles = keys.required("triangles"))
    for (const JsonNode& item : triangles->items("an array of triangles"))
      mesh.triangles.push_back(read_triangle(item));
  return mesh;
}

Shape read_height_field(JsonObject& keys) {
  HeightField field;
  field.nx = keys.get_required("nx", &JsonNode::positive_integer, 2);
  field.ny = keys.get_required("ny", &JsonNode::positive_integer, 2);
  field.dx = length(keys, "dx");
  field.dy = length(keys, "dy");
  field.heights = keys.get_required("heights", &JsonNode::numbers, std::vector<double>());
  return field;
}

/// Types of shapes: the one place that knows their keys.  Those with closed forms of mass stand in front.
using ShapeReader = PlacedShape (*)(JsonObject& keys, Folder folder);
constexpr std::pair<const char*, ShapeReader> kShapes[] = {
    {"box", [](JsonObject& k, Folder) { return PlacedShape{Box{lengths(k, "size")}}; }},
    {"sphere", [](JsonObject& k, Folder) { return PlacedShape{Sphere{length(k, "radius")}}; }},
    {"ellipsoid", [](JsonObject& k, Folder) { return PlacedShape{Ellipsoid{lengths(k, "radii")}}; }},
    {"rod",
     [](JsonObject& k, Folder) {
       const double l = length(k, "length");
       return rod_shape(l, length(k, "radius"));
     }},
    {"cylinder",
     [](JsonObject& k, Folder) {
       const double r = length(k, "radius");
       return PlacedShape{Cylinder{r, length(k, "length")}};
     }},
    {"capsule",
     [](JsonObject& k, Folder) {
       const double r = length(k, "radius");
       return PlacedShape{Capsule{r, k.get_required("length", &JsonNode::not_negative, 1.0)}};
     }},
    {"cone",
     [](JsonObject& k, Folder) {
       const double r = length(k, "radius");
       return PlacedShape{Cone{r, length(k, "height")}};
     }},
    {"convex_hull", [](JsonObject& k, Folder folder) { return PlacedShape{read_hull(k, folder)}; }},
    {"triangle_mesh",
     [](JsonObject& k, Folder folder) { return PlacedShape{read_triangle_mesh(k, folder)}; }},
    {"half_space", [](JsonObject&, Folder) { return PlacedShape{HalfSpace{}}; }},
    {"height_field", [](JsonObject& k, Folder) { return PlacedShape{read_height_field(k)}; }},
};
constexpr std::size_t kPrimitives = 7;

std::optional<PlacedShape> read(JsonObject& keys, std::size_t types, Folder folder) {
  const std::size_t before = keys.node().problems().size();
  const auto type = keys.required("type");
  const ShapeReader read_type = type ? type->choice(std::span(kShapes).first(types)) : nullptr;
  if (!read_type || keys.node().problems().size() != before) {
    keys.accept_all_keys();
    return {};
  }
  PlacedShape shape = read_type(keys, folder);
  keys.node().guard_if_sound(before, [&] { check_shape(shape.shape); });
  if (keys.node().problems().size() != before) return {};
  return shape;
}

/// The rod is the cylinder that lies along x.
struct MassOfPrimitive {
  double mass;
  bool along_x;
  MassProperties operator()(const Box& s) const { return MassProperties::box(s.size, mass); }
  MassProperties operator()(const Sphere& s) const { return MassProperties::sphere(s.radius, mass); }
  MassProperties operator()(const Ellipsoid& s) const { return MassProperties::ellipsoid(s.radii, mass); }
  MassProperties operator()(const Cylinder& s) const {
    return along_x ? MassProperties::rod(s.length, s.radius, mass)
                   : MassProperties::cylinder(s.radius, s.length, mass);
  }
  MassProperties operator()(const Capsule& s) const {
    return MassProperties::capsule(s.radius, s.length, mass);
  }
  MassProperties operator()(const Cone& s) const { return MassProperties::cone(s.radius, s.height, mass); }
  template <typename Other>
  MassProperties operator()(const Other& s) const {
    fail("mass of shape", "is no closed form", shape_name(s));
  }
};

}  // namespace

std::optional<PlacedShape> read_shape(JsonObject& keys, Folder folder) {
  return read(keys, std::size(kShapes), folder);
}

std::optional<PlacedShape> read_primitive(JsonObject& keys) { return read(keys, kPrimitives, nullptr); }

MassProperties primitive_mass(const PlacedShape& primitive, double mass) {
  return std::visit(MassOfPrimitive{mass, !primitive.pose.q.vec().isZero(0)}, primitive.shape);
}

Material read_material(const JsonNode& node) {
  const std::size_t before = node.problems().size();
  JsonObject keys(node);
  Material material;
  const auto number = [&](const char* key, double fallback) {
    return keys.get(key, &JsonNode::not_negative, fallback);
  };
  const bool has_static = keys.find("static_friction").has_value();
  material.restitution = keys.get("restitution", &JsonNode::zero_to_one, material.restitution);
  // One of the two alone is both.
  material.dynamic_friction = number("dynamic_friction", material.dynamic_friction);
  material.static_friction = number("static_friction", material.dynamic_friction);
  if (has_static && !keys.find("dynamic_friction")) material.dynamic_friction = material.static_friction;
  material.rolling_friction = number("rolling_friction", material.rolling_friction);
  material.spinning_friction = number("spinning_friction", material.spinning_friction);
  material.rolling_friction_linear = number("rolling_friction_linear", material.rolling_friction_linear);
  material.spinning_friction_linear = number("spinning_friction_linear", material.spinning_friction_linear);
  material.compliance = number("compliance", material.compliance);
  keys.reject_unknown_keys();
  node.guard_if_sound(before, [&] { check_material(material); });
  return node.problems().size() == before ? material : Material{};
}

}  // namespace taut
