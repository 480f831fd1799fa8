#include "scenes/shape_json.h"

#include "core/check.h"

namespace taut {
namespace {

using Json = nlohmann::json;

Json vectors_to_json(const std::vector<Vec3>& vectors) {
  Json list = Json::array();
  for (const Vec3& v : vectors) list.push_back(vector_to_json(v));
  return list;
}

std::vector<Vec3> vectors_from_json(const Json& json) {
  std::vector<Vec3> vectors;
  for (const Json& item : json) vectors.push_back(vector_from_json(item));
  return vectors;
}

struct ShapeWriter {
  Json& json;
  void operator()(const Sphere& s) const { json["radius"] = s.radius; }
  void operator()(const Box& s) const { json["size"] = vector_to_json(s.size); }
  void operator()(const Capsule& s) const { json["radius"] = s.radius, json["length"] = s.length; }
  void operator()(const Cylinder& s) const { json["radius"] = s.radius, json["length"] = s.length; }
  void operator()(const Ellipsoid& s) const { json["radii"] = vector_to_json(s.radii); }
  void operator()(const Cone& s) const { json["radius"] = s.radius, json["height"] = s.height; }
  void operator()(const ConvexHull& s) const { json["points"] = vectors_to_json(s.points); }
  void operator()(const TriangleMesh& s) const {
    json["vertices"] = vectors_to_json(s.vertices);
    json["triangles"] = s.triangles;
  }
  void operator()(const HalfSpace&) const {}
  void operator()(const HeightField& s) const {
    json["nx"] = s.nx, json["ny"] = s.ny, json["dx"] = s.dx, json["dy"] = s.dy, json["heights"] = s.heights;
  }
};

double number(const Json& json, const char* key) { return json.at(key).get<double>(); }

using ShapeReader = Shape (*)(const Json&);
constexpr std::pair<const char*, ShapeReader> kReaders[] = {
    {"sphere", [](const Json& j) -> Shape { return Sphere{number(j, "radius")}; }},
    {"box", [](const Json& j) -> Shape { return Box{vector_from_json(j.at("size"))}; }},
    {"capsule",
     [](const Json& j) -> Shape {
       return Capsule{number(j, "radius"), number(j, "length")};
     }},
    {"cylinder",
     [](const Json& j) -> Shape {
       return Cylinder{number(j, "radius"), number(j, "length")};
     }},
    {"ellipsoid", [](const Json& j) -> Shape { return Ellipsoid{vector_from_json(j.at("radii"))}; }},
    {"cone",
     [](const Json& j) -> Shape {
       return Cone{number(j, "radius"), number(j, "height")};
     }},
    {"convex_hull", [](const Json& j) -> Shape { return ConvexHull{vectors_from_json(j.at("points"))}; }},
    {"triangle_mesh",
     [](const Json& j) -> Shape {
       return TriangleMesh{vectors_from_json(j.at("vertices")),
                           j.at("triangles").get<std::vector<std::array<int, 3>>>()};
     }},
    {"half_space", [](const Json&) -> Shape { return HalfSpace{}; }},
    {"height_field",
     [](const Json& j) -> Shape {
       return HeightField{j.at("nx").get<int>(), j.at("ny").get<int>(), number(j, "dx"), number(j, "dy"),
                          j.at("heights").get<std::vector<double>>()};
     }},
};

}  // namespace

Json vector_to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Vec3 vector_from_json(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Json shape_to_json(const Shape& shape) {
  Json json{{"type", shape_name(shape)}};
  std::visit(ShapeWriter{json}, shape);
  return json;
}

Shape shape_from_json(const Json& json) {
  const auto type = json.at("type").get<std::string>();
  for (const auto& [name, read] : kReaders)
    if (type == name) {
      Shape shape = read(json);
      check_shape(shape);
      return shape;
    }
  fail("type", "there is no shape of this name", type);
}

}  // namespace taut
