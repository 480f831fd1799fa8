#include "scenes/builders/vehicle_bridge.h"

#include <numbers>

#include "core/joints/joints.h"
#include "core/state/motion.h"
#include "scenes/builders/bridge.h"
#include "scenes/builders/scene_parts.h"

namespace taut {
namespace {

using namespace scene_parts;

constexpr double kCrossingGravity = 9.81;
constexpr double kCrossingBase = 1.0, kCrossingTrack = 0.6, kCrossingRadius = 0.18,
                 kCrossingWidth = 0.1;  ///< of the vehicle [m]
constexpr double kWheelMass = 5, kTravel = 0.1;
constexpr double kCrossingRubber = 0.8;  ///< friction of tyres
constexpr double kTyreSinks = 0.005;     ///< under its share of the load [m]
constexpr std::uint32_t kCrossingGroundGroup = 1, kPlankGroup = 2, kCrossingWheelGroup = 4;

/// Four driven wheels on hinge-2 joints; x ahead.
struct Vehicle {
  Scene& scene;
  BodyId chassis;
  double load, speed, torque;  ///< [kg, m/s, N·m]

  void add_wheel(int k) {
    World& world = scene.world;
    const char* const names[] = {"front_left", "front_right", "rear_left", "rear_right"};
    const Vec3 p =
        world.pose(chassis).point(Vec3(k < 2 ? kCrossingBase / 2 : -kCrossingBase / 2,
                                       k % 2 == 0 ? kCrossingTrack / 2 : -kCrossingTrack / 2, -kTravel));
    const Pose pose{exp_so3(Vec3(-std::numbers::pi / 2, 0, 0)), p};
    const std::string name = names[k];
    const BodyId wheel =
        world.add_body({.name = name + "_wheel",
                        .mass = MassProperties::cylinder(kCrossingRadius, kCrossingWidth, kWheelMass),
                        .pose = pose});
    draw(scene, wheel, {Cylinder{kCrossingRadius, kCrossingWidth}});
    world.add_shape(wheel, Sphere{kCrossingRadius}, {},
                    rubbing(kCrossingRubber, kTyreSinks / ((0.25 * load + kWheelMass) * kCrossingGravity)),
                    {kCrossingWheelGroup, kCrossingGroundGroup | kPlankGroup});
    const JointId joint = world.add(name, Hinge2::at(world, chassis, wheel, p, Vec3::UnitZ(), Vec3::UnitY()));
    // At rest the spring carries its quarter of the load.
    const double stiffness = load * kCrossingGravity / 0.08, damping = 0.3 * std::sqrt(stiffness * load);
    world.set_spring(
        world.axis(joint, "travel"),
        AxisSpring{
            .stiffness = stiffness, .damping = damping, .rest = -0.25 * load * kCrossingGravity / stiffness});
    world.set_limits(
        world.axis(joint, "travel"),
        AxisLimits{.lower = -kTravel, .upper = kTravel, .compliance = 0.05 / stiffness, .damping = damping});
    world.set_motor(world.axis(joint, "spin"),
                    AxisMotor{.target = speed / kCrossingRadius, .max_force = torque});
    world.add(name + "_steering", Driver(world, world.axis(joint, "steering"), linear_motion(0, 0)));
  }
};

Scene build_crossing(const Parameters& parameters) {
  Scene scene = new_scene("vehicle-bridge", parameters);
  scene.dt = 1e-3;
  World& world = scene.world;
  const Bridge bridge = add_bridge(scene, static_cast<int>(parameters.at("n")), true);
  for (const BodyId plank : bridge.planks)
    world.add_shape(plank, Box{bridge.plank}, {}, rubbing(kCrossingRubber),
                    {kPlankGroup, kCrossingWheelGroup});
  constexpr double kBank = 4, kDepth = 0.5;
  const double top = bridge.plank.z() / 2;
  for (const double side : {-1, 1})
    world.add_shape(kGround, Box{{kBank, 2, kDepth}},
                    {.p = Vec3(side * (bridge.half_span + kBank / 2), 0, top - kDepth / 2)},
                    rubbing(kCrossingRubber), {kCrossingGroundGroup, kCrossingWheelGroup});

  const double load = parameters.at("load"), speed = parameters.at("speed");
  const Vec3 box(1.4, 0.5, 0.2);
  const BodyId chassis = world.add_body(
      {.name = "chassis",
       .mass = MassProperties::box(box, load),
       .pose = {.p = Vec3(-bridge.half_span - kCrossingBase, 0, top + kCrossingRadius + kTravel)}});
  draw(scene, chassis, {Box{box}});
  Vehicle vehicle{scene, chassis, load, speed, 0.1 * load * kCrossingGravity * kCrossingRadius};
  for (int k = 0; k < 4; ++k) vehicle.add_wheel(k);
  scene.duration = std::ceil((2 * bridge.half_span + 2 * kCrossingBase) / speed + 1);
  scene.energy_scale = fall_energy(world, 0.1 * bridge.half_span, scene.duration);
  add_probe(scene, chassis);
  return scene;
}

}  // namespace

std::vector<SceneInfo> crossing_scenes() {
  return {{"vehicle-bridge",
           "a vehicle with four driven, sprung wheels drives over a hanging bridge",
           {size(100, 2, 1e4, "number of planks of 0.2 m"),
            {"load", 20, "kg", "mass of the chassis", 1, 1e4, false},
            {"speed", 2, "m/s", "that the motors of the wheels are set to", 0.1, 10, false}},
           build_crossing}};
}

}  // namespace taut
