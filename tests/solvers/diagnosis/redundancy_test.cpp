#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <set>

#include "core/constraints/rows.h"
#include "scenes/builders/scene.h"
#include "scenes/files/scene_file.h"
#include "solvers/simulator/simulator.h"
#include "tests/solvers/complementarity/law_problems.h"
#include "tests/source_dir.h"

// Which rows are redundant and whose reactions are not unique, against the null space of the dense matrix.
namespace taut::redundancy_test {
namespace {

Scene scene_of(const std::string& name, double n) {
  return name.ends_with(".json") ? load_scene_file(testing::source_dir() + "/scenes/examples/" + name)
                                 : build_scene(name, {{"n", n}});
}

/// Joints with a part in the null space of S, whose eigenvalues are above 1e-6 or below 1e-12 here.
std::set<int> self_stressed(const World& world) {
  const Eigen::MatrixXd S = law_problems::dense_system(world);
  const Eigen::VectorXd root = S.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(root.asDiagonal() * S * root.asDiagonal());
  const Rows rows(world);
  std::set<int> joints;
  for (int k = 0; k < S.rows() && eigen.eigenvalues()[k] < 1e-9; ++k)
    for (int r = 0; r < S.rows(); ++r)
      if (std::abs(eigen.eigenvectors()(r, k)) > 1e-7) joints.insert(rows.joint_of(r)->index);
  return joints;
}

struct Redundant {
  const char* scene;
  double n;
  int rows;
};

TEST(Redundancy, ReactionsThatAreNotUniqueAreNamed) {
  for (const Redundant& c : {Redundant{"bricard.json", 0, 1},
                             {"andrews.json", 0, 9},
                             {"four_bar.json", 0, 3},
                             {"cardan_shaft.json", 0, 3},
                             {"bridge-hinge", 12, 3},
                             {"bridge-balls", 12, 16},
                             {"joint-grid", 5, 12},
                             {"n-four-bar", 3, 9},
                             {"net-corners", 5, 0},
                             {"chain", 20, 0}}) {
    Scene scene = scene_of(c.scene, c.n);
    const std::set<int> expected = self_stressed(scene.world);
    const RankReport rank = Simulator(scene.world, scene.settings).analyze_rank();
    std::set<int> named;
    for (JointId joint : rank.not_unique) named.insert(joint.index);
    EXPECT_EQ(static_cast<int>(rank.redundant.size()), c.rows) << c.scene;
    EXPECT_EQ(named, expected) << c.scene;
    EXPECT_EQ(expected.empty(), c.rows == 0) << c.scene;
  }
}

/// A pendulum beside a door on two hinges has nothing to do with them.
TEST(Redundancy, OfOthersLeavesReactionsUnique) {
  World world;
  const BodyId door = world.add_body({.pose = {.p = {0.4, 0, 0}}}),
               bob = world.add_body({.pose = {.p = {5, 0, 0}}});
  const JointId low = world.add("low", Hinge::at(world, kGround, door, Vec3(0, 0, -0.8), Vec3::UnitZ()));
  world.add("pivot", Hinge::at(world, kGround, bob, Vec3(4, 0, 0), Vec3::UnitY()));
  const JointId high = world.add("high", Hinge::at(world, kGround, door, Vec3(0, 0, 0.8), Vec3::UnitZ()));
  EXPECT_EQ(Simulator(world).analyze_rank().not_unique, (std::vector{low, high}));
}

/// A step names the rows that the analysis finds, and those that come with a change.
TEST(Redundancy, IsNamedByEveryStep) {
  World world;
  const BodyId door = world.add_body({.pose = {.p = {0.4, 0, 0}}});
  world.add("low", Hinge::at(world, kGround, door, Vec3(0, 0, -0.8), Vec3::UnitZ()));
  Simulator simulator(world);
  ASSERT_TRUE(simulator.step(1e-3).exact());
  EXPECT_TRUE(simulator.report().dependent_rows.empty());
  world.add("high", Ball::at(world, kGround, door, Vec3(0, 0, 0.8)));
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(simulator.step(1e-3).exact());
    const std::vector<DependentRow>& rows = simulator.report().dependent_rows;
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(static_cast<int>(rows.size()), simulator.report().rank_deficiency);
    std::vector<std::string> expected;
    for (const RedundantRow& row : simulator.analyze_rank().redundant)
      expected.push_back(std::string(world.joint(row.joint).type()) + " " + world.name(row.joint) + ": " +
                         row.name);
    EXPECT_EQ(names_of(rows, world), expected);
  }
}

}  // namespace
}  // namespace taut::redundancy_test
