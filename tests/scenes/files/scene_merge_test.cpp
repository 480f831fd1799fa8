#include "scenes/files/scene_merge.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/joints/joints.h"
#include "solvers/simulator/simulator.h"

/// A block that is moved as a whole, with a prefix, behaves as the builder's own scene.
namespace taut::scene_merge_test {
namespace {

/// Every builder, small.
std::map<std::string, double> small(const SceneInfo& info) {
  std::map<std::string, double> parameters;
  for (const ParameterInfo& parameter : info.parameters)
    if (parameter.name == "n") parameters["n"] = std::max(3.0, parameter.minimum);
  return parameters;
}

const Pose kPlacement{exp_so3(Vec3(0.4, -0.9, 1.3)), Vec3(30, -20, 10)};

/// Taut rows of light bodies pressed on round ones, wheels on planks: contacts are found by iteration, to
/// some 1e-9 of the coordinates, and each such error turns a shoe or link at once (by 5e-6 where the
/// coordinates are tens of metres); a chain that begins to slide settles its tension within the tolerance of
/// its laws, 2e-6 m of 2e-4 m here.  They stay near, and are compared less sharply.
bool is_sensitive(const std::string& scene) {
  return scene == "tank" || scene == "chain-over-cylinder" || scene == "vehicle-bridge";
}
const Pose kNearPlacement{Quat::Identity(), Vec3(0.3, 0.1, 0.2)};

/// Bodies, joints and axes at rest in front of the block, so that its own get other indices.
void add_bystander(Scene& scene) {
  World& world = scene.world;
  const BodyId body = world.add_body({.name = "bystander", .pose = {Quat::Identity(), Vec3(0, 0, 500)}});
  world.add("bystander's", Hinge::at(world, kGround, body, world.pose(body).p, Vec3::UnitZ()));
  world.set_friction(world.axis(world.joint("bystander's"), "angle"), AxisFriction{1, 1});
}

double worst_distance(const World& built, const World& merged, const Pose& X) {
  double worst = 0;
  for (int b = 1; b < built.body_count(); ++b) {
    const Pose& original = built.pose(BodyId{b});
    const Pose& moved = merged.pose(merged.body("block/" + built.name(BodyId{b})));
    worst = std::max(worst, (X.point(original.p) - moved.p).norm());
    worst = std::max(worst, (X.q * original.q).angularDistance(moved.q));
  }
  return worst;
}

class MovedBlock : public ::testing::TestWithParam<std::string> {};

/// Under gravity that is turned with it.  A quarter of the builder's step, so that round-off does not decide
/// how many sub-steps are taken.  1e-7: the solver's tolerance of 1e-10 and round-off of coordinates of tens
/// of metres, 1e-14, grow over 80 steps with impacts and straight chains that buckle.  What is lost in a copy
/// (a spring, a motor, a limit, a force) shows in tenths of millimetres and more.
TEST_P(MovedBlock, MovesAsTheBuildersScene) {
  const bool sensitive = is_sensitive(GetParam());
  const Pose placement = sensitive ? kNearPlacement : kPlacement;
  const auto& catalogue = scene_catalogue();
  const auto info = std::find_if(catalogue.begin(), catalogue.end(),
                                 [](const SceneInfo& one) { return one.name == GetParam(); });
  ASSERT_NE(info, catalogue.end());
  const Scene built = build_scene(info->name, small(*info));
  Scene merged;
  merged.settings = built.settings;
  merged.world.set_gravity(placement.q * built.world.gravity());
  merged.world.set_time(built.world.time());
  add_bystander(merged);
  append_scene(merged, built, "block/", placement);
  ASSERT_EQ(merged.world.joint_count(), 1 + built.world.joint_count());
  ASSERT_EQ(merged.world.force_count(), built.world.force_count());
  ASSERT_EQ(merged.world.shape_count(), built.world.shape_count());
  ASSERT_EQ(merged.probes.size(), built.probes.size());

  World own_world = built.world;
  Simulator own(own_world, built.settings), moved(merged.world, merged.settings);
  if (built.assemble) {
    ASSERT_TRUE(own.assemble().exact());
    ASSERT_TRUE(moved.assemble().exact());
  }
  for (int i = 0; i < 80; ++i) {
    ASSERT_TRUE(own.step(built.dt / 4).exact()) << own.report().message;
    ASSERT_TRUE(moved.step(built.dt / 4).exact()) << moved.report().message;
  }

  EXPECT_LT(worst_distance(own.world(), moved.world(), placement), sensitive ? 5e-6 : 1e-7);
}

std::vector<std::string> builder_names() {
  std::vector<std::string> names;
  for (const SceneInfo& info : scene_catalogue()) names.push_back(info.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(Builders, MovedBlock, ::testing::ValuesIn(builder_names()), [](const auto& name) {
  std::string text = name.param;
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
});

TEST(AppendScene, LeavesTheSceneAloneIfANameIsTaken) {
  Scene scene = build_scene("chain", {{"n", 3}});
  const Scene block = build_scene("chain", {{"n", 2}});
  EXPECT_THROW(append_scene(scene, block, "", {}), std::invalid_argument);
  EXPECT_EQ(scene.world.body_count(), 4);
  EXPECT_EQ(scene.probes.size(), block.probes.size());
  append_scene(scene, block, "two/", {});
  const int bodies = scene.world.body_count();
  EXPECT_THROW(append_scene(scene, block, "two/", Pose{Quat::Identity(), Vec3::UnitX()}),
               std::invalid_argument);
  EXPECT_EQ(scene.world.body_count(), bodies);
}

}  // namespace
}  // namespace taut::scene_merge_test
