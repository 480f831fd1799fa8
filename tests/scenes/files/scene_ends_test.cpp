#include <gtest/gtest.h>

#include <numbers>

#include "core/joints/joints.h"
#include "core/world/diagnostics.h"
#include "scenes/builders/hanging_chain.h"
#include "scenes/files/scene_file.h"
#include "solvers/simulator/simulator.h"

/// Bodies that are given by their ends, and cables.
namespace taut::scene_ends_test {
namespace {

Scene scene_of(const std::string& members) {
  return parse_scene(R"({"format": "taut-scene/1", )" + members + "}", "test.json");
}

/// The inertia in the world about the centre of mass.
Mat3 inertia_W(const World& world, BodyId body) {
  const Mat3 R = world.pose(body).q.toRotationMatrix();
  return R * world.mass_properties(body).inertia_B() * R.transpose();
}

TEST(SceneEnds, ARodIsTheOneWithPositionAndOrientation) {
  const Scene scene = scene_of(R"("bodies": [
    {"name": "by ends", "density": 500, "rod": {"from": [1, 2, 3], "to": [1, 5, 7], "radius": 0.1}},
    {"name": "placed", "density": 500, "shapes": [{"type": "rod", "length": 5, "radius": 0.1}], "position": [1, 3.5, 5],
     "orientation": {"axis": [0, -0.8, 0.6], "angle_deg": 90}}])");
  const World& world = scene.world;
  const BodyId one = world.body("by ends"), other = world.body("placed");
  EXPECT_TRUE(world.pose(one).p.isApprox(Vec3(1, 3.5, 5), 1e-15));
  EXPECT_TRUE((world.pose(one).q * Vec3::UnitX()).isApprox(Vec3(0, 0.6, 0.8), 1e-15));
  EXPECT_TRUE(
      (world.pose(other).q * Vec3::UnitX()).isApprox(Vec3(0, 0.6, 0.8), 1e-15));  // of the test itself
  EXPECT_NEAR(world.mass_properties(one).mass(), 500 * std::numbers::pi * 0.01 * 5, 1e-10);
  EXPECT_TRUE(inertia_W(world, one).isApprox(inertia_W(world, other), 1e-13));
  ASSERT_EQ(world.shape_count(), 2);
  const ShapeRecord& shape = world.shape(ShapeId{0});
  EXPECT_EQ(std::get<Cylinder>(*shape.shape).length, 5);
  EXPECT_TRUE((shape.pose.q * Vec3::UnitZ()).cross(Vec3::UnitX()).isZero(1e-15));
}

TEST(SceneEnds, CapsulesHaveTheirCapsBeyondTheEnds) {
  const Scene scene =
      scene_of(R"("bodies": [{"mass": 3, "capsule": {"from": [0, 0, 0], "to": [0, 0, -2], "radius": 0.5}}])");
  const World& world = scene.world;
  EXPECT_NEAR(world.mass_properties(BodyId{1}).mass(), 3, 1e-14);
  EXPECT_TRUE(inertia_W(world, BodyId{1}).isApprox(MassProperties::capsule(0.5, 2, 3).inertia_B(), 1e-13));
  EXPECT_EQ(std::get<Capsule>(*world.shape(ShapeId{0}).shape).length, 2);
}

/// x along the beam, y level, z up; with "up" as that says.
TEST(SceneEnds, BeamsStandUpright) {
  const auto axes = [](const std::string& keys) {
    const Scene scene =
        scene_of(R"("bodies": [{"density": 1, "beam": {"from": [0, 0, 0], "width": 0.1, "height": 0.3, )" +
                 keys + "}}]");
    const Box& box = std::get<Box>(*scene.world.shape(ShapeId{0}).shape);
    EXPECT_TRUE(box.size.isApprox(Vec3(2, 0.1, 0.3), 1e-15)) << keys;
    return scene.world.pose(BodyId{1}).q.toRotationMatrix();
  };
  Mat3 expected = Mat3::Identity();
  EXPECT_TRUE(axes(R"("to": [2, 0, 0])").isApprox(expected, 1e-15));
  expected.col(0) = Vec3(0, 1.2, 1.6) / 2;
  expected.col(1) = Vec3(-1, 0, 0);
  expected.col(2) = expected.col(0).cross(expected.col(1));
  EXPECT_GT(expected(2, 2), 0);
  EXPECT_TRUE(axes(R"("to": [0, 1.2, 1.6])").isApprox(expected, 1e-15));
  EXPECT_TRUE(axes(R"("to": [2, 0, 0], "up": [0, 1, 0])").col(2).isApprox(Vec3::UnitY(), 1e-15));
  const Mat3 upright = axes(R"("to": [0, 0, 2])");  // some frame
  EXPECT_TRUE((upright.transpose() * upright).isIdentity(1e-14));
  EXPECT_TRUE(upright.col(0).isApprox(Vec3::UnitZ(), 1e-15));
}

TEST(SceneEnds, FixedBodiesNeedNoMass) {
  const Scene scene = scene_of(
      R"("bodies": [{"name": "post", "fixed": true, "rod": {"from": [0, 0, 0], "to": [0, 0, 2], "radius": 0.1}}])");
  EXPECT_TRUE(scene.world.is_fixed(BodyId{1}));
  EXPECT_EQ(scene.world.shape_count(), 1);
}

/// Joints meet the ends where they are.
TEST(SceneEnds, JointsCloseAtTheEnds) {
  const Scene scene = scene_of(R"("bodies": [
    {"name": "a", "density": 500, "rod": {"from": [0, 0, 0], "to": [1, 0, 0.3], "radius": 0.01}},
    {"name": "b", "density": 500, "beam": {"from": [1, 0, 0.3], "to": [2, 1, 0], "width": 0.01, "height": 0.02}}],
    "joints": [{"type": "hinge", "a": "ground", "b": "a", "anchor": [0, 0, 0], "axis": [0, 1, 0]},
               {"type": "ball", "a": "a", "b": "b", "frame": "body", "anchor_a": [0.522015325446, 0, 0],
                "anchor_b": [-0.722841614740, 0, 0]}])");
  EXPECT_EQ(scene.world.joint_count(), 2);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(SceneEnds, ACableIsAChainOfNamedLinks) {
  const Scene scene =
      scene_of(R"("bodies": [{"name": "hook", "mass": 1, "inertia": [1, 1, 1], "position": [3, 0, 1]}],
    "cables": [{"name": "line", "from": [0, 0, 1], "to": [3, 0, 1], "links": 6, "radius": 0.02, "mass": 12, "a": "ground",
                "b": "hook"}],
    "joints": [{"type": "ball", "a": "line_2", "b": "ground", "anchor": [1.5, 0, 1]}],
    "probes": [{"name": "pull", "quantity": "reaction-force", "joint": "line_joint_0"}])");
  const World& world = scene.world;
  EXPECT_EQ(world.body_count(), 8);
  EXPECT_EQ(world.joint_count(), 8);
  for (int i = 0; i < 6; ++i) {
    const BodyId link = world.body("line_" + std::to_string(i));
    EXPECT_NEAR(world.mass_properties(link).mass(), 2, 1e-14);
    EXPECT_TRUE(world.pose(link).p.isApprox(Vec3(0.25 + 0.5 * i, 0, 1), 1e-14));
  }
  EXPECT_EQ(world.joint(world.joint("line_joint_0")).bodies().front(), kGround);
  EXPECT_EQ(world.joint(world.joint("line_joint_6")).bodies().back(), world.body("hook"));
}

TEST(SceneEnds, EndsThatNothingHoldsAreFree) {
  const Scene scene = scene_of(R"("cables": [{"name": "line", "from": [0, 0, 1], "to": [3, 0, 1], "links": 6,
    "radius": 0.02, "density": 1000}])");
  EXPECT_EQ(scene.world.joint_count(), 5);
  EXPECT_FALSE(scene.world.has_joint("line_joint_0"));
  EXPECT_TRUE(scene.world.has_joint("line_joint_1"));
  EXPECT_NEAR(scene.world.mass_properties(scene.world.body("line_0")).mass(),
              1000 * std::numbers::pi * 0.02 * 0.02 * 0.5, 1e-12);
}

/// A cable that sags is at rest: the law of its shape is that of the solver's joints and weights.
TEST(SceneEnds, ACableThatSagsHangsAtRest) {
  for (const char* keys :
       {R"("to": [3, 1, 1], "links": 20, "length": 4)", R"("to": [3, 0, 0], "links": 7, "length": 8)",
        R"("to": [-1, 2, 4], "links": 30, "length": 5)"}) {
    Scene scene = scene_of(R"("cables": [{"name": "line", "from": [0, 0, 0], "radius": 0.01, "density": 1000,
      "a": "ground", "b": "ground", )" +
                           std::string(keys) + "}]");
    const World start = scene.world;
    scene.settings.contacts = false;
    Simulator simulator(scene.world, scene.settings);
    for (int i = 0; i < 240; ++i) ASSERT_TRUE(simulator.step(1.0 / 240).ok());
    // Round-off grows by swinging; a shape that is wrong by 1e-3 falls by centimetres in a second.
    for (int b = 1; b < start.body_count(); ++b)
      EXPECT_TRUE(scene.world.pose(BodyId{b}).p.isApprox(start.pose(BodyId{b}).p, 1e-6)) << keys << b;
  }
}

double length_of(const std::vector<Vec3>& nodes, int n, double length) {
  double worst = 0;
  for (std::size_t i = 1; i < nodes.size(); ++i)
    worst = std::max(worst, std::abs((nodes[i] - nodes[i - 1]).norm() - length / n));
  return worst;
}

TEST(HangingChain, HasEqualLinksBetweenItsEndsWhereverTheyAre) {
  const Vec3 down(0, 0, -9.81);
  for (int n : {2, 3, 5, 50, 1000})
    for (const Vec3& to :
         {Vec3(1, 0, 0), Vec3(0.3, -2, 1), Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(0, 0, 0), Vec3(1e-3, 0, 1)})
      for (double slack : {1e-6, 0.01, 0.5, 3.0}) {
        const Vec3 from(1, 2, 3);
        const double length = to.norm() * (1 + slack) + (to.norm() == 0 ? slack : 0);
        const std::vector<Vec3> nodes = hanging_chain(from, from + to, n, length, down);
        ASSERT_EQ(nodes.size(), static_cast<std::size_t>(n) + 1);
        EXPECT_TRUE(nodes.front().isApprox(from, 1e-12)) << n << " " << to.transpose() << " " << slack;
        EXPECT_TRUE(nodes.back().isApprox(from + to, 1e-8)) << n << " " << to.transpose() << " " << slack;
        EXPECT_LT(length_of(nodes, n, length), 1e-8 * length) << n << " " << to.transpose() << " " << slack;
      }
  EXPECT_THROW(hanging_chain({0, 0, 0}, {1, 0, 0}, 0, 1, down), std::invalid_argument);
  EXPECT_THROW(hanging_chain({0, 0, 0}, {1, 0, 0}, 2, 0.5, down), std::invalid_argument);
  EXPECT_THROW(hanging_chain({0, 0, 0}, {1, 0, 0}, 1, 1.5, down), std::invalid_argument);
}

}  // namespace
}  // namespace taut::scene_ends_test
