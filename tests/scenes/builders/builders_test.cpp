#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <chrono>

#include "core/constraints/rows.h"
#include "core/world/diagnostics.h"
#include "scenes/builders/scene.h"

namespace taut::builders_test {
namespace {

struct Case {
  std::string scene;
  std::map<std::string, double> parameters;
  int moving_bodies, rows;
  double duration;
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  out << c.scene;
  for (const auto& [name, value] : c.parameters) out << " " << name << "=" << value;
  return out;
}

Case bridge_case(const char* scene, int n, bool truck, double duration) {
  const int per_seam = std::string(scene) == "bridge-hinge" ? 5 : 6;
  return {scene, {{"n", n}, {"truck", truck}}, n + truck, per_seam * (n + 1) + 6 * truck, duration};
}

std::vector<Case> tabulated() {
  std::vector<Case> cases;
  for (int n : {1, 2}) {
    cases.push_back({"pendulum-ball", {{"n", n}}, n, 3 * n, 10});
    cases.push_back({"pendulum-hinge", {{"n", n}}, n, 5 * n, 10});
  }
  for (auto [n, duration] : {std::pair(10, 5.0), {100, 5.0}, {1000, 2.0}, {10000, 1.0}}) {
    cases.push_back({"chain", {{"n", n}}, n, 3 * n, duration});
    cases.push_back({"chain-heavy", {{"n", n}}, n + 1, 3 * n + 3, duration});
  }
  for (auto [n, duration] : {std::pair(10, 5.0), {50, 5.0}, {200, 2.0}, {1000, 1.0}})
    for (const char* scene : {"bridge-hinge", "bridge-balls"})
      for (bool truck : {false, true}) cases.push_back(bridge_case(scene, n, truck, duration));
  struct Net {
    int n, bodies, rows;
    double duration;
  };
  for (const Net& net : {Net{5, 40, 171, 5}, Net{10, 180, 786, 5}, Net{20, 760, 3366, 2},
                         Net{40, 3120, 13926, 1}, Net{80, 12640, 56646, 0.5}}) {
    cases.push_back({"net-flag", {{"n", net.n}}, net.bodies, net.rows, net.duration});
    cases.push_back({"net-corners", {{"n", net.n}}, net.bodies, net.rows + 6, net.duration});
  }
  for (int n : {2, 3, 10})
    for (bool swing : {false, true})
      cases.push_back(
          {"joint-grid", {{"n", n}, {"swing", swing}}, n * (n - 1), 3 * (n - 1) * (2 * n - 1), 2});
  return cases;
}

class TabulatedScene : public ::testing::TestWithParam<Case> {};

TEST_P(TabulatedScene, HasTheCountsAndTheDurationOfTheTable) {
  const Scene scene = build_scene(GetParam().scene, GetParam().parameters);
  EXPECT_EQ(scene.name, GetParam().scene);
  EXPECT_EQ(scene.world.moving_body_count(), GetParam().moving_bodies);
  EXPECT_EQ(Rows(scene.world).row_count(), GetParam().rows);
  EXPECT_EQ(scene.duration, GetParam().duration);
  EXPECT_EQ(scene.dt, 1.0 / 240);
  EXPECT_EQ(scene.parameters.at("n"), GetParam().parameters.at("n"));
  EXPECT_EQ(kinetic_energy(scene.world, scene.world.state()), 0);
}

// The arcs are closed forms, so that only round-off is left: coordinates reach 1000 m, where it is 1e-13.
TEST_P(TabulatedScene, StartsWithAllJointsClosed) {
  const Scene scene = build_scene(GetParam().scene, GetParam().parameters);
  EXPECT_TRUE(scene.world.validate().empty());
  const Rows rows(scene.world);
  std::vector<double> phi(rows.row_count());
  rows.residual(scene.world.state().poses, phi);
  const Gap gap = max_gap(rows, phi);
  EXPECT_LT(gap.metres, 1e-12);
  EXPECT_LT(gap.radians, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, TabulatedScene, ::testing::ValuesIn(tabulated()));

TEST(SceneBuilders, UseTheDurationOfTheNextSmallerTabulatedSize) {
  EXPECT_EQ(build_scene("chain", {{"n", 3}}).duration, 5);
  EXPECT_EQ(build_scene("chain", {{"n", 999}}).duration, 5);
  EXPECT_EQ(build_scene("bridge-balls", {{"n", 500}}).duration, 2);
  EXPECT_EQ(build_scene("net-flag", {{"n", 19}}).duration, 5);
  EXPECT_EQ(build_scene("net-flag", {{"n", 100}}).duration, 0.5);
}

// The reference values are given to nine digits.
TEST(SceneBuilders, HaveTheEnergyScalesOfTheReference) {
  const auto scale = [](const char* name, std::map<std::string, double> parameters) {
    return build_scene(name, parameters).energy_scale;
  };
  const auto expect = [](double value, double reference) { EXPECT_NEAR(value, reference, 1e-8 * reference); };
  expect(scale("pendulum-ball", {{"n", 2}}), 19.62);
  expect(scale("chain", {{"n", 10}}), 4.905);
  expect(scale("chain-heavy", {{"n", 10}}), 1133.055);
  for (const char* bridge : {"bridge-hinge", "bridge-balls"}) {
    expect(scale(bridge, {{"n", 10}}), 48.8899771);
    expect(scale(bridge, {{"n", 10}, {"truck", 1}}), 2004.48906);
  }
  expect(scale("net-flag", {{"n", 5}}), 15.696);
  expect(scale("net-corners", {{"n", 5}}), 15.696);
  // 90 spheres of 268.08 kg, 5 m below the fixed row on average.
  expect(scale("joint-grid", {{"n", 10}, {"swing", 1}}),
         90 * 1000 * 4.0 / 3 * M_PI * 0.4 * 0.4 * 0.4 * 9.81 * 5);
}

Vec3 probe_start(const char* name, std::map<std::string, double> parameters) {
  const Scene scene = build_scene(name, parameters);
  EXPECT_EQ(scene.probes.size(), 1u);
  EXPECT_EQ(scene.probes[0].name, "probe");
  EXPECT_EQ(scene.probes[0].quantity, Probe::Quantity::kPosition);
  return scene.world.pose(scene.probes[0].body).point(scene.probes[0].point_B);
}

// The reference values are given to 1e-6 m.
TEST(SceneBuilders, StartTheirProbesAtTheReference) {
  for (const char* bridge : {"bridge-hinge", "bridge-balls"})
    EXPECT_LT((probe_start(bridge, {{"n", 10}, {"truck", 1}}) - Vec3(0.099980, 0, -0.097674)).norm(), 1e-6);
  EXPECT_LT((probe_start("net-flag", {{"n", 10}}) - Vec3(0, 0.9, -0.087724)).norm(), 1e-6);
  EXPECT_LT((probe_start("net-corners", {{"n", 10}}) - Vec3(0, 0.05, -0.175449)).norm(), 1e-6);
  EXPECT_LT((probe_start("chain", {{"n", 10}}) - Vec3(0.95, 0, 0)).norm(), 1e-15);
  EXPECT_LT((probe_start("chain-heavy", {{"n", 10}}) - Vec3(1.15, 0, 0)).norm(), 1e-15);
}

/// Rows less rank of J with the columns of the moving bodies only, by singular values of J as a dense matrix.
int redundant_rows(const World& world) {
  const Rows rows(world);
  std::vector<double> values(rows.jacobian_size());
  rows.jacobian(world.state().poses, values);
  std::vector<int> column(world.body_count(), -1);
  int columns = 0;
  for (int b = 0; b < world.body_count(); ++b)
    if (!world.is_fixed(BodyId{b})) column[b] = 6 * columns++;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows.row_count(), 6 * columns);
  for (const Rows::Side& side : rows.sides())
    if (column[side.body] >= 0)
      J.block(side.first_row, column[side.body], side.row_count, 6) =
          Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>>(
              values.data() + side.offset, side.row_count, 6);
  const Eigen::VectorXd sigma = Eigen::BDCSVD<Eigen::MatrixXd>(J).singularValues();
  // Singular values here are either above 1e-4 or below 1e-15 of the largest.
  return static_cast<int>(rows.row_count() - (sigma.array() > 1e-9 * sigma[0]).count());
}

TEST(SceneBuilders, HaveTheKnownRedundancy) {
  const auto redundant = [](const char* name, std::map<std::string, double> parameters) {
    return redundant_rows(build_scene(name, parameters).world);
  };
  EXPECT_EQ(redundant("pendulum-ball", {{"n", 2}}), 0);
  EXPECT_EQ(redundant("pendulum-hinge", {{"n", 2}}), 0);
  EXPECT_EQ(redundant("chain", {{"n", 10}}), 0);
  EXPECT_EQ(redundant("chain-heavy", {{"n", 10}}), 0);
  for (double truck : {0, 1}) {
    EXPECT_EQ(redundant("bridge-hinge", {{"n", 10}, {"truck", truck}}), 3);
    EXPECT_EQ(redundant("bridge-balls", {{"n", 10}, {"truck", truck}}), 14);
  }
  for (double n : {5, 10}) {
    EXPECT_EQ(redundant("net-flag", {{"n", n}}), 0);
    EXPECT_EQ(redundant("net-corners", {{"n", n}}), 0);
  }
  for (int n : {2, 3, 6}) EXPECT_EQ(redundant("joint-grid", {{"n", n}}), (n - 1) * (n - 2));
}

TEST(SceneBuilders, GiveReadableNamesInTheOrderOfTheDefinition) {
  const Scene bridge_scene = build_scene("bridge-balls", {{"n", 4}, {"truck", 1}});
  const World& bridge = bridge_scene.world;
  EXPECT_EQ(bridge.body("plank_0").index, 1);
  EXPECT_EQ(bridge.body("truck").index, 5);
  EXPECT_EQ(bridge.joint("seam_0_right").index, 0);
  EXPECT_EQ(bridge.joint("seam_4_left").index, 9);
  const Scene net_scene = build_scene("net-corners", {{"n", 5}});
  const World& net = net_scene.world;
  EXPECT_EQ(net.body("rod_x_3_2").index, 1 + 2 * 4 + 3);
  EXPECT_EQ(net.body("rod_y_3_2").index, 1 + 20 + 3 * 4 + 2);
  EXPECT_EQ(net.joint("pin_0_0").index, 0);
  EXPECT_TRUE(net.has_joint("node_2_2_3"));
}

TEST(SceneBuilders, BuildLargeNetsFast) {
  const auto start = std::chrono::steady_clock::now();
  const Scene scene = build_scene("net", {{"n", 160}});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_EQ(scene.world.moving_body_count(), 50880);
  // A release build takes 0.1 s; the bound only catches a cost that grows with the square of the size.
  EXPECT_LT(seconds, 5);
  RecordProperty("seconds", std::to_string(seconds));
}

TEST(SceneCatalogue, ListsUniqueNamesWithDefaultsThatAreAllowed) {
  std::map<std::string, int> names;
  for (const SceneInfo& info : scene_catalogue()) {
    EXPECT_EQ(names[info.name]++, 0) << info.name;
    for (const ParameterInfo& parameter : info.parameters) {
      EXPECT_LE(parameter.minimum, parameter.default_value) << info.name;
      EXPECT_GE(parameter.maximum, parameter.default_value) << info.name;
    }
    EXPECT_GT(build_scene(info.name).energy_scale, 0) << info.name;
  }
  EXPECT_GE(names.size(), 11u);
}

TEST(SceneCatalogue, KnowsTheShortNames) {
  const Scene bridge = build_scene("bridge"), net = build_scene("net");
  EXPECT_EQ(bridge.name, "bridge-balls");
  EXPECT_EQ(bridge.world.moving_body_count(), 201);
  EXPECT_EQ(net.name, "net-corners");
  EXPECT_EQ(net.world.moving_body_count(), 3120);
}

TEST(SceneCatalogue, BuildsTheSmallestSizes) {
  for (const SceneInfo& info : scene_catalogue()) {
    std::map<std::string, double> smallest;
    for (const ParameterInfo& parameter : info.parameters) smallest[parameter.name] = parameter.minimum;
    const Scene scene = build_scene(info.name, smallest);
    EXPECT_TRUE(scene.world.validate(1e-12).empty()) << info.name;
    EXPECT_GT(scene.energy_scale, 0) << info.name;
  }
}

std::string refusal(const char* name, std::map<std::string, double> parameters) {
  try {
    build_scene(name, parameters);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SceneCatalogue, RefusesBadInputAndSaysWhatIsAllowed) {
  const auto expect = [](const std::string& message, std::initializer_list<const char*> parts) {
    for (const char* part : parts)
      EXPECT_NE(message.find(part), std::string::npos) << part << " is not in: " << message;
  };
  EXPECT_EQ(refusal("brigde", {}),
            "scene: there is none of this name; did you mean \"bridge\"? (value: brigde)");
  expect(refusal("trebuchet", {}),
         {"trebuchet", "none of this name, but ", "bridge-hinge", "net-flag", "chain"});
  expect(refusal("bridge-hinge", {{"trukc", 1}}), {"did you mean \"truck\"?"});
  expect(refusal("bridge-hinge", {{"m", 5}}),
         {"bridge-hinge", "none of this name", "n, truck", "(value: m)"});
  expect(refusal("chain", {{"n", 0}}), {"parameter n of chain", "from 1 to 1e+06", "(value: 0)"});
  expect(refusal("chain", {{"n", 2.5}}), {"whole number", "2.5"});
  expect(refusal("chain", {{"n", std::nan("")}}), {"nan"});
  expect(refusal("net-flag", {{"n", 2}}), {"from 3"});
  expect(refusal("bridge", {{"truck", 2}}), {"truck", "true or false", "(value: 2)"});
}

}  // namespace
}  // namespace taut::builders_test
