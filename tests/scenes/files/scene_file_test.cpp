#include "scenes/files/scene_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "core/constraints/rows.h"
#include "core/world/diagnostics.h"
#include "solvers/simulator/simulator.h"
#include "tests/scenes/files/scene_bad_cases.h"
#include "tests/source_dir.h"

namespace taut::scene_file_test {
namespace {

using namespace scene_file_cases;

std::vector<SceneFileProblem> problems_of(const std::string& text) {
  try {
    parse_scene(text, "test.json");
  } catch (const SceneFileError& error) {
    return error.problems();
  }
  return {};
}

/// φ of all rows of a world in its present state.
std::vector<double> residual_of(const World& world) {
  const Rows rows(world);
  std::vector<double> phi(rows.row_count());
  rows.residual(world.state().poses, phi);
  return phi;
}

std::vector<double> jacobian_of(const World& world) {
  const Rows rows(world);
  std::vector<double> values(rows.jacobian_size());
  rows.jacobian(world.state().poses, values);
  return values;
}

/// (J φ)ᵀ(J φ) of a world with one joint: what the joint holds, whichever normals it chose to an axis.
Eigen::MatrixXd constraint_of(const World& world) {
  const Rows rows(world);
  const auto phi = residual_of(world), values = jacobian_of(world);
  Eigen::MatrixXd J(rows.row_count(), 13);
  for (int side = 0; side < 2; ++side)
    J.middleCols<6>(6 * side) = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>>(
        values.data() + rows.sides()[side].offset, rows.row_count(), 6);
  J.col(12) = Eigen::VectorXd::Map(phi.data(), rows.row_count());
  return J.transpose() * J;
}

TEST(SceneFile, ReadsEveryKey) {
  const Scene scene = parse_scene(kEverything, "everything.json");
  EXPECT_EQ(scene.name, "everything");
  EXPECT_EQ(scene.world.gravity(), Vec3(0, 0, -1.62));
  EXPECT_EQ(scene.dt, 0.01);
  EXPECT_EQ(scene.duration, 3);
  EXPECT_EQ(scene.energy_scale, 12);
  EXPECT_EQ(scene.world.time(), 0.25);
  EXPECT_TRUE(scene.assemble);

  const Settings& s = scene.settings;
  EXPECT_EQ(s.integrator, Integrator::kRattle);
  EXPECT_EQ(s.position_tolerance, 1e-8);
  EXPECT_EQ(s.velocity_tolerance, 1e-7);
  EXPECT_EQ(s.max_newton_iterations, 7);
  EXPECT_EQ(s.max_substeps, 64);
  EXPECT_EQ(s.tension, TensionPolicy::kIgnore);
  EXPECT_EQ(s.max_tension_number, 0.5);
  EXPECT_EQ(s.max_rotation, 0.25);
  EXPECT_EQ(s.drift_cure, DriftCure::kPositionPush);
  EXPECT_EQ(s.erp, 0.5);
  EXPECT_EQ(s.cfm, 1e-9);
  EXPECT_EQ(s.penalty_frequency, 30);
  EXPECT_EQ(s.penalty_damping_ratio, 0.7);
  EXPECT_EQ(s.theta, 0.75);
  EXPECT_EQ(s.solver, Solver::kPairwise);
  EXPECT_EQ(s.iterations, 9);
  EXPECT_EQ(s.threads, 3);
  EXPECT_EQ(s.relaxation, 1.5);
  EXPECT_FALSE(s.contacts);
  EXPECT_EQ(s.contact_margin, 0.01);
  EXPECT_EQ(s.resting_speed, 0.02);
  EXPECT_EQ(s.max_contacts, 5000);
  EXPECT_EQ(s.inexact_tolerance, 1e-6);
  EXPECT_EQ(s.factor, FactorChoice::kMultifrontal);
  EXPECT_TRUE(s.sleep);
  EXPECT_EQ(s.sleep_speed, 1e-3);
  EXPECT_EQ(s.sleep_time, 0.75);
  EXPECT_TRUE(s.merge_fixed_joints);
  EXPECT_FALSE(s.report_energy);
  EXPECT_TRUE(s.report_rank);

  const World& world = scene.world;
  const auto inertia = [&](const char* name) { return world.mass_properties(world.body(name)).inertia_B(); };
  EXPECT_EQ(inertia("moments"), Mat3(Vec3(1, 2, 2.5).asDiagonal()));
  EXPECT_EQ(inertia("matrix")(0, 1), 0.1);
  EXPECT_EQ(inertia("box"), MassProperties::box({1, 2, 3}, 6 * 100).inertia_B());
  EXPECT_EQ(inertia("sphere"), MassProperties::sphere(0.5, 2).inertia_B());
  EXPECT_EQ(inertia("ellipsoid"), MassProperties::ellipsoid({1, 2, 3}, 2).inertia_B());
  EXPECT_EQ(inertia("rod"), MassProperties::rod(2, 0.1, 2).inertia_B());
  EXPECT_EQ(inertia("cylinder"), MassProperties::cylinder(0.1, 2, 2).inertia_B());
  EXPECT_EQ(inertia("capsule"), MassProperties::capsule(0.1, 2, 2).inertia_B());
  EXPECT_EQ(inertia("cone"), MassProperties::cone(0.1, 2, 2).inertia_B());
  EXPECT_TRUE(world.is_fixed(world.body("wall")));

  const auto pose = [&](const char* name) { return world.pose(world.body(name)); };
  const auto twist = [&](const char* name) { return world.twist(world.body(name)); };
  EXPECT_EQ(pose("moments").p, Vec3(1, 2, 3));
  EXPECT_EQ(twist("moments").v, Vec3(4, 5, 6));
  EXPECT_EQ(twist("moments").w, Vec3(7, 8, 9));
  // 1e-15: round-off of sine, cosine and one product.
  EXPECT_TRUE((pose("box").q * Vec3::UnitX()).isApprox(Vec3(Vec3::UnitY()), 1e-15));
  EXPECT_TRUE(twist("box").w.isApprox(Vec3(0, 2, 0), 1e-15));  // (2, 0, 0) in body axes
  // Roll 90° takes y to z, then yaw 90° leaves it there.
  EXPECT_TRUE((pose("sphere").q * Vec3::UnitY()).isApprox(Vec3(Vec3::UnitZ()), 1e-15));
  EXPECT_TRUE((pose("sphere").q * Vec3::UnitX()).isApprox(Vec3(Vec3::UnitY()), 1e-15));
  EXPECT_EQ(pose("rod").q.coeffs(), Quat(0, 1, 0, 0).coeffs());

  for (const char* name :
       {"ball",         "hinge",  "slider",         "fixed",         "universal", "distance",
        "cylindrical",  "screw",  "planar",         "point_on_line", "hinge2",    "six_dof",
        "rope",         "pulley", "point_on_curve", "pose_driver",   "gear",      "rack_and_pinion",
        "differential", "driver"})
    EXPECT_EQ(world.joint(world.joint(name)).type(), name);
  EXPECT_EQ(world.force_count(), 9);
  ASSERT_EQ(scene.events.size(), 13U);
  EXPECT_EQ(text_of(scene.events[0], world),
            "attach clamp as it is; attach clamp; detach clamp; gravity [0, 0, -1]; end of the run");
  EXPECT_EQ(std::get<AtTime>(scene.events[0].when).time, 0.5);
  EXPECT_EQ(std::get<AttachJoint>(scene.events[0].actions[1]).tolerance, 1e-3);
  EXPECT_EQ(text_of(scene.events[1], world),
            "motor of hinge2 spin: target 3, at most 20; motor of tower angle: removed");
  EXPECT_TRUE(std::get<WhenPasses>(scene.events[1].when).each_time);
  EXPECT_FALSE(std::get<WhenPasses>(scene.events[1].when).located);
  const ApplyLoad load = std::get<ApplyLoad>(scene.events[2].actions[0]);
  EXPECT_EQ(load.duration, 2);
  EXPECT_TRUE(load.follows_body);
  EXPECT_EQ(load.factor(0.25).value, 0.25);
  const char* labels[] = {"position along z of rod",
                          "magnitude of the velocity of rod",
                          "angular velocity along x of rod",
                          "distance of rod and cone",
                          "tower angle",
                          "rate of tower angle",
                          "reaction force along z of tower",
                          "magnitude of the reaction torque of tower",
                          "gap of clamp",
                          "contact gap of shapes and ground",
                          "position along x of rod",
                          "hinge angle"};
  const WhenPasses::Way ways[] = {WhenPasses::Way::kRising, WhenPasses::Way::kFalling,
                                  WhenPasses::Way::kEither};
  for (int i = 1; i < 13; ++i) {
    const WhenPasses& when = std::get<WhenPasses>(scene.events[i].when);
    EXPECT_EQ(when.watch.label, labels[i - 1]);
    EXPECT_EQ(when.threshold, i == 10 ? 0.001 : 2);
    EXPECT_EQ(when.way, i == 1 ? ways[0] : i == 2 || i == 9 || i == 10 ? ways[1] : ways[2]) << i;
  }
  // Functions of time, by what they give at 1.25 s.
  const auto given = [&](int force, const char* body) {
    State state = world.state();
    state.time = 1.25;
    std::vector<Wrench> wrenches(world.body_count());
    world.force({force}).accumulate(state, wrenches);
    return wrenches[world.body(body).index];
  };
  EXPECT_NEAR(given(5, "rod").force.z(), 3 * 2, 1e-15);     // the middle of the gust
  EXPECT_NEAR(given(6, "rod").torque.z(), 3 * 1.5, 1e-15);  // from 2 at 1 s to 0 at 2 s
  const double factor = 1 + 2 * std::sin(3 * 1.25 + 0.5) + std::sin(5 * 1.25);
  EXPECT_NEAR(given(7, "cone").force.z(), world.mass_properties(world.body("cone")).mass() * 3 * factor,
              1e-12);
  EXPECT_EQ(given(7, "box").force.z(), 0);
  EXPECT_EQ(given(8, "box").force.x(), world.mass_properties(world.body("box")).mass());
  EXPECT_EQ(given(8, "wall").force.x(), 0);

  ASSERT_EQ(scene.probes.size(), 15U);
  EXPECT_EQ(scene.probes[0].name, "c/probe");  // the builder's own
  EXPECT_EQ(scene.probes[1].point_B, Vec3(0.5, 0, 0));
  EXPECT_EQ(scene.probes[1].body, world.body("rod"));
  EXPECT_EQ(scene.probes[6].joint, world.joint("hinge"));
  EXPECT_EQ(scene.probes[11].axis, world.axis(world.joint("hinge"), "angle"));
  for (int i = 0; i < 14; ++i) {
    EXPECT_EQ(scene.probes[1 + i].name, "p" + std::to_string(i));
    EXPECT_EQ(static_cast<int>(scene.probes[1 + i].quantity), i);
  }
}

/// What the solver "pairwise" excludes.
TEST(SceneFile, ReadsIntegratorAndTension) {
  const Settings s =
      parse_scene(
          R"({"format": "taut-scene/1", "settings": {"integrator": "rattle4", "tension": "implicit"}})",
          "test.json")
          .settings;
  EXPECT_EQ(s.integrator, Integrator::kRattle4);
  EXPECT_EQ(s.tension, TensionPolicy::kImplicit);
}

TEST(SceneFile, AxisPropertiesAreThoseOfTheFile) {
  const World world = parse_scene(scene_file_cases::kEverything, "test.json").world;
  const auto of = [&](const char* joint, const char* axis) {
    return world.axis_properties(world.axis(world.joint(joint), axis));
  };
  const AxisProperties travel = of("hinge2", "travel"), steering = of("hinge2", "steering"),
                       spin = of("hinge2", "spin"), line = of("point_on_line", "displacement"),
                       rope = of("rope", "length");
  EXPECT_EQ(travel.limits->lower, -0.1);
  EXPECT_EQ(travel.limits->upper, 0.2);
  EXPECT_EQ(travel.limits->restitution, 0.5);
  EXPECT_EQ(travel.spring->stiffness, 1e4);
  EXPECT_EQ(travel.spring->damping, 300);
  EXPECT_EQ(travel.spring->rest, 0.1);
  EXPECT_FALSE(travel.motor || travel.friction);
  EXPECT_EQ(steering.motor->mode, AxisMotor::Mode::kPosition);
  EXPECT_EQ(steering.motor->target, 0.2);
  EXPECT_EQ(steering.motor->max_force, 50);
  EXPECT_EQ(steering.motor->max_speed, 2);
  EXPECT_EQ(spin.motor->mode, AxisMotor::Mode::kVelocity);
  EXPECT_EQ(spin.motor->target, -3);
  EXPECT_EQ(spin.motor->max_force, kUnlimited);
  EXPECT_EQ(spin.motor->force_of_speed->held(150), 60);
  EXPECT_EQ(spin.friction->static_friction, 2);
  EXPECT_EQ(spin.friction->dynamic_friction, 1.5);
  EXPECT_EQ(spin.friction->viscous, 0.1);
  EXPECT_EQ(line.spring->table->held(0.5), 1.5);
  EXPECT_EQ(line.spring->damping_table->held(0.5), 1.5);
  EXPECT_EQ(rope.limits->upper, 9);
  EXPECT_EQ(rope.limits->restitution, 0.25);
  EXPECT_FALSE(world.has_axis_properties(world.joint("distance")));
}

TEST(SceneFile, AnglesAreZeroAtTheStart) {
  const World world = parse_scene(scene_file_cases::kEverything, "test.json").world;
  for (const char* joint : {"hinge", "universal", "cylindrical", "hinge2"})
    for (int k = 0; k < world.axis_count(world.joint(joint)); ++k) {
      const AxisId axis{world.joint(joint), k};
      if (!world.axis_info(axis).angular) continue;
      // The hinge's "value" of 12.5 says that it has made two turns.
      const double turns = joint == std::string_view("hinge") ? 2 : 0;
      EXPECT_NEAR(world.axis_value(axis), turns * 2 * std::numbers::pi, 1e-14) << joint;
    }
}

TEST(SceneFile, ForcesAreThoseOfTheFile) {
  const Scene scene = parse_scene(two_bodies(R"("gravity": [0, 0, 0], "forces": [
      {"type": "point-force", "body": "P", "point": [1, 0, 0], "force": [3, 0, 0]},
      {"type": "torque", "body": "P", "torque": [0, 0, 5]},
      {"type": "spring-damper", "a": "ground", "b": "Q", "frame": "world", "anchor_a": [2, 0, 1],
       "anchor_b": [2, 0, 0], "stiffness": 10, "rest_length": 0.25},
      {"type": "spring-damper", "a": "ground", "b": "Q", "frame": "world", "anchor_a": [2, 0, 1],
       "anchor_b": [2, 0, 0], "rest_length": 0.5, "table": [[0, 0], [1, 4]], "damping_table": [[0, 0], [1, 3]]}])"),
                                  "test.json");
  // P is turned by 90°: the force acts at (0, 1, 0) from its centre of mass and gives it the torque −3.
  std::vector<Wrench> wrenches(scene.world.body_count());
  scene.world.forces(scene.world.state(), wrenches);
  EXPECT_EQ(wrenches[1].force, Vec3(3, 0, 0));
  EXPECT_TRUE(wrenches[1].torque.isApprox(Vec3(0, 0, 5 - 3), 1e-15));
  EXPECT_EQ(wrenches[2].force, Vec3(0, 0, 7.5 + 2));
  EXPECT_EQ(scene.world.force(ForceId{3}).spring()->law.damping_table->held(0.5), 1.5);
}

TEST(SceneFile, BothFramesGiveTheSameJoint) {
  // P lies at (1, 0, 0), turned by 90° about z; Q at (2, 0, 0), unturned.
  struct Twin {
    const char *world, *body;
  };
  const Twin twins[] = {
      {R"("type": "ball", "anchor": [2, 1, 0])",
       R"("type": "ball", "frame": "body", "anchor_a": [1, -1, 0], "anchor_b": [0, 1, 0])"},
      {R"("type": "hinge", "anchor": [2, 1, 0], "axis": [1, 0, 0])",
       R"("type": "hinge", "frame": "body", "anchor_a": [1, -1, 0], "anchor_b": [0, 1, 0],
          "axis_a": [0, -1, 0], "axis_b": [1, 0, 0])"},
      {R"("type": "slider", "anchor": [2, 1, 0], "axis": [1, 0, 0])",
       R"("type": "slider", "frame": "body", "anchor_a": [1, -1, 0], "anchor_b": [0, 1, 0],
          "axis_a": [0, -1, 0], "orientation": {"axis": [0, 0, 1], "angle_deg": -90})"},
      {R"("type": "fixed", "anchor": [2, 1, 0])",
       R"("type": "fixed", "frame": "body", "anchor_a": [1, -1, 0], "anchor_b": [0, 1, 0],
          "orientation": {"rpy_deg": [0, 0, -90]})"},
      {R"("type": "universal", "frame": "world", "anchor": [2, 1, 0], "axis_a": [1, 0, 0],
          "axis_b": [0, 0, 1])",
       R"("type": "universal", "frame": "body", "anchor_a": [1, -1, 0], "anchor_b": [0, 1, 0],
          "axis_a": [0, -1, 0], "axis_b": [0, 0, 1])"},
      {R"("type": "distance", "frame": "world", "anchor_a": [1, 0, 0], "anchor_b": [2, 0, 1], "length": 1.5)",
       R"("type": "distance", "frame": "body", "anchor_a": [0, 0, 0], "anchor_b": [0, 0, 1], "length": 1.5)"},
  };
  for (const Twin& twin : twins) {
    const auto scene_with = [](const std::string& joint) {
      return parse_scene(two_bodies(R"("assemble": true, "joints": [{"a": "P", "b": "Q", )" + joint + "}]"),
                         "test.json");
    };
    World first = scene_with(twin.world).world, second = scene_with(twin.body).world;
    // At the start, and away from it, where every anchor and axis shows.
    for (int trial = 0; trial < 2; ++trial) {
      // 1e-14: round-off of a few products of numbers of order 1.
      EXPECT_TRUE(constraint_of(first).isApprox(constraint_of(second), 1e-14)) << twin.body;
      for (World* world : {&first, &second})
        world->set_pose(world->body("Q"), {exp_so3(Vec3(0.3, -0.2, 0.5)), Vec3(2.1, 0.2, -0.3)});
    }
  }
}

TEST(SceneFile, EveryErrorHasItsPathMessageAndValue) {
  for (const BadScene& bad : bad_scenes()) {
    const std::vector<SceneFileProblem> problems = problems_of(bad.text);
    std::string all;
    for (const SceneFileProblem& p : problems) all += p.path + ": " + p.message + " (" + p.value + ")\n";
    ASSERT_EQ(problems.size(), 1U) << bad.text << "\n" << all;
    EXPECT_EQ(problems[0].path, bad.path) << bad.text << "\n" << all;
    EXPECT_EQ(problems[0].message, bad.message) << bad.text;
    EXPECT_EQ(problems[0].value, bad.value) << bad.text;
  }
}

TEST(SceneFile, ListsAllErrorsOfAFileAtOnce) {
  const std::string text = R"({
    "format": "taut-scene/1",  // five bodies and joints, one error each
    "dt": 0, "gravity": [0, 1e999, 0], "colour": 1,
    "bodies": [
      {"name": "a", "mass": -1, "inertia": [1, 1, 1]},
      {"name": "b", "mass": 1, "inertia": [1, 1, 3]},
      {"name": "a", "mass": 1, "inertia": [1, 1, 1]},
      {"name": "c", "mass": 1, "inertia": [1, 1, 1], "inertia": [1, 1, 1]}
    ],
    "joints": [
      {"type": "ball", "a": "ground", "b": "x", "anchor": [0, 0, 0]},
      {"type": "hinge", "a": "c", "b": "c", "anchor": [0, 0, 0], "axis": [0, 0, 0]},
      {"name": "open", "type": "ball", "a": "ground", "b": "c", "frame": "world", "anchor_a": [0, 0, 0],
       "anchor_b": [0, 0.5, 0]}
    ]
  })";
  try {
    parse_scene(text, "bad.json");
    FAIL();
  } catch (const SceneFileError& error) {
    EXPECT_STREQ(
        error.what(),
        "bad.json:8:65: /bodies/3/inertia of \"c\": this key is given twice in the same object\n"
        "bad.json:3:29: /gravity/1: must be finite (value: inf)\n"
        "bad.json:3:11: /dt: must be finite and positive (value: 0)\n"
        "bad.json:5:29: /bodies/0/mass of \"a\": must be finite and positive (value: -1)\n"
        "bad.json:6:43: /bodies/1/inertia of \"b\": principal moments must obey the triangle inequality "
        "(value: [1,1,3])\n"
        "bad.json:7:16: /bodies/2/name: name is already taken by /bodies/0 (value: \"a\")\n"
        "bad.json:11:44: /joints/0/b: there is no body of this name (value: \"x\")\n"
        "bad.json:12:74: /joints/1/axis: must not be 0: it has no direction (value: [0,0,0])\n"
        "bad.json:12:40: /joints/1/b: joins a body to itself (value: \"c\")\n"
        "bad.json:3:50: /colour: unknown key; known here are \"$schema\", \"assemble\", \"bodies\", "
        "\"cables\", \"dt\", "
        "\"duration\", \"energy_scale\", \"events\", \"forces\", \"format\", \"generate\", \"gravity\", "
        "\"ground\", "
        "\"joints\", \"material_pairs\", \"materials\", \"name\", \"pairs\", \"probes\", \"settings\", "
        "\"time\" (value: 1)\n"
        "bad.json:13:7: /joints/2: ball \"open\" must be closed at the start to 1e-06 m or rad, but has a "
        "gap; "
        "\"assemble\": true lets the simulator close it (value: 0.5 m)");
    EXPECT_EQ(error.problems().size(), 11U);
  }
}

TEST(SceneFile, AssembleAllowsOpenJoints) {
  const std::string joint =
      R"("joints": [{"type": "hinge", "a": "P", "b": "Q", "frame": "body", "anchor_a": [0, 0, 0],
      "anchor_b": [0, 0, 0], "axis_a": [1, 0, 0], "axis_b": [1, 0, 0]}])";
  const auto problems = problems_of(two_bodies(joint));
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].value, "1 m, 1 rad");
  EXPECT_TRUE(parse_scene(two_bodies(R"("assemble": true, )" + joint), "test.json").assemble);
}

TEST(SceneFile, CommentsAndWholeNumbersAreAllowed) {
  const Scene scene = parse_scene(
      "// a line\n{ /* a block */ \"format\": \"taut-scene/1\", \"dt\": 1,"
      " \"settings\": {\"max_substeps\": 16.0}}",
      "folder/plain.json");
  EXPECT_EQ(scene.dt, 1);
  EXPECT_EQ(scene.settings.max_substeps, 16);
  EXPECT_EQ(scene.name, "plain");
  EXPECT_EQ(scene.world.body_count(), 1);
}

TEST(SceneFile, SyntaxErrorsNameLineAndColumn) {
  struct Case {
    std::string text;
    int line, column;
  };
  const Case cases[] = {
      {"{\n  \"format\": \"taut-scene/1\",\n  \"dt\": NaN\n}", 3, 9},
      {"{\"dt\": 01}", 1, 9},
      {"", 1, 1},
      {"{\"dt\": 1", 1, 9},
      {"{\"dt\": 1} x", 1, 11},
      {"{\"dt\": 1,}", 1, 9},
      {"{\"name\": \"\xff\"}", 1, 11},
      {"/* never closed", 1, 16},
  };
  for (const Case& c : cases) {
    const auto problems = problems_of(c.text);
    ASSERT_EQ(problems.size(), 1U) << c.text;
    EXPECT_EQ(problems[0].line, c.line) << c.text << ": " << problems[0].message;
    EXPECT_EQ(problems[0].column, c.column) << c.text << ": " << problems[0].message;
    EXPECT_EQ(problems[0].path, "");
    EXPECT_TRUE(problems[0].message.starts_with("syntax error")) << problems[0].message;
  }
}

TEST(SceneFile, DeepAndHugeTextsAreRejectedQuietly) {
  const int deep = 1000000;
  for (const std::string& text : {std::string(deep, '['), std::string(deep, '[') + std::string(deep, ']')}) {
    const auto problems = problems_of(text);
    ASSERT_EQ(problems.size(), 1U);
    EXPECT_TRUE(problems[0].message.starts_with("is nested too deeply"));
  }
  std::string objects;
  for (int i = 0; i < deep; ++i) objects += "{\"a\":";
  EXPECT_EQ(problems_of(objects).size(), 1U);
  const auto long_string = problems_of(R"({"format": ")" + std::string(deep, 'x') + "\"}");
  ASSERT_EQ(long_string.size(), 1U);
  EXPECT_LT(long_string[0].value.size(), 100U);
  // Many numbers out of range: the reader gives up after some, in less than quadratic time.
  std::string overflows = "1e999";
  for (int i = 0; i < 10000; ++i) overflows += ",1e999";
  EXPECT_GE(problems_of(R"({"format": "taut-scene/1", "gravity": [)" + overflows + "]}").size(), 1U);
}

TEST(SceneFile, FilesThatCannotBeReadAreErrors) {
  EXPECT_THROW(load_scene_file("no such file.json"), SceneFileError);
  EXPECT_THROW(load_scene_file(std::filesystem::path(testing::source_dir()) / "scenes" / "examples"),
               SceneFileError);
}

TEST(SceneFile, OneBlockIsTheBuildersOwnScene) {
  const Scene built = build_scene("net-corners", {{"n", 6}});
  const Scene read = parse_scene(
      R"({"format": "taut-scene/1", "generate": [{"builder": "net-corners", "parameters": {"n": 6}}]})",
      "net.json");
  EXPECT_EQ(read.parameters, built.parameters);
  EXPECT_EQ(read.dt, built.dt);
  EXPECT_EQ(read.duration, built.duration);
  EXPECT_EQ(read.energy_scale, built.energy_scale);
  EXPECT_EQ(read.probes.size(), built.probes.size());
  EXPECT_EQ(read.world.body_count(), built.world.body_count());
  EXPECT_EQ(residual_of(read.world), residual_of(built.world));
}

TEST(SceneFile, BlocksArePrefixedAndPlaced) {
  const Scene built = build_scene("chain", {{"n", 3}});
  const Scene scene = parse_scene(R"({"format": "taut-scene/1", "generate": [
      {"builder": "chain", "parameters": {"n": 3}},
      {"builder": "chain", "parameters": {"n": 3}, "prefix": "second/", "position": [0, 2, 0],
       "orientation": {"axis": [0, 0, 1], "angle_deg": 90}}],
    "bodies": [{"name": "end", "mass": 1, "shape": {"type": "sphere", "radius": 0.1}, "position": [0, 2.3, 0]}],
    "joints": [{"name": "hook", "type": "ball", "a": "second/rod_2", "b": "end", "anchor": [0, 2.3, 0]}],
    "probes": [{"name": "pull", "quantity": "reaction-force", "joint": "hook"}]})",
                                  "chains.json");
  const World& world = scene.world;
  ASSERT_EQ(world.body_count(), 1 + 3 + 1 + 3 + 1);
  EXPECT_EQ(world.joint_count(), 3 + 3 + 1);
  const BodyId frame = world.body("second/ground");
  EXPECT_TRUE(world.is_fixed(frame));
  for (int k = 0; k < 3; ++k) {
    const Vec3 original = built.world.pose(BodyId{1 + k}).p;
    const Vec3 placed = world.pose(world.body("second/" + built.world.name(BodyId{1 + k}))).p;
    EXPECT_TRUE(placed.isApprox(Vec3(-original.y(), 2 + original.x(), original.z()), 1e-15));
  }
  const JointId first = world.joint("second/" + built.world.name(JointId{0}));
  EXPECT_EQ(world.joint(first).a(), frame);
  EXPECT_EQ(world.joint(first).type(), "ball");
  // Closed to round-off, as the parser has checked to 1e-6 already.
  for (double phi : residual_of(world)) EXPECT_LT(std::abs(phi), 1e-14);
  EXPECT_EQ(scene.energy_scale, 0);
}

std::vector<std::filesystem::path> shipped_scenes() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(testing::source_dir()) /
                                                               "scenes" / "examples"))
    if (entry.path().extension() == ".json" && !entry.path().filename().string().ends_with(".schema.json"))
      paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST(ShippedScenes, StartClosedAndWithTangentVelocities) {
  ASSERT_GE(shipped_scenes().size(), 6U);
  for (const auto& path : shipped_scenes()) {
    const Scene scene = load_scene_file(path);
    EXPECT_GT(scene.world.moving_body_count(), 0) << path;
    EXPECT_FALSE(scene.probes.empty()) << path;
    // 1e-12: the files give 16 digits of lengths below 10 m and speeds below 100 m/s.
    const Rows rows(scene.world, Rows::AxisRows::kLeftOut);
    std::vector<double> gaps(rows.row_count());
    rows.residual(scene.world.state(), gaps);
    for (double phi : gaps) EXPECT_LT(std::abs(phi), 1e-12) << path;
    std::vector<double> jacobian(rows.jacobian_size()), rate(rows.row_count());
    rows.jacobian(scene.world.state().poses, jacobian);
    rows.apply(jacobian, scene.world.state().twists, rate);
    for (double r : rate) EXPECT_LT(std::abs(r), 1e-12) << path;
  }
}

TEST(ShippedScenes, Run) {
  for (const auto& path : shipped_scenes()) {
    Scene scene = load_scene_file(path);
    Simulator simulator(scene.world, scene.settings);
    for (int i = 0; i < 50; ++i) {
      const StepReport& report = simulator.step(scene.dt);
      ASSERT_TRUE(report.exact()) << path << " step " << i << ": " << report.message;
      // The tolerance is that of one row, the gap the norm of up to three.
      EXPECT_LE(report.gap.metres, std::sqrt(3.0) * scene.settings.position_tolerance) << path;
    }
  }
}

/// The complete example of the description of the format is read as it stands.
TEST(ShippedScenes, ExampleOfTheReadme) {
  std::ifstream file(std::filesystem::path(testing::source_dir()) / "scenes" / "files" / "FORMAT.md");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::size_t begin = text.find("```json\n") + 8, end = text.find("```", begin);
  ASSERT_NE(end, text.npos);
  const Scene scene = parse_scene(text.substr(begin, end - begin), "FORMAT.md");
  EXPECT_GT(scene.world.joint_count(), 0);
}

}  // namespace
}  // namespace taut::scene_file_test
