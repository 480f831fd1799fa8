#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/joints/joints.h"
#include "scenes/export/mjcf_export.h"
#include "scenes/export/urdf_export.h"
#include "scenes/files/scene_file.h"
#include "scenes/import/imported_model.h"
#include "solvers/simulator/simulator.h"
#include "tests/source_dir.h"

// A scene that was a model in between moves as the scene.
namespace taut::model_export_test {
namespace {

using Writer = std::string (*)(const Scene&, std::vector<std::string>&);

Scene there_and_back(const Scene& scene, Writer write, const char* name, std::vector<std::string>& notices) {
  const std::string text = write(scene, notices);
  return parse_scene(import_model_text(text, name).document.dump(), name);
}

/// Where bodies of the first scene are in both after 0.2 s; the second may have bodies between joints.
double difference(Scene a, Scene b) {
  const auto run = [](Scene& scene) {
    scene.settings.contacts = false;
    Simulator simulator(scene.world, scene.settings);
    if (scene.assemble) {
      EXPECT_TRUE(simulator.assemble().exact());
    }
    for (int i = 0; i < 200; ++i) EXPECT_TRUE(simulator.step(1e-3).exact()) << simulator.report().message;
  };
  run(a), run(b);
  double largest = 0;
  for (int i = 1; i < a.world.body_count(); ++i) {
    const Pose &A = a.world.pose(BodyId{i}), &B = b.world.pose(b.world.body(a.world.name(BodyId{i})));
    largest = std::max({largest, (A.p - B.p).norm(), (A.q * B.q.conjugate()).vec().norm()});
  }
  return largest;
}

Scene arm() {
  Scene scene;
  scene.name = "arm";
  World& w = scene.world;
  const auto rod = [&](const char* name, const Vec3& p, const Vec3& turn = Vec3::Zero()) {
    return w.add_body(
        {.name = name, .mass = MassProperties::box({0.9, 0.2, 0.1}, 2), .pose = {exp_so3(turn), p}});
  };
  const BodyId a = rod("a", {0.5, 0, 0}), b = rod("b", {1, 0.5, 0}, {0.3, 0, 1.5}),
               c = rod("c", {1, 1, 0.5}, {0, -1, 0});
  const JointId hip = w.add("hip", Hinge::at(w, kGround, a, Vec3::Zero(), Vec3::UnitY()));
  const JointId slide = w.add("slide", Slider::at(w, a, b, Vec3(1, 0.3, 0), Vec3(0.6, 0, 0.8)));
  const JointId wrist = w.add("wrist", Hinge::at(w, c, b, Vec3(1, 1, 0), Vec3(0, 0.6, 0.8)));
  w.set_spring(w.axis(hip, "angle"), AxisSpring{.stiffness = 30, .damping = 0.5, .rest = 0.2});
  w.set_limits(w.axis(slide, "displacement"), AxisLimits{.lower = -2, .upper = 3});
  w.set_friction(w.axis(wrist, "angle"),
                 AxisFriction{.static_friction = 0.05, .dynamic_friction = 0.05, .viscous = 0.1});
  w.add_shape(a, Box{{0.9, 0.2, 0.1}});
  w.add_shape(b, Capsule{0.1, 0.5}, {exp_so3(Vec3(0, 1, 0)), Vec3(0.1, 0, 0)});
  return scene;
}

TEST(ModelExport, AnArmAsMjcfMovesAsTheScene) {
  std::vector<std::string> notices;
  const Scene scene = arm();
  EXPECT_LT(difference(scene, there_and_back(scene, mjcf_of, "arm.xml", notices)), 1e-9);
  EXPECT_TRUE(notices.empty()) << notices[0];
}

/// Of an arm, of joints of several axes, and of what is free.
TEST(ModelExport, VelocitiesAtTheStartAreTheKeyOfAMjcf) {
  Scene scene = arm();
  World& w = scene.world;
  const auto body = [&](const char* name, const Vec3& p) {
    return w.add_body(
        {.name = name, .mass = MassProperties::box({0.3, 0.2, 0.1}, 1), .pose = {exp_so3(p), p}});
  };
  const BodyId d = body("d", {1, 3, 0}), e = body("e", {2, 3, 0.5}), f = body("f", {0, 5, 0}),
               g = body("g", {0.5, 6, 0});
  const JointId cardan =
      w.add("cardan", Universal::at(w, kGround, d, Vec3(0, 3, 0), Vec3::UnitY(), Vec3::UnitZ()));
  w.add("ball", Ball::at(w, d, e, Vec3(1.5, 3, 0)));
  w.add("weld", Fixed::at(w, f, g, Vec3(0, 5.5, 0)));
  const auto move = [&](BodyId id, const Vec3& anchor, const Vec3& v, const Vec3& spin) {
    w.set_twist(id, {spin, v + spin.cross(w.pose(id).p - anchor)});
  };
  const BodyId a = w.body("a"), b = w.body("b"), c = w.body("c");
  const auto of = [&](BodyId id, const Vec3& at) { return w.twist(id).at(at - w.pose(id).p); };
  move(a, Vec3::Zero(), Vec3::Zero(), Vec3(0, 0.7, 0));
  move(b, Vec3(1, 0.3, 0), of(a, Vec3(1, 0.3, 0)) + 0.4 * Vec3(0.6, 0, 0.8), w.twist(a).w);
  move(c, Vec3(1, 1, 0), of(b, Vec3(1, 1, 0)), w.twist(b).w + 0.9 * Vec3(0, 0.6, 0.8));
  move(d, Vec3(0, 3, 0), Vec3::Zero(), Vec3(0, 1.1, -0.6));
  move(e, Vec3(1.5, 3, 0), of(d, Vec3(1.5, 3, 0)), Vec3(0.3, -0.2, 0.5));
  move(f, w.pose(f).p, Vec3(1, -2, 3), Vec3(0.4, 0.5, -0.6));
  move(g, w.pose(g).p, of(f, w.pose(g).p), w.twist(f).w);
  (void)cardan;
  std::vector<std::string> notices;
  const Scene back = there_and_back(scene, mjcf_of, "m.xml", notices);
  EXPECT_TRUE(notices.empty()) << notices[0];
  for (int i = 1; i < w.body_count(); ++i) {
    const Twist &there = w.twist(BodyId{i}), &here = back.world.twist(back.world.body(w.name(BodyId{i})));
    EXPECT_LT((there.v - here.v).norm(), 1e-13) << w.name(BodyId{i});
    EXPECT_LT((there.w - here.w).norm(), 1e-13) << w.name(BodyId{i});
  }
  EXPECT_LT(difference(scene, back), 1e-8);
  // What a joint forbids is named; URDF has no velocities.
  move(a, Vec3::Zero(), Vec3(0, 0, 1), Vec3(0, 0.7, 0));
  (void)mjcf_of(scene, notices);
  ASSERT_FALSE(notices.empty());
  EXPECT_EQ(notices[0], "a: a velocity at the start that its joint does not allow has no counterpart");
  notices.clear();
  (void)urdf_of(scene, notices);
  EXPECT_NE(std::find(notices.begin(), notices.end(), "velocities at the start have no counterpart"),
            notices.end());
}

TEST(ModelExport, AnArmAsUrdfMovesAsTheSceneWithoutItsSpring) {
  std::vector<std::string> notices;
  Scene scene = arm();
  const Scene back = there_and_back(scene, urdf_of, "arm.urdf", notices);
  EXPECT_NE(std::find(notices.begin(), notices.end(), "hip angle: a spring has no counterpart"),
            notices.end());
  scene.world.set_spring(scene.world.axis(scene.world.joint("hip"), "angle"), AxisSpring{.damping = 0.5});
  EXPECT_LT(difference(scene, back), 1e-9);
}

TEST(ModelExport, JointsOfSeveralAxesAsMjcf) {
  Scene scene;
  World& w = scene.world;
  const auto body = [&](const Vec3& p) {
    return w.add_body({.mass = MassProperties::box({0.3, 0.2, 0.1}, 1), .pose = {exp_so3(p), p}});
  };
  const BodyId a = body({1, 0, 0}), b = body({2, 0, 0.5}), c = body({3, 0.2, 0}), d = body({4, 0, 0}),
               free = body({0, 5, 0});
  w.add("cardan", Universal::at(w, kGround, a, Vec3::Zero(), Vec3::UnitY(), Vec3::UnitZ()));
  w.add("ball", Ball::at(w, a, b, Vec3(1.5, 0, 0)));
  w.add("tube", Cylindrical::at(w, b, c, Vec3(2.5, 0, 0), Vec3(0.6, 0, 0.8)));
  w.add("table", Planar::at(w, kGround, d, Vec3(4, 0, 0), Vec3(0, 0.6, 0.8), Vec3::UnitX()));
  (void)free;
  std::vector<std::string> notices;
  EXPECT_LT(difference(scene, there_and_back(scene, mjcf_of, "m.xml", notices)), 1e-8);
  EXPECT_TRUE(notices.empty()) << notices[0];
}

TEST(ModelExport, LoopsGearsRopesAndSpringsAsMjcf) {
  Scene scene;
  World& w = scene.world;
  const auto rod = [&](const char* name, const Vec3& p) {
    return w.add_body(
        {.name = name, .mass = MassProperties::box({0.2, 0.1, 1}, 1), .pose = {Quat::Identity(), p}});
  };
  const BodyId a = rod("a", {0, 0, 0.5}), b = rod("b", {1, 0, 0.5}), c = rod("c", {0.5, 0, 1}),
               d = rod("d", {3, 0, 0.5}), e = rod("e", {5, 0, 0.5});
  w.add("a0", Hinge::at(w, kGround, a, Vec3::Zero(), Vec3::UnitY()));
  w.add("b0", Hinge::at(w, kGround, b, Vec3::UnitX(), Vec3::UnitY()));
  w.add("ac", Hinge::at(w, a, c, Vec3(0, 0, 1), Vec3::UnitY()));
  w.add("cb", Ball::at(w, c, b, Vec3(1, 0, 1)));
  w.add("d0", Hinge::at(w, kGround, d, Vec3(3, 0, 0), Vec3::UnitY()));
  w.add("gear", Gear(w, w.axis(w.joint("a0"), "angle"), w.axis(w.joint("d0"), "angle"), -2));
  w.add("rope", Rope(kGround, e, Vec3(5, 0, 2), Vec3(0, 0, 0.5), 1));
  w.add_force(SpringDamper(kGround, d, Vec3(4, 0, 1), Vec3(0, 0, 0.5), 20, 0.7, 0.3));
  std::vector<std::string> notices;
  const Scene back = there_and_back(scene, mjcf_of, "m.xml", notices);
  EXPECT_TRUE(notices.empty()) << notices[0];
  EXPECT_EQ(back.world.joint_count(), scene.world.joint_count());
  EXPECT_LT(difference(scene, back), 1e-8);
}

/// From a body to what it hangs on: slides that turn with hinges, and a universal joint.
TEST(ModelExport, JointsTowardsTheGroundAsMjcf) {
  Scene scene;
  World& w = scene.world;
  const auto body = [&](const Vec3& p) {
    return w.add_body({.mass = MassProperties::box({0.3, 0.2, 0.1}, 1), .pose = {exp_so3(p), p}});
  };
  const BodyId a = body({1, 0, 0}), b = body({1.5, 0, 0.5});
  SixDof::Locks locks{{false, true, true}, {true, true, false}};
  w.add("out", SixDof::at(w, a, kGround, Vec3(0.2, 0, 0), Quat(0.5, 0.5, 0.5, 0.5), locks));
  w.add("cardan", Universal::at(w, b, a, Vec3(1.2, 0, 0.2), Vec3::UnitY(), Vec3::UnitZ()));
  std::vector<std::string> notices;
  EXPECT_LT(difference(scene, there_and_back(scene, mjcf_of, "m.xml", notices)), 1e-8);
  EXPECT_TRUE(notices.empty()) << notices[0];
}

/// Which are a wire of constant length, and a sum of joints.
TEST(ModelExport, BarsAndDifferentialsAsMjcf) {
  Scene scene;
  World& w = scene.world;
  const auto rod = [&](const char* name, const Vec3& p) {
    return w.add_body(
        {.name = name, .mass = MassProperties::box({0.2, 0.1, 1}, 1), .pose = {Quat::Identity(), p}});
  };
  AxisId axis[3];
  for (int k = 0; k < 3; ++k) {
    const BodyId body = rod(std::string(1, static_cast<char>('a' + k)).c_str(), {k + 1.0, 0, 0.5});
    const JointId hinge = w.add("h" + std::to_string(k),
                                Hinge::at(w, kGround, body, Vec3(k + 1 - 0.3 * k, 0, 0), Vec3::UnitY()));
    axis[k] = w.axis(hinge, "angle");
  }
  w.add("gears", Differential(w, axis[0], axis[1], axis[2]));
  w.add("bar",
        Distance(kGround, rod("d", {5, 0, 0.5}), Vec3(5, 0.5, 2), Vec3(0, 0, 0.5), std::hypot(1, 0.5)));
  std::vector<std::string> notices;
  const Scene back = there_and_back(scene, mjcf_of, "m.xml", notices);
  EXPECT_TRUE(notices.empty()) << notices[0];
  EXPECT_EQ(back.world.joint_count(), scene.world.joint_count());
  EXPECT_LT(difference(scene, back), 1e-8);
}

/// A closing hinge is two points, a fixed joint three, and a ball one, also in the tree.
TEST(ModelExport, LoopsAsUrdf) {
  for (const std::string kind : {"ball", "hinge", "fixed"}) {
    Scene scene;
    World& w = scene.world;
    const auto rod = [&](const char* name, const Vec3& p) {
      return w.add_body(
          {.name = name, .mass = MassProperties::box({0.2, 0.1, 1}, 1), .pose = {exp_so3(p), p}});
    };
    const BodyId a = rod("a", {0, 0, 0.5}), b = rod("b", {1, 0, 0.5}), c = rod("c", {0.5, 0, 1}),
                 d = rod("d", {2, 0, 1});
    w.add("a0", Hinge::at(w, kGround, a, Vec3::Zero(), Vec3::UnitY()));
    w.add("b0", Hinge::at(w, kGround, b, Vec3::UnitX(), Vec3::UnitY()));
    w.add("ac", Hinge::at(w, a, c, Vec3(0, 0, 1), Vec3::UnitY()));
    w.add("bd", Ball::at(w, b, d, Vec3(1.5, 0, 1)));
    if (kind == "ball") w.add("cb", Ball::at(w, c, b, Vec3(1, 0, 1)));
    if (kind == "hinge") w.add("cb", Hinge::at(w, c, b, Vec3(1, 0, 1), Vec3::UnitY()));
    if (kind == "fixed") w.add("cb", Fixed::at(w, c, b, Vec3(1, 0, 1)));
    std::vector<std::string> notices;
    const Scene back = there_and_back(scene, urdf_of, "m.urdf", notices);
    EXPECT_EQ(notices.size(), 1u) << notices[0];  // gravity and contacts
    EXPECT_EQ(back.world.joint_count(), scene.world.joint_count());
    EXPECT_EQ(back.world.joint(back.world.joint("cb")).type(), kind);
    EXPECT_FALSE(back.assemble);
    EXPECT_LT(difference(scene, back), 1e-8) << kind;
  }
}

/// Two position servos, one of which has not the force that it needs, and two of velocity.
Scene servo_arm() {
  return load_scene_file(std::string(testing::source_dir()) + "/tests/scenes/export/servo_arm.json");
}
std::string text_of(const std::string& name) {
  std::ifstream file(std::string(testing::source_dir()) + "/tests/scenes/export/" + name);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// `mujoco_motion.py` has had MuJoCo move servo_arm.xml, which is what the scene is as MJCF.  Both go by
/// steps of 1e-4 s of order 2 or more; where a force reaches its bound, by some 1e-8 m.
TEST(ModelExport, ServosMoveAsThoseOfMuJoCo) {
  Scene scene = servo_arm();
  std::vector<std::string> notices;
  EXPECT_EQ(mjcf_of(scene, notices), text_of("servo_arm.xml"));
  EXPECT_TRUE(notices.empty()) << notices[0];
  const auto motion = nlohmann::json::parse(text_of("servo_arm.motion.json"));
  Simulator simulator(scene.world, scene.settings);
  const double time = motion["time"];
  for (int i = 0; i < std::lround(time / 1e-4); ++i)
    ASSERT_TRUE(simulator.step(1e-4).exact()) << simulator.report().message;
  for (const auto& [name, p] : motion["positions"].items()) {
    const Vec3 there(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
    EXPECT_LT((scene.world.pose(scene.world.body(name)).p - there).norm(), 5e-8) << name;
  }
}

TEST(ModelExport, ServosComeBackAsTheyWere) {
  const Scene scene = servo_arm();
  std::vector<std::string> notices;
  const Scene back = there_and_back(scene, mjcf_of, "m.xml", notices);
  for (int j = 0; j < scene.world.joint_count(); ++j) {
    const auto& before = scene.world.axis_properties({{j}, 0}).motor;
    const auto& after = back.world.axis_properties({back.world.joint(scene.world.name(JointId{j})), 0}).motor;
    ASSERT_TRUE(before && after);
    EXPECT_EQ(before->mode, after->mode);
    EXPECT_EQ(before->target, after->target);
    EXPECT_EQ(before->stiffness, after->stiffness);
    EXPECT_EQ(before->damping, after->damping);
    EXPECT_EQ(before->max_force, after->max_force);
  }
  EXPECT_LT(difference(scene, back), 1e-9);
}

/// Each by its kind and its bodies.
TEST(ModelExport, ForcesWithoutACounterpartAreNamed) {
  Scene scene = arm();
  World& w = scene.world;
  const BodyId a = w.body("a"), b = w.body("b");
  w.add_force(SpringDamper(a, b, Vec3::Zero(), Vec3::Zero(), 1, 0, 0));
  w.add_force(PointForce(a, Vec3::Zero(), Vec3::UnitX()));
  w.add_force(BodyTorque(b, Vec3::UnitX()));
  std::vector<std::string> notices;
  (void)mjcf_of(scene, notices);
  EXPECT_EQ(notices, (std::vector<std::string>{R"(force 1 (point-force on "a"): has no counterpart)",
                                               R"(force 2 (torque on "b"): has no counterpart)"}));
  notices.clear();
  (void)urdf_of(scene, notices);
  EXPECT_NE(
      std::find(notices.begin(), notices.end(), R"(force 0 (spring-damper on "a", "b"): has no counterpart)"),
      notices.end());
}

/// A motor that keeps its target is a servo, which is named, and which comes near to it; what else it has is
/// named.
TEST(ModelExport, ExactMotorsAreStiffServos) {
  Scene scene = arm();
  World& w = scene.world;
  const AxisId hip = w.axis(w.joint("hip"), "angle"), slide = w.axis(w.joint("slide"), "displacement"),
               wrist = w.axis(w.joint("wrist"), "angle");
  w.set_motor(hip, AxisMotor{.mode = AxisMotor::Mode::kPosition, .target = 0.02, .max_speed = 3});
  w.set_motor(slide, AxisMotor{.target = 0.5});
  w.set_motor(wrist, AxisMotor{.mode = AxisMotor::Mode::kTrajectory, .trajectory = linear_motion(0, 1)});
  std::vector<std::string> notices;
  Scene back = there_and_back(scene, mjcf_of, "m.xml", notices);
  const auto says = [&](const std::string& what) {
    return std::any_of(notices.begin(), notices.end(),
                       [&](const std::string& n) { return n.rfind(what, 0) == 0; });
  };
  EXPECT_TRUE(says("hip angle: a motor that keeps its target exactly is a servo (value: stiffness "));
  EXPECT_TRUE(says("hip angle: the highest speed of a motor has no counterpart"));
  EXPECT_TRUE(says("slide displacement: a motor that keeps its target exactly is a servo"));
  EXPECT_TRUE(says("wrist angle: a motor along a trajectory has no counterpart"));
  EXPECT_EQ(notices.size(), 4u);
  back.settings.contacts = false;
  Simulator simulator(back.world, back.settings);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulator.step(back.dt).exact()) << simulator.report().message;
  EXPECT_NEAR(back.world.axis_value(back.world.axis(back.world.joint("hip"), "angle")), 0.02, 5e-3);
  EXPECT_NEAR(back.world.axis_rate(back.world.axis(back.world.joint("slide"), "displacement")), 0.5, 0.02);
}

TEST(ModelExport, WhatHasNoCounterpartIsNamed) {
  Scene scene = build_scene("crane");
  std::vector<std::string> mjcf, urdf;
  (void)mjcf_of(scene, mjcf);
  (void)urdf_of(scene, urdf);
  EXPECT_FALSE(mjcf.empty());
  EXPECT_FALSE(urdf.empty());
  for (const SceneInfo& info : scene_catalogue()) {
    std::vector<std::string> notices;
    const Scene each = build_scene(info.name);
    if (each.world.body_count() >= 150) continue;
    EXPECT_NO_THROW((void)import_model_text(mjcf_of(each, notices), "m.xml")) << info.name;
  }
}

}  // namespace
}  // namespace taut::model_export_test
