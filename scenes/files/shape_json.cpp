#include "scenes/files/shape_json.h"

#include "core/base/check.h"
#include "scenes/files/shape_reader.h"

namespace taut {
namespace {

using Json = nlohmann::json;

Json vectors_to_json(const std::vector<Vec3>& vectors) {
  Json list = Json::array();
  for (const Vec3& v : vectors) list.push_back(vector_to_json(v));
  return list;
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
  Problems problems;
  JsonObject keys(JsonNode(json, "/shape", problems));
  const std::optional<PlacedShape> shape = read_shape(keys);
  if (!problems.empty()) fail(problems[0].path, problems[0].message, problems[0].value);
  return shape->shape;
}

}  // namespace taut
