#include <gtest/gtest.h>

#include <cmath>

#include "core/joints/joints.h"
#include "scenes/export/mjcf_export.h"
#include "scenes/export/urdf_export.h"
#include "scenes/files/scene_file.h"
#include "scenes/import/imported_model.h"
#include "solvers/simulator/simulator.h"

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
