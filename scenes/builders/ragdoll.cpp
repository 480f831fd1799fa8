#include "scenes/builders/ragdoll.h"

#include "core/joints/joints.h"
#include "scenes/builders/scene_parts.h"

namespace taut {
namespace {

using namespace scene_parts;

/// x to its left, z up; arms stretched out.
struct Ragdoll {
  Scene& scene;
  std::string prefix{};
  Vec3 origin = Vec3::Zero();
  World& world = scene.world;

  /// A round limb from one point of the doll to another.
  BodyId add_limb(const std::string& name, const Vec3& from, const Vec3& to, double radius, double mass) {
    return add_rod(scene, prefix + name, origin + from, origin + to, radius, mass);
  }

  /// A ball joint whose part may lean by `cone` from where it is and twist by `twist` either way.
  void add_ball(const std::string& name, BodyId a, BodyId b, const Vec3& p, const Vec3& along, double cone,
                double twist) {
    const JointId joint = world.add(prefix + name, Ball::at(world, a, b, origin + p).with_axes(world, along));
    world.set_limits(world.axis(joint, "swing"), AxisLimits{.upper = cone});
    world.set_limits(world.axis(joint, "twist"), AxisLimits{-twist, twist});
    for (const char* turn : {"turn_x", "turn_y", "turn_z"})
      world.set_friction(world.axis(joint, turn), AxisFriction{.viscous = 0.5});
  }
  void add_hinge(const std::string& name, BodyId a, BodyId b, const Vec3& p, const Vec3& axis, double most) {
    const JointId joint = world.add(prefix + name, Hinge::at(world, a, b, origin + p, axis));
    world.set_limits(world.axis(joint, "angle"), AxisLimits{0, most});
    world.set_friction(world.axis(joint, "angle"), AxisFriction{.viscous = 0.5});
  }
  /// `left` is 1 or −1.
  BodyId add_arm(const std::string& side, double left, BodyId chest) {
    const Vec3 x = left * Vec3::UnitX(), shoulder = 0.2 * x + Vec3(0, 0, 0.5), elbow = shoulder + 0.3 * x,
               hand = elbow + 0.35 * x;
    const BodyId upper = add_limb(side + "_upper_arm", shoulder, elbow, 0.05, 2.5);
    const BodyId lower = add_limb(side + "_forearm", elbow, hand, 0.04, 2);
    add_ball(side + "_shoulder", chest, upper, shoulder, x, 1.5, 0.8);
    add_hinge(side + "_elbow", upper, lower, elbow, -left * Vec3::UnitZ(), 2.4);
    return lower;
  }
  void add_leg(const std::string& side, double left, BodyId pelvis) {
    const Vec3 hip = left * Vec3(0.1, 0, 0), knee = hip - Vec3(0, 0, 0.45), foot = knee - Vec3(0, 0, 0.45);
    const BodyId thigh = add_limb(side + "_thigh", hip, knee, 0.08, 8);
    const BodyId shin = add_limb(side + "_shin", knee, foot, 0.05, 4);
    add_ball(side + "_hip", pelvis, thigh, hip, -Vec3::UnitZ(), 0.9, 0.5);
    add_hinge(side + "_knee", thigh, shin, knee, Vec3::UnitX(), 2.2);
  }
  struct Ends {
    BodyId head, left_hand;
  };
  Ends add() {
    const BodyId pelvis = add_limb("pelvis", Vec3(-0.15, 0, 0.05), Vec3(0.15, 0, 0.05), 0.1, 12);
    const BodyId chest = add_limb("chest", Vec3(0, 0, 0.15), Vec3(0, 0, 0.55), 0.15, 20);
    const BodyId head = add_limb("head", Vec3(0, 0, 0.6), Vec3(0, 0, 0.85), 0.1, 5);
    add_ball("waist", pelvis, chest, Vec3(0, 0, 0.15), Vec3::UnitZ(), 0.5, 0.5);
    add_ball("neck", chest, head, Vec3(0, 0, 0.58), Vec3::UnitZ(), 0.6, 0.9);
    const BodyId left = add_arm("left", 1, chest);
    add_arm("right", -1, chest);
    add_leg("left", 1, pelvis);
    add_leg("right", -1, pelvis);
    return {head, left};
  }
};

Scene build_ragdoll(const Parameters& parameters) {
  Scene scene = new_scene("ragdoll", parameters, 10);
  const auto [head, left] = Ragdoll{scene}.add();
  scene.world.add("hand", Ball::at(scene.world, kGround, left, Vec3(0.85, 0, 0.5)));
  scene.energy_scale = fall_energy(scene.world, 1, scene.duration);
  add_probe(scene, head);
  return scene;
}

/// Dolls stand above the upper landing and walk off it.  What touches is capsules; a doll does not touch
/// itself.
Scene build_stairs(const Parameters& parameters) {
  Scene scene = new_scene("ragdoll-stairs", parameters, 4, 1e-3);
  World& world = scene.world;
  constexpr int kSteps = 8;
  constexpr double kRise = 0.18, kGoing = 0.3, kDepth = 1;
  const int n = static_cast<int>(parameters.at("n"));
  const double width = 1.8 * n;
  for (int k = -1; k <= kSteps; ++k) {  // the landing, the steps, the floor
    const double length = k < 0 ? 1 : k == kSteps ? 4 : kGoing;
    const double start = k < 0 ? -1 : kGoing * k;
    world.add_shape(kGround, Box{{width, length, kDepth}},
                    {.p = Vec3(0, start + length / 2, -kRise * (k + 1) - kDepth / 2)});
  }
  BodyId probe{};
  for (int d = 0; d < n; ++d) {
    const int first = world.body_count();
    const Vec3 origin(1.8 * (d - 0.5 * (n - 1)), -0.2, 0.97);
    probe = Ragdoll{scene, n > 1 ? numbered("doll", d) + "_" : "", origin}.add().head;
    const std::uint32_t own = 2u << (d % 30);
    for (int b = first; b < world.body_count(); ++b) {
      // The limb as it is drawn, with round ends inside its length.
      const PlacedShape limb = scene.drawings[scene.drawings.size() - world.body_count() + b].shape;
      const Cylinder& round = std::get<Cylinder>(limb.shape);
      world.add_shape(BodyId{b}, Capsule{round.radius, std::max(0.0, round.length - 2 * round.radius)},
                      limb.pose, {}, {own, ~own});
      // Falling over forwards about the feet.
      const Vec3 w(-parameters.at("speed"), 0, 0), foot = origin - Vec3(0, 0, 0.9);
      world.set_twist(BodyId{b}, {w, w.cross(world.pose(BodyId{b}).p - foot)});
    }
  }
  scene.energy_scale = fall_energy(world, kRise * kSteps, scene.duration);
  add_probe(scene, probe);
  return scene;
}

}  // namespace

std::vector<SceneInfo> ragdoll_scenes() {
  return {{"ragdoll", "a body with limited joints that falls and hangs by one hand", {}, build_ragdoll},
          {"ragdoll-stairs",
           "ragdolls that fall down stairs",
           {size(1, 1, 30, "number of ragdolls"),
            {"speed", 1.5, "rad/s", "at which they fall over at first", 0, 10, false}},
           build_stairs}};
}

}  // namespace taut
