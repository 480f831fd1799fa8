#include "scenes/ragdoll.h"

#include "core/joints.h"
#include "scenes/scene_parts.h"

namespace taut {
namespace {

using namespace scene_parts;

/// x to its left, z up; arms stretched out.
struct Ragdoll {
  Scene& scene;
  World& world = scene.world;

  /// A ball joint whose part may lean by `cone` from where it is and twist by `twist` either way.
  void add_ball(const std::string& name, BodyId a, BodyId b, const Vec3& p, const Vec3& along, double cone,
                double twist) {
    const JointId joint = world.add(name, Ball::at(world, a, b, p).with_axes(world, along));
    world.set_limits(world.axis(joint, "swing"), AxisLimits{.upper = cone});
    world.set_limits(world.axis(joint, "twist"), AxisLimits{-twist, twist});
    for (const char* turn : {"turn_x", "turn_y", "turn_z"})
      world.set_friction(world.axis(joint, turn), AxisFriction{.viscous = 0.5});
  }
  void add_hinge(const std::string& name, BodyId a, BodyId b, const Vec3& p, const Vec3& axis, double most) {
    const JointId joint = world.add(name, Hinge::at(world, a, b, p, axis));
    world.set_limits(world.axis(joint, "angle"), AxisLimits{0, most});
    world.set_friction(world.axis(joint, "angle"), AxisFriction{.viscous = 0.5});
  }
  /// `left` is 1 or −1.
  BodyId add_arm(const std::string& side, double left, BodyId chest) {
    const Vec3 x = left * Vec3::UnitX(), shoulder = 0.2 * x + Vec3(0, 0, 0.5), elbow = shoulder + 0.3 * x,
               hand = elbow + 0.35 * x;
    const BodyId upper = add_rod(scene, side + "_upper_arm", shoulder, elbow, 0.05, 2.5);
    const BodyId lower = add_rod(scene, side + "_forearm", elbow, hand, 0.04, 2);
    add_ball(side + "_shoulder", chest, upper, shoulder, x, 1.5, 0.8);
    add_hinge(side + "_elbow", upper, lower, elbow, -left * Vec3::UnitZ(), 2.4);
    return lower;
  }
  void add_leg(const std::string& side, double left, BodyId pelvis) {
    const Vec3 hip = left * Vec3(0.1, 0, 0), knee = hip - Vec3(0, 0, 0.45), foot = knee - Vec3(0, 0, 0.45);
    const BodyId thigh = add_rod(scene, side + "_thigh", hip, knee, 0.08, 8);
    const BodyId shin = add_rod(scene, side + "_shin", knee, foot, 0.05, 4);
    add_ball(side + "_hip", pelvis, thigh, hip, -Vec3::UnitZ(), 0.9, 0.5);
    add_hinge(side + "_knee", thigh, shin, knee, Vec3::UnitX(), 2.2);
  }
};

Scene build(const Parameters& parameters) {
  Scene scene;
  scene.name = "ragdoll";
  scene.parameters = parameters;
  scene.dt = 1.0 / 240;
  scene.duration = 10;
  Ragdoll doll{scene};
  const BodyId pelvis = add_rod(scene, "pelvis", Vec3(-0.15, 0, 0.05), Vec3(0.15, 0, 0.05), 0.1, 12);
  const BodyId chest = add_rod(scene, "chest", Vec3(0, 0, 0.15), Vec3(0, 0, 0.55), 0.15, 20);
  const BodyId head = add_rod(scene, "head", Vec3(0, 0, 0.6), Vec3(0, 0, 0.85), 0.1, 5);
  doll.add_ball("waist", pelvis, chest, Vec3(0, 0, 0.15), Vec3::UnitZ(), 0.5, 0.5);
  doll.add_ball("neck", chest, head, Vec3(0, 0, 0.58), Vec3::UnitZ(), 0.6, 0.9);
  const BodyId left = doll.add_arm("left", 1, chest);
  doll.add_arm("right", -1, chest);
  doll.add_leg("left", 1, pelvis);
  doll.add_leg("right", -1, pelvis);
  scene.world.add("hand", Ball::at(scene.world, kGround, left, Vec3(0.85, 0, 0.5)));
  scene.energy_scale = fall_energy(scene.world, 1, scene.duration);
  add_probe(scene, head);
  return scene;
}

}  // namespace

std::vector<SceneInfo> ragdoll_scenes() {
  return {{"ragdoll", "a body with limited joints that falls and hangs by one hand", {}, build}};
}

}  // namespace taut
