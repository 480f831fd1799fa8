#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "core/world/solid.h"
#include "scenes/builders/drawing.h"
#include "scenes/files/scene_file.h"
#include "scenes/recording/drawn_shapes.h"
#include "solvers/simulator/simulator.h"
#include "tests/scenes/files/scene_file_cases.h"
#include "tests/source_dir.h"
#include "tests/temporary.h"

/// Contact geometry of scene files, and bodies whose mass comes from it.
namespace taut::scene_shapes_test {
namespace {

using namespace scene_file_cases;

World world_of(const std::string& keys) {
  return parse_scene(R"({"format": "taut-scene/1", )" + keys + "}", "test.json").world;
}
std::vector<ShapeId> shapes_of(const World& world, const char* body) {
  std::vector<ShapeId> shapes;
  for (int s = 0; s < world.shape_count(); ++s)
    if (world.shape(ShapeId{s}).body == world.body(body)) shapes.push_back({s});
  return shapes;
}

TEST(SceneShapes, AreThoseOfTheFile) {
  const World world = parse_scene(kEverything, "test.json").world;
  const std::vector<ShapeId> shapes = shapes_of(world, "shapes"), ground = shapes_of(world, "ground");
  const char* const names[] = {"box",     "sphere", "ellipsoid",   "cylinder",     "cylinder",
                               "capsule", "cone",   "convex_hull", "triangle_mesh"};
  ASSERT_EQ(shapes.size(), std::size(names));
  for (std::size_t i = 0; i < shapes.size(); ++i)
    EXPECT_STREQ(shape_name(*world.shape(shapes[i]).shape), names[i]);
  const auto shape = [&](int i) { return *world.shape(shapes[i]).shape; };
  EXPECT_EQ(std::get<Box>(shape(0)).size, Vec3(1, 1, 1));
  EXPECT_EQ(std::get<Sphere>(shape(1)).radius, 0.5);
  EXPECT_EQ(std::get<Ellipsoid>(shape(2)).radii, Vec3(1, 2, 3));
  EXPECT_EQ(std::get<Cylinder>(shape(4)).length, 2);
  EXPECT_EQ(std::get<Capsule>(shape(5)).radius, 0.1);
  EXPECT_EQ(std::get<Cone>(shape(6)).height, 2);
  EXPECT_EQ(std::get<ConvexHull>(shape(7)).points.size(), 5U);
  EXPECT_EQ(std::get<TriangleMesh>(shape(8)).triangles[3], (std::array<int, 3>{1, 2, 3}));
  // The rod lies along x, and its orientation turns it to y.
  EXPECT_TRUE((world.shape(shapes[3]).pose.q * Vec3::UnitZ()).isApprox(Vec3(Vec3::UnitY()), 1e-15));
  ASSERT_EQ(ground.size(), 2U);
  const auto field = std::get<HeightField>(*world.shape(ground[1]).shape);
  EXPECT_EQ(field.ny, 3);
  EXPECT_EQ(field.heights[5], 0.3);
  EXPECT_EQ(world.shape(ground[0]).filter.groups, 0x80000002U);
  EXPECT_EQ(world.shape(ground[0]).filter.mask, 1U);
  EXPECT_EQ(world.shape(ground[1]).filter.groups, 1U);
  EXPECT_EQ(world.shape(ground[1]).filter.mask, 0xffffffffU);
}

TEST(SceneShapes, HaveTheirMaterials) {
  const World world = parse_scene(kEverything, "test.json").world;
  const std::vector<ShapeId> shapes = shapes_of(world, "shapes"), ground = shapes_of(world, "ground");
  const Material ice{.static_friction = 0.05, .dynamic_friction = 0.03};
  const Material rubber{.restitution = 0.7,
                        .static_friction = 0.9,
                        .dynamic_friction = 0.9,
                        .rolling_friction = 0.001,
                        .spinning_friction = 0.002,
                        .compliance = 1e-6,
                        .rolling_friction_linear = 0.003,
                        .spinning_friction_linear = 0.004};
  EXPECT_EQ(world.shape(ground[0]).material, ice);
  EXPECT_EQ(world.shape(shapes[0]).material, rubber);
  EXPECT_EQ(world.shape(shapes[1]).material, (Material{.static_friction = 0.7, .dynamic_friction = 0.7}));
  EXPECT_EQ(world.shape(shapes[2]).material, Material{});
  // One pair of shapes, not the others of the same bodies.
  EXPECT_EQ(world.contact_material(shapes[0], ground[1]), ice);
  EXPECT_EQ(world.contact_material(shapes[1], ground[1]),
            combined(world.shape(shapes[1]).material, Material{}));
  EXPECT_EQ(world.contact_material(shapes_of(world, "given")[0], shapes_of(world, "plate")[0]).restitution,
            0.5);
  EXPECT_FALSE(world.may_collide(world.body("given"), world.body("plate")));
  EXPECT_TRUE(world.may_collide(world.body("given"), world.body("shapes")));
  EXPECT_TRUE(world.may_collide(world.body("rod"), world.body("cone")));     // in spite of their joints
  EXPECT_FALSE(world.may_collide(world.body("rod"), world.body("sphere")));  // because of one
}

/// A cube of 1 m at x = 0 and one of twice the density at x = 3, turned by 90° about z: m = 3 ρ, the centre
/// at x = 2 of the shapes' frame, about it I_xx = 3 ρ/6, I_yy = 3 ρ/6 + ρ 2² + 2 ρ 1².
TEST(SceneShapes, GiveMassAndItsCentre) {
  const std::string text = R"("bodies": [{"name": "bar", "density": 100, "position": [10, 0, 0],
      "orientation": {"axis": [0, 0, 1], "angle_deg": 90}, "shapes": [
        {"type": "box", "size": [1, 1, 1]},
        {"type": "box", "size": [1, 1, 1], "density": 200, "position": [3, 0, 0]}]},
      {"name": "fixed", "fixed": true, "position": [0, 0, 5], "shapes": [
        {"type": "sphere", "radius": 1, "position": [1, 0, 0]}]},
      {"name": "scaled", "mass": 30, "shapes": [{"type": "box", "size": [1, 1, 1], "position": [0, 0, 1]}]},
      {"name": "own", "shapes": [{"type": "box", "size": [1, 1, 1], "density": 7}]}],
    "joints": [{"name": "pin", "type": "ball", "a": "ground", "b": "bar", "frame": "body",
                "anchor_a": [10, 3, 0], "anchor_b": [3, 0, 0]}],
    "forces": [{"type": "point-force", "body": "bar", "point": [3, 0, 0], "force": [0, 0, 1]},
               {"type": "spring-damper", "a": "ground", "b": "bar", "frame": "body", "anchor_a": [10, 0, 1],
                "anchor_b": [0, 0, 0], "stiffness": 10, "rest_length": 0}],
    "gravity": [0, 0, 0],
    "probes": [{"name": "end", "quantity": "position", "body": "bar", "point": [3, 0, 0]},
               {"name": "centre", "quantity": "position", "body": "bar"}])";
  const Scene scene = parse_scene(R"({"format": "taut-scene/1", )" + text + "}", "test.json");
  const World& world = scene.world;
  const BodyId bar = world.body("bar");
  const MassProperties& mass = world.mass_properties(bar);
  // 1e-12: round-off of a few products of numbers up to 1000.
  EXPECT_NEAR(mass.mass(), 300, 1e-12);
  EXPECT_TRUE(mass.inertia_B().isApprox(Mat3(Vec3(50, 650, 650).asDiagonal()), 1e-14)) << mass.inertia_B();
  EXPECT_TRUE(world.pose(bar).p.isApprox(Vec3(10, 2, 0), 1e-14));
  const std::vector<ShapeId> shapes = shapes_of(world, "bar");
  EXPECT_TRUE(world.shape(shapes[0]).pose.p.isApprox(Vec3(-2, 0, 0), 1e-14));
  EXPECT_TRUE(world.shape(shapes[1]).pose.p.isApprox(Vec3(1, 0, 0), 1e-14));
  // Points of the file are in the frame of the shapes: the joint, the force, the spring and the probe.
  EXPECT_TRUE(world.validate(1e-12).empty());
  EXPECT_TRUE(scene.probes[0].point_B.isApprox(Vec3(1, 0, 0), 1e-14));
  EXPECT_EQ(scene.probes[1].point_B, Vec3(0, 0, 0));
  std::vector<Wrench> on(world.body_count());
  world.forces(world.state(), on);
  EXPECT_TRUE(on[bar.index].force.isApprox(Vec3(0, 0, 1 + 10), 1e-12));
  EXPECT_TRUE(on[bar.index].torque.isApprox(Vec3(1 * 1 - 2 * 10, 0, 0), 1e-12));

  EXPECT_EQ(world.pose(world.body("fixed")).p, Vec3(0, 0, 5));  // no mass, no shift
  EXPECT_EQ(world.shape(shapes_of(world, "fixed")[0]).pose.p, Vec3(1, 0, 0));
  EXPECT_NEAR(world.mass_properties(world.body("scaled")).mass(), 30, 1e-13);
  EXPECT_NEAR(world.mass_properties(world.body("scaled")).inertia_B()(0, 0), 5, 1e-13);
  EXPECT_EQ(world.pose(world.body("scaled")).p, Vec3(0, 0, 1));
  EXPECT_NEAR(world.mass_properties(world.body("own")).mass(), 7, 1e-14);
}

/// A driver moves the frames of the file, not the centres of mass: B's frame turns about its own origin, and
/// its centre of mass goes round.
TEST(SceneShapes, DriversMoveTheFrameOfTheFile) {
  const Scene scene = parse_scene(R"({"format": "taut-scene/1", "gravity": [0, 0, 0], "bodies": [
      {"name": "arm", "density": 1, "position": [1, 2, 3], "velocity": [0, 2, 0], "angular_velocity": [0, 0, 2],
       "shapes": [{"type": "box", "size": [2, 0.1, 0.1], "position": [1, 0, 0]}]}],
      "joints": [{"name": "drive", "type": "pose_driver", "a": "ground", "b": "arm",
                  "turns": [{"axis": [0, 0, 1], "angle": {"linear": {"rate": 2}}}]}]})",
                                  "test.json");
  World world = scene.world;
  const BodyId arm = world.body("arm");
  EXPECT_EQ(world.pose(arm).p, Vec3(2, 2, 3));
  Simulator simulator(world);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(0.01).exact()) << simulator.report().message;
  // 1e-9: the solver's tolerance.
  EXPECT_LT((world.pose(arm).p - Vec3(1 + std::cos(2), 2 + std::sin(2), 3)).norm(), 1e-9);
}

class MeshFiles : public ::testing::Test {
 protected:
  MeshFiles() {
    std::filesystem::create_directories(folder_ / "meshes");
    std::ofstream(folder_ / "meshes" / "corner.obj")
        << "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    std::ofstream(folder_ / "meshes" / "broken.stl") << "solid nonsense\n facet normal 1 2\n";
  }
  Scene scene(const std::string& shape) const {
    std::ofstream(folder_ / "scene.json")
        << R"({"format": "taut-scene/1", "bodies": [{"name": "b", "density": 6,
        "shapes": [)"
        << shape << "]}]}";
    return load_scene_file(folder_ / "scene.json");
  }
  std::vector<SceneFileProblem> problems(const std::string& shape) const {
    try {
      scene(shape);
    } catch (const SceneFileError& error) {
      return error.problems();
    }
    return {};
  }
  const std::filesystem::path folder_ = testing::temporary("mesh_files");
};

/// A tetrahedron of legs 1 after scaling: V = 1/6, centre (1, 1, 1)/4.
TEST_F(MeshFiles, AreRelativeToTheScene) {
  for (const char* type : {"triangle_mesh", "convex_hull"}) {
    const World world =
        scene(std::string(R"({"file": "meshes/corner.obj", "scale": 0.5, "type": ")") + type + "\"}").world;
    EXPECT_STREQ(shape_name(*world.shape(ShapeId{0}).shape), type);
    EXPECT_NEAR(world.mass_properties(BodyId{1}).mass(), 1, 1e-14);
    EXPECT_TRUE(world.pose(BodyId{1}).p.isApprox(Vec3(0.25, 0.25, 0.25), 1e-14));
  }
}

TEST_F(MeshFiles, ThatAreBadAreNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {R"({"type": "triangle_mesh", "file": "meshes/none.obj"})", "there is no such file"},
      {R"({"type": "triangle_mesh", "file": "meshes"})", "must be .obj or .stl"},
      {R"({"type": "convex_hull", "file": "meshes/broken.stl"})", "broken.stl"}};
  for (const auto& [shape, message] : cases) {
    const auto found = problems(shape);
    ASSERT_EQ(found.size(), 1U) << shape;
    EXPECT_EQ(found[0].path, "/bodies/0/shapes/0/file");
    EXPECT_NE(found[0].message.find(message), std::string::npos) << found[0].message;
  }
}

/// Bodies of a file are drawn by their shapes, the ground too.
TEST(SceneShapes, AreDrawn) {
  const Scene scene = parse_scene(kEverything, "test.json");
  RecordingHeader header;
  collect_shapes(scene, header);
  const auto drawn_on = [&](const char* body) {
    return std::count_if(header.drawn.begin(), header.drawn.end(),
                         [&](const auto& drawn) { return drawn.body == scene.world.body(body); });
  };
  EXPECT_EQ(drawn_on("shapes"), 9);
  EXPECT_EQ(drawn_on("ground"), 2);
  EXPECT_EQ(drawn_on("plate"), 1);
  EXPECT_EQ(drawn_on("box"), 1);  // "shape": it is drawn but does not collide
  EXPECT_TRUE(shapes_of(scene.world, "box").empty());
}

/// A cube of 0.1 m of material `cube` on a plane of material `floor`, both turned by `alpha` about y.
std::string cube_on_slope(double alpha, const std::string& more) {
  const std::string turned =
      R"("orientation": {"axis": [0, 1, 0], "angle_rad": )" + std::to_string(alpha) + "}";
  return R"("ground": {"shapes": [{"type": "half_space", "material": "floor", )" + turned + R"(}]},
          "bodies": [{"name": "cube", "density": 500, )" +
         turned + R"(, "shapes": [{"type": "box", "size": [0.1, 0.1, 0.1], "position": [0, 0, 0.05],
             "material": "cube"}]}], )" +
         more;
}

/// Its way in 0.5 s on a slope of atan 0.6 with friction μ: none for μ ≥ 0.6, else a = g (sin α − μ cos α).
void slides_as_with(double mu, const std::string& materials) {
  const double alpha = std::atan(0.6), dt = 0.01, g = 9.81;
  World world = world_of(cube_on_slope(alpha, materials));
  const Vec3 start = world.pose(world.body("cube")).p;
  Simulator simulator(world);
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(simulator.step(dt).exact()) << simulator.report().message;
  const double t = 50 * dt, a = std::max(0.0, g * (std::sin(alpha) - mu * std::cos(alpha)));
  // 1 %: the start of sliding is resolved to one step of fifty; 1e-6 of the angle in the text.
  EXPECT_NEAR((world.pose(world.body("cube")).p - start).norm(), 0.5 * a * t * t,
              0.01 * 0.5 * a * t * t + 1e-5)
      << materials;
}

TEST(SceneShapes, FrictionOfTheFileActs) {
  slides_as_with(0.7,
                 R"("materials": {"cube": {"static_friction": 0.7}, "floor": {"static_friction": 0.7}})");
  slides_as_with(0.5,
                 R"("materials": {"cube": {"static_friction": 0.5}, "floor": {"static_friction": 0.5}})");
}

/// What holds between two named materials wins over what they are, in either order of the names, and one of
/// the two bodies over both.
TEST(SceneShapes, FrictionOfPairsOfMaterialsActs) {
  const std::string
      rough = R"("materials": {"cube": {"static_friction": 0.9}, "floor": {"static_friction": 0.9}}, )",
      smooth = R"("materials": {"cube": {"static_friction": 0.2}, "floor": {"static_friction": 0.2}}, )";
  slides_as_with(
      0.4,
      rough + R"("material_pairs": [{"a": "cube", "b": "floor", "material": {"static_friction": 0.4}}])");
  slides_as_with(
      0.7,
      smooth + R"("material_pairs": [{"a": "floor", "b": "cube", "material": {"static_friction": 0.7}}])");
  slides_as_with(
      0.3, rough + R"("material_pairs": [{"a": "cube", "b": "floor", "material": {"static_friction": 0.8}}],
      "pairs": [{"a": "cube", "b": "ground", "material": {"static_friction": 0.3}}])");
  // A material with itself is a pair like any other, and none of two different ones.
  slides_as_with(
      0.9, rough + R"("material_pairs": [{"a": "cube", "b": "cube", "material": {"static_friction": 0.1}}])");
}

/// The shipped scene with contact, up to where the steel marble has left the funnel, a mesh from a file, and
/// lies on the ramp, a compound: it touches the floor between the walls, and energy is only lost.
TEST(ShippedScenes, MarblesFallThroughTheFunnelOntoTheRamp) {
  Scene scene = load_scene_file(testing::source_dir() + "/scenes/examples/marble_run.json");
  const BodyId marble = scene.world.body("steel marble");
  Simulator simulator(scene.world, scene.settings);
  double energy = 1e9;
  for (int i = 0; i < 250; ++i) {
    ASSERT_TRUE(simulator.step(scene.dt).exact()) << simulator.report().message;
    // 1e-5 J of about 0.6 J: at impacts the order of the method is lost for a step.
    EXPECT_LT(simulator.report().energy(), energy + 1e-5) << i;
    energy = simulator.report().energy();
  }
  const Vec3 p = scene.world.pose(scene.world.body("ramp")).local(scene.world.pose(marble).p);
  EXPECT_LT(std::abs(p.x()), 0.2);
  EXPECT_LT(std::abs(p.y()), 0.04 - 0.012 + 1e-3);
  // Radius 12 mm above the floor's upper side at 5 mm, up to the contact margin of 2 mm and a small bounce.
  EXPECT_GT(p.z(), 0.017 - 1e-4);
  EXPECT_LT(p.z(), 0.017 + 5e-3);
}

}  // namespace
}  // namespace taut::scene_shapes_test
