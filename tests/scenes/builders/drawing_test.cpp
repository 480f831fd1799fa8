#include "scenes/builders/drawing.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <set>

#include "core/world/solid.h"
#include "scenes/export/shape_mesh.h"
#include "scenes/files/scene_file.h"
#include "scenes/files/shape_json.h"
#include "scenes/recording/drawn_shapes.h"
#include "tests/temporary.h"

namespace taut::testing::drawing_test {
namespace {

const std::vector<Shape>& closed_shapes() {
  static const std::vector<Shape> shapes{
      Sphere{0.5},
      Box{{1, 2, 3}},
      Capsule{0.3, 1.1},
      Capsule{0.3, 0},
      Cylinder{0.4, 1.5},
      Ellipsoid{{0.3, 0.6, 1}},
      Cone{0.5, 1.2},
      ConvexHull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.9, 0.9, 0.9}}},
      TriangleMesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                   {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}},
  };
  return shapes;
}

double mesh_volume(const DrawingMesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c]));
  return six / 6;
}

// Volume by the divergence theorem is right only if the surface is closed and faces outwards.
TEST(DrawingMesh, EnclosesTheVolumeOfTheShape) {
  for (const Shape& shape : closed_shapes()) {
    const double exact = solid_properties(shape).volume;
    const double coarse = mesh_volume(drawing_mesh(shape, 16)), fine = mesh_volume(drawing_mesh(shape, 64));
    EXPECT_NEAR(fine / exact, 1, 0.01) << shape_name(shape);  // inscribed: 1 − O(segments⁻²)
    EXPECT_LE(std::abs(fine - exact), std::abs(coarse - exact) + 1e-12) << shape_name(shape);
  }
}

TEST(DrawingMesh, NormalsPointOutwardsFromEachTriangle) {
  for (const Shape& shape : closed_shapes()) {
    const DrawingMesh mesh = drawing_mesh(shape, 24);
    ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
    for (const Vec3& normal : mesh.normals) EXPECT_NEAR(normal.norm(), 1, 1e-12);
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 face =
          (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).normalized();
      for (const int corner : {a, b, c}) EXPECT_GT(face.dot(mesh.normals[corner]), 0.5) << shape_name(shape);
    }
  }
}

TEST(DrawingMesh, HeightFieldHasItsHeights) {
  const HeightField field{2, 3, 0.5, 2, {0, 1, 2, 3, 4, 5}};
  const DrawingMesh mesh = drawing_mesh(field);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  for (const Vec3& v : mesh.vertices) {
    const int i = static_cast<int>(std::lround(v.x() / 0.5 + 0.5)),
              j = static_cast<int>(std::lround(v.y() / 2 + 1));
    EXPECT_EQ(v.z(), field.heights[i + 2 * j]);
  }
}

TEST(ShapeJson, GivesBackEveryShape) {
  std::vector<Shape> shapes = closed_shapes();
  shapes.push_back(HalfSpace{});
  shapes.push_back(HeightField{2, 2, 1, 1, {0, 1, 2, 3}});
  std::set<std::string> types;
  for (const Shape& shape : shapes) {
    const auto json = shape_to_json(shape);
    types.insert(json["type"]);
    EXPECT_EQ(shape_to_json(shape_from_json(json)), json);
    EXPECT_EQ(shape_from_json(json).index(), shape.index());
  }
  EXPECT_EQ(types.size(), std::variant_size_v<Shape>);
  EXPECT_THROW(shape_from_json({{"type", "torus"}}), std::invalid_argument);
  EXPECT_THROW(shape_from_json({{"type", "sphere"}, {"radius", -1}}), std::invalid_argument);
}

std::map<std::string, int> shapes_of(const Scene& scene) {
  RecordingHeader header;
  collect_shapes(scene, header);
  std::map<std::string, int> count;
  for (const DrawnShape& drawn : header.drawn) ++count[shape_name(header.shapes[drawn.shape])];
  return count;
}

TEST(Drawing, BuildersDrawRodsPlanksAndSpheres) {
  using Count = std::map<std::string, int>;
  EXPECT_EQ(shapes_of(build_scene("chain-heavy", {{"n", 7}})), (Count{{"cylinder", 7}, {"sphere", 1}}));
  EXPECT_EQ(shapes_of(build_scene("net-corners", {{"n", 4}})), (Count{{"cylinder", 24}}));
  EXPECT_EQ(shapes_of(build_scene("joint-grid", {{"n", 3}})), (Count{{"sphere", 9}}));
  EXPECT_EQ(shapes_of(build_scene("bridge-hinge", {{"n", 5}})), (Count{{"box", 5}}));
  EXPECT_EQ(shapes_of(build_scene("bridge-hinge", {{"n", 5}, {"truck", 1}}))["cylinder"], 6);  // wheels
  EXPECT_EQ(build_scene("joint-grid", {{"n", 3}}).world.shape_count(), 0)
      << "drawing must not make bodies collide";
  for (const SceneInfo& info : scene_catalogue()) {
    if (!info.parameters.empty() && info.parameters[0].default_value > 50) continue;  // large
    const Scene scene = build_scene(info.name);
    EXPECT_FALSE(scene.drawings.empty() && scene.world.shape_count() == 0) << info.name;
  }
}

// Rods end where their joints are.
TEST(Drawing, DrawnRodsReachFromJointToJoint) {
  const Scene scene = build_scene("chain", {{"n", 3}});
  RecordingHeader header;
  collect_shapes(scene, header);
  ASSERT_EQ(header.shapes.size(), 1u);  // equal ones are listed once
  const Cylinder& rod = std::get<Cylinder>(header.shapes[0]);
  for (const DrawnShape& drawn : header.drawn) {
    const Vec3 end = scene.world.pose(drawn.body).point(drawn.pose.point({0, 0, rod.length / 2}));
    EXPECT_NEAR(end.x(), 0.1 * drawn.body.index, 1e-15);
    EXPECT_NEAR(end.z(), 0, 1e-15);
  }
}

TEST(Drawing, SceneFilesAndCollisionShapesAndInertia) {
  const std::string file = temporary("drawn.json");
  write_text(file, R"({"format": "taut-scene/1", "bodies": [
    {"name": "rod", "mass": 1, "shape": {"type": "rod", "length": 2, "radius": 0.1}},
    {"name": "inertia", "mass": 3, "inertia": [[2, 0.3, 0], [0.3, 2.5, 0], [0, 0, 3]]},
    {"name": "post", "fixed": true}]})");
  Scene scene = load_scene_file(file);
  EXPECT_EQ(shapes_of(scene), (std::map<std::string, int>{{"cylinder", 1}, {"ellipsoid", 1}}));

  // The ellipsoid has the inertia of its body.
  RecordingHeader header;
  collect_shapes(scene, header);
  const DrawnShape& drawn = header.drawn[1];
  const Ellipsoid& ellipsoid = std::get<Ellipsoid>(header.shapes[drawn.shape]);
  const Mat3 R = drawn.pose.q.toRotationMatrix();
  const Mat3 inertia = R * MassProperties::ellipsoid(ellipsoid.radii, 3.0).inertia_B() * R.transpose();
  EXPECT_LT((inertia - scene.world.mass_properties(drawn.body).inertia_B()).norm(), 1e-12);

  scene.world.add_shape(scene.world.body("post"), Box{{1, 1, 1}});
  scene.world.add_shape(scene.world.body("rod"), Box{{1, 1, 1}});  // its drawing comes first
  EXPECT_EQ(shapes_of(scene), (std::map<std::string, int>{{"box", 1}, {"cylinder", 1}, {"ellipsoid", 1}}));
  EXPECT_THROW(draw(scene, BodyId{99}, {Sphere{1}}), std::invalid_argument);
  EXPECT_THROW(draw(scene, BodyId{1}, {Sphere{0}}), std::invalid_argument);
}

}  // namespace
}  // namespace taut::testing::drawing_test
