#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "scenes/builders/scene.h"
#include "scenes/files/scene_file.h"
#include "solvers/simulator/simulator.h"
#include "tests/source_dir.h"

// Mechanisms and machines, as files and from the catalogue, and what they show.
namespace taut::mechanisms_test {
namespace {

using Json = nlohmann::json;

/// Steps on; joints closed and laws met in every step.
void run(Simulator& simulator, double dt, int steps) {
  for (int i = 0; i < steps; ++i) {
    const StepReport& r = simulator.step(dt);
    ASSERT_TRUE(r.exact()) << "step " << i << ": " << r.message;
    ASSERT_LE(std::max(r.gap.metres, r.gap.radians), 1e-9) << i;
    ASSERT_LE(r.natural_residual, 1e-9) << i;
    ASSERT_NEAR(r.ledger.start + r.ledger.total(), r.energy(), 1e-12 * (1 + std::abs(r.energy()))) << i;
  }
}

/// A scene file against the case of tests/references that is the same system: positions of points at all
/// times of the case, to its tolerances for the step of the file.
void compare_with_reference(const char* scene_file, const char* reference_file) {
  const std::string source = testing::source_dir();
  Scene scene = load_scene_file(source + "/scenes/examples/" + scene_file);
  std::ifstream in(source + "/tests/references/" + reference_file);
  const Json reference = Json::parse(in);
  World& world = scene.world;
  const State start = world.state();
  Simulator simulator(world, scene.settings);
  std::vector<Json> quantities;
  for (const Json& quantity : reference.at("quantities")) {
    const Json& probe = quantity.at("probe");
    if (quantity.at("time").is_number() && probe.value("kind", "") == "point" &&
        probe.value("what", "") == "position")
      quantities.push_back(quantity);
  }
  std::stable_sort(quantities.begin(), quantities.end(),
                   [](const Json& a, const Json& b) { return a.at("time") < b.at("time"); });
  ASSERT_GE(quantities.size(), 5u);
  for (const Json& quantity : quantities) {
    const double time = quantity.at("time");
    run(simulator, scene.dt, static_cast<int>(std::lround((time - world.time()) / scene.dt)));
    if (::testing::Test::HasFatalFailure()) return;
    const Json& probe = quantity.at("probe");
    const BodyId body = world.body(probe.at("body").get<std::string>());
    const auto vector = [](const Json& v) { return Vec3(v.at(0), v.at(1), v.at(2)); };
    const Pose& from = start.poses[body.index];
    const Vec3 p = world.pose(body).point(
        from.local(probe.contains("point_at_t0") ? vector(probe.at("point_at_t0")) : from.p));
    EXPECT_LT((p - vector(quantity.at("value"))).cwiseAbs().maxCoeff(), quantity.at("abs_tol").get<double>())
        << quantity.at("name") << " at " << time;
  }
}

TEST(SceneFiles, BricardsMechanismMovesAsInTheReference) {
  compare_with_reference("bricard.json", "bricard_a04.json");
}
TEST(SceneFiles, GovernorMovesAsInTheReference) {
  compare_with_reference("governor.json", "flyball_a05.json");
}
/// The points of the reference come as one list of x and y.
TEST(SceneFiles, AndrewsMechanismMovesAsInTheReference) {
  const std::string source = testing::source_dir();
  Scene scene = load_scene_file(source + "/scenes/examples/andrews.json");
  std::ifstream in(source + "/tests/references/andrews_torque2.json");
  const Json reference = Json::parse(in);
  const State start = scene.world.state();
  Simulator simulator(scene.world, scene.settings);
  int compared = 0;
  for (const Json& quantity : reference.at("quantities")) {
    if (quantity.at("name") != "points_F_E_D_G_H (x,y)") continue;
    run(simulator, scene.dt,
        static_cast<int>(std::lround((quantity.at("time").get<double>() - scene.world.time()) / scene.dt)));
    const Json& items = quantity.at("probe").at("items");
    for (std::size_t k = 0; k < items.size(); ++k) {
      const BodyId body = scene.world.body(items[k].at("body").get<std::string>());
      const Json& at = items[k].at("point_at_t0");
      const Vec3 p = scene.world.pose(body).point(start.poses[body.index].local(Vec3(at[0], at[1], at[2])));
      for (int i = 0; i < 2; ++i, ++compared)
        EXPECT_NEAR(p[i], quantity.at("value")[2 * k + i].get<double>(), quantity.at("abs_tol").get<double>())
            << k << " at " << quantity.at("time");
    }
  }
  EXPECT_GE(compared, 40);
}

/// Turns through the poses in which all bars lie in one line: the windows stay parallelograms, as the
/// IFToMM benchmark asks, and do not fold.
TEST(Machines, FourBarsPassTheirSingularPositions) {
  Scene scene = build_scene("n-four-bar", {{"n", 2}});
  World& world = scene.world;
  Simulator simulator(world, scene.settings);
  const AxisId first = world.axis(world.joint("foot_0"), "angle");
  double energy = 0, turned = 0, last = world.axis_value(first);
  for (int i = 0; i < 200; ++i) {
    run(simulator, scene.dt, 50);
    if (HasFatalFailure()) return;
    const double now = world.axis_value(first);
    turned += std::remainder(now - last, 2 * std::numbers::pi);
    last = now;
    for (const char* foot : {"foot_1", "foot_2"}) {
      const double other = world.axis_value(world.axis(world.joint(foot), "angle"));
      ASSERT_NEAR(std::remainder(other - now, 2 * std::numbers::pi), 0, 1e-8) << world.time();
    }
    if (i == 0) energy = simulator.report().energy();
    ASSERT_NEAR(simulator.report().energy(), energy, 1e-4 * scene.energy_scale);
  }
  EXPECT_GT(std::abs(turned), 8 * std::numbers::pi);
  RecordProperty("turns", std::to_string(turned / (2 * std::numbers::pi)));
}

TEST(Machines, TheCarsEngineDrivesItsWheelsByTheDifferential) {
  Scene scene = build_scene("car");
  World& world = scene.world;
  Simulator simulator(world, scene.settings);
  const AxisId engine = world.axis(world.joint("engine"), "angle"),
               shaft = world.axis(world.joint("shaft_bearing"), "angle"),
               left = world.axis(world.joint("rear_left"), "spin"),
               right = world.axis(world.joint("rear_right"), "spin"),
               steering = world.axis(world.joint("front_left"), "steering");
  for (int i = 0; i < 10; ++i) {
    run(simulator, scene.dt, 100);
    if (HasFatalFailure()) return;
    const double speed = world.axis_rate(engine);
    EXPECT_NEAR(world.axis_rate(shaft), speed / 4, 1e-8);
    EXPECT_NEAR(world.axis_rate(left) + world.axis_rate(right), 2 * world.axis_rate(shaft), 1e-8);
    EXPECT_NEAR(world.axis_value(steering), 0.4 * std::sin(std::numbers::pi * world.time()), 1e-9);
    const AxisReport motor = simulator.axis_report(engine);
    EXPECT_TRUE(motor.saturated);
    // The torque of the curve at the speed, which changes a little in the step.
    const Curve& curve = *world.axis_properties(engine).motor->force_of_speed;
    EXPECT_NEAR(motor.force.motor, curve.held(speed), 0.5) << speed;
  }
  EXPECT_GT(world.axis_rate(engine), 50);
}

TEST(Machines, TheRobotFollowsItsTrajectoryIfItsTorquesAllow) {
  for (const double torque : {1.0, 0.1}) {
    Scene scene = build_scene("robot-arm", {{"torque", torque}});
    World& world = scene.world;
    Simulator simulator(world, scene.settings);
    double worst = 0;
    bool saturated = false;
    for (int i = 0; i < 1500; ++i) {
      run(simulator, scene.dt, 1);
      if (HasFatalFailure()) return;
      for (int k = 1; k <= 6; ++k) {
        const AxisId axis = world.axis(world.joint("axis_" + std::to_string(k)), "angle");
        const AxisMotor& motor = *world.axis_properties(axis).motor;
        const AxisReport report = simulator.axis_report(axis);
        ASSERT_LE(std::abs(report.force.motor), motor.max_force * (1 + 1e-9));
        saturated = saturated || report.saturated;
        if (i > 1000)  // it starts at rest, and must catch up first
          worst = std::max(worst, std::abs(world.axis_value(axis) - motor.trajectory(world.time()).value));
      }
    }
    if (torque == 1)
      EXPECT_LT(worst, 1e-8);
    else
      EXPECT_TRUE(saturated && worst > 0.1) << worst;
  }
}

TEST(Machines, TheRagdollHangsByItsHandWithinItsLimits) {
  Scene scene = build_scene("ragdoll");
  World& world = scene.world;
  Simulator simulator(world, scene.settings);
  int touched = 0;
  for (int i = 0; i < 480; ++i) {
    run(simulator, scene.dt, 1);
    if (HasFatalFailure()) return;
    for (int j = 0; j < world.joint_count(); ++j)
      for (int k = 0; k < world.axis_count({j}); ++k) {
        const AxisId axis{{j}, k};
        const auto& limits = world.axis_properties(axis).limits;
        if (!limits) continue;
        ASSERT_GE(world.axis_value(axis), limits->lower - 1e-8) << world.axis_label(axis);
        ASSERT_LE(world.axis_value(axis), limits->upper + 1e-8) << world.axis_label(axis);
        touched += simulator.axis_report(axis).at_limit;
      }
  }
  EXPECT_GT(touched, 100);
  // All of its weight is on the hand once it hangs still, and a part of it before.
  EXPECT_GT(simulator.mean_reaction(world.joint("hand")).force.z(), 100);
}

/// The way from the carriage over the sheaves to the hook keeps its length, so the winch lifts the load.
TEST(Machines, TheCranesWinchLiftsItsLoadOverTheSheaves) {
  Scene scene = build_scene("crane");
  World& world = scene.world;
  Simulator simulator(world, scene.settings);
  const auto length = [&] {
    const std::vector<WirePoint> wire = world.joint(world.joint("hoist_wire")).course();
    const auto at = [&](int i) { return world.pose(wire[i].body).point(wire[i].p_BP); };
    return (at(1) - at(0)).norm() + (at(3) - at(2)).norm();
  };
  const double start = length(), height = world.pose(world.body("hook")).p.z();
  run(simulator, scene.dt, 2500);
  EXPECT_NEAR(length(), start, 1e-8);
  // The winch has drawn its end of the wire from 9 m to 11 m beside the sheave, 6.3 m below it; the load
  // swings a little.
  EXPECT_NEAR(world.pose(world.body("hook")).p.z() - height, std::hypot(11, 6.3) - std::hypot(9, 6.3), 0.02);
  EXPECT_GT(-simulator.axis_report(world.axis(world.joint("luffing_rope"), "length")).force.limit, 1000);
}

TEST(Machines, HangersOfTheSuspensionBridgeBreakOneAfterAnother) {
  Scene scene = build_scene("suspension-bridge");
  World& world = scene.world;
  Simulator simulator(world, scene.settings);
  std::vector<double> times;
  while (world.time() < scene.duration) {
    run(simulator, scene.dt, 1);
    if (HasFatalFailure()) return;
    for (const BreakEvent& event : simulator.report().breaks) {
      times.push_back(event.time);
      EXPECT_EQ(world.name(event.joint).substr(0, 6), "hanger");
      EXPECT_GE(event.force, 2.2 * 400 * 9.81 * (1 - 1e-9));
      EXPECT_FALSE(world.is_attached(event.joint));
    }
  }
  EXPECT_GE(times.size(), 3u);
  int apart = 0;
  for (std::size_t i = 1; i < times.size(); ++i) apart += times[i] - times[i - 1] > 2 * scene.dt;
  EXPECT_GE(apart, 2);
}

/// The laws of limits, motors and friction without any tolerance, in scenes of all kinds.
TEST(Machines, MeetTheirLawsTo1e9InEveryStep) {
  const struct {
    const char* scene;
    std::map<std::string, double> parameters;
    int steps;
  } cases[] = {{"chain-limited", {{"n", 100}}, 600},
               {"net-friction", {{"n", 12}}, 12},
               {"net-friction", {{"n", 12}, {"friction", 1}}, 60},
               {"bridge-hinge", {}, 100},
               {"bridge-balls", {}, 100},
               {"crane", {}, 1000},
               {"robot-arm", {{"torque", 0.3}}, 2000},
               {"ragdoll", {}, 1000},
               {"car", {}, 500}};
  for (const auto& c : cases) {
    Scene scene = build_scene(c.scene, c.parameters);
    Simulator simulator(scene.world, scene.settings);
    for (int i = 0; i < c.steps; ++i) {
      const StepReport& r = simulator.step(scene.dt);
      ASSERT_TRUE(r.exact()) << c.scene << " step " << i << ": " << r.message;
      ASSERT_LE(std::max(r.gap.metres, r.gap.radians), 1e-9) << c.scene << " step " << i;
      ASSERT_LE(r.natural_residual, 1e-9) << c.scene << " step " << i;
    }
  }
}

/// A chain that falls from the horizontal; no joint bends by more than 30°.
TEST(Machines, AChainWithLimitsKeepsThem) {
  Scene scene = build_scene("chain-limited", {{"n", 60}});
  World& world = scene.world;
  Simulator simulator(world, scene.settings);
  double most = 0;
  for (int i = 0; i < 240; ++i) {
    run(simulator, scene.dt, 1);
    if (HasFatalFailure()) return;
    for (int j = 0; j < world.joint_count(); ++j)
      most = std::max(most, world.axis_value(world.axis({j}, "swing")));
    ASSERT_LE(most, std::numbers::pi / 6 + 1e-9) << i;
  }
  EXPECT_GT(most, std::numbers::pi / 6 - 1e-9);
}

}  // namespace
}  // namespace taut::mechanisms_test
