#include "scenes/builders/mechanisms.h"

#include <cmath>
#include <numbers>

#include "core/joints/joints.h"
#include "core/state/motion.h"
#include "scenes/builders/scene_parts.h"

namespace taut {
namespace {

using namespace scene_parts;

constexpr double kMachineGravity = 9.81;

/// n + 1 cranks on the ground and n couplers, upright, with the coupler pins at 1 m/s: the IFToMM benchmark
/// A02.  Every half turn all bars lie in one line, where the mechanism could fold otherwise.
Scene build_four_bars(const Parameters& parameters) {
  const int n = static_cast<int>(parameters.at("n"));
  Scene scene = new_scene("n-four-bar", parameters, 10, 1e-3);
  World& world = scene.world;
  const Vec3 up = Vec3::UnitZ(), right = Vec3::UnitX(), axis = Vec3::UnitY();
  std::vector<BodyId> cranks;
  for (int k = 0; k <= n; ++k) {
    cranks.push_back(add_rod(scene, numbered("crank", k), k * right, k * right + up, kRodRadius, 1));
    world.set_twist(cranks.back(), {axis, 0.5 * right});
    world.add(numbered("foot", k), Hinge::at(world, kGround, cranks.back(), k * right, axis));
  }
  for (int k = 0; k < n; ++k) {
    const BodyId coupler =
        add_rod(scene, numbered("coupler", k), k * right + up, (k + 1) * right + up, kRodRadius, 1);
    world.set_twist(coupler, {Vec3::Zero(), right});
    world.add(numbered("left", k), Hinge::at(world, cranks[k], coupler, k * right + up, axis));
    world.add(numbered("right", k), Hinge::at(world, cranks[k + 1], coupler, (k + 1) * right + up, axis));
  }
  scene.energy_scale = (2 * n + 1) * kMachineGravity;
  add_probe(scene, cranks[0]);
  return scene;
}

struct Car {
  static constexpr double kTrack = 1.5, kBase = 2.6, kRadius = 0.3, kWidth = 0.2;
  Scene& scene;
  World& world;
  BodyId chassis;
  AxisId spin[4];

  /// Wheels 0 and 1 in front, 0 and 2 on the left; x ahead, z up.
  void add_wheel(int k) {
    const char* const names[] = {"front_left", "front_right", "rear_left", "rear_right"};
    const std::string name = names[k];
    const Vec3 p(k < 2 ? kBase / 2 : -kBase / 2, k % 2 == 0 ? kTrack / 2 : -kTrack / 2, -0.3);
    BodySpec body{.name = name + "_wheel", .mass = MassProperties::cylinder(kRadius, kWidth, 20)};
    body.pose.p = p;
    body.pose.q = exp_so3(Vec3(-std::numbers::pi / 2, 0, 0));  // the cylinder's z along y
    const BodyId wheel = world.add_body(body);
    draw(scene, wheel, {Cylinder{kRadius, kWidth}});
    const JointId joint = world.add(name, Hinge2::at(world, chassis, wheel, p, Vec3::UnitZ(), Vec3::UnitY()));
    world.set_spring(world.axis(joint, "travel"), AxisSpring{.stiffness = 30000, .damping = 1500});
    world.set_limits(world.axis(joint, "travel"),
                     AxisLimits{.lower = -0.15, .upper = 0.15, .compliance = 1e-6, .damping = 2000});
    spin[k] = world.axis(joint, "spin");
    world.set_friction(spin[k], AxisFriction{1, 1, 0.05});
    const bool steered = k < 2;
    const Motion steering = steered ? harmonic_motion(0, 0.4, std::numbers::pi) : linear_motion(0, 0);
    world.add(name + "_steering", Driver(world, world.axis(joint, "steering"), steering));
  }
  /// The engine's torque depends on its speed; four turns of it are one of the shaft that the differential
  /// shares among the rear wheels.
  void add_engine() {
    const Vec3 half_crank(0.05, 0, 0), half_shaft(0.5, 0, 0), crank(1.2, 0, 0), shaft(-0.5, 0, 0);
    const BodyId engine = add_rod(scene, "crankshaft", crank - half_crank, crank + half_crank, 0.15, 15);
    const BodyId cardan = add_rod(scene, "shaft", shaft - half_shaft, shaft + half_shaft, 0.05, 10);
    const JointId bearing = world.add("engine", Hinge::at(world, chassis, engine, crank, Vec3::UnitX()));
    const JointId shaft_bearing =
        world.add("shaft_bearing", Hinge::at(world, chassis, cardan, shaft, Vec3::UnitX()));
    const AxisId speed = world.axis(bearing, "angle"), input = world.axis(shaft_bearing, "angle");
    AxisMotor motor{.target = 600};
    motor.force_of_speed = Curve({{0, 80}, {100, 120}, {300, 180}, {450, 150}, {600, 0}});
    world.set_motor(speed, motor);
    world.set_friction(speed, AxisFriction{5, 5, 0.01});
    world.add("gearbox", Gear(world, speed, input, 0.25));
    world.add("differential", Differential(world, input, spin[2], spin[3]));
  }
};

Scene build_car(const Parameters& parameters) {
  Scene scene = new_scene("car", parameters, 5, 1e-3);
  World& world = scene.world;
  const BodyId chassis =
      world.add_body({.name = "chassis", .mass = MassProperties::box(Vec3(4, 1.6, 0.6), 1100)});
  world.add("stand", Fixed::at(world, kGround, chassis, Vec3(0, 0, -0.3)));
  // Of the body only frame and axles are drawn, so that what moves can be seen.
  draw(scene, chassis, {Box{{4, 0.4, 0.05}}, {Quat::Identity(), {0, 0, -0.3}}});
  for (const double side : {-1, 1})
    draw(scene, chassis,
         {Box{{0.1, Car::kTrack - Car::kWidth, 0.05}}, {Quat::Identity(), {side * Car::kBase / 2, 0, -0.3}}});
  Car car{scene, world, chassis, {}};
  for (int k = 0; k < 4; ++k) car.add_wheel(k);
  car.add_engine();
  scene.energy_scale = 0.5 * 0.17 * 600 * 600;  // the crankshaft at its highest speed
  add_probe(scene, world.body("front_left_wheel"));
  return scene;
}

/// Shoulder, elbow and wrist of a robot in the xz plane at the start: the axes z, y, y, x, y, x.
Scene build_robot(const Parameters& parameters) {
  Scene scene = new_scene("robot-arm", parameters, 6, 1e-3);
  World& world = scene.world;
  struct Link {
    const char* name;
    Vec3 from, to, axis;
    double mass, radius, torque, swing, limit;  // torque of its motor, how far it swings and may turn
  };
  const Link links[] = {
      {"base", {0, 0, 0}, {0, 0, 0.4}, Vec3::UnitZ(), 20, 0.1, 200, 1.2, 3},
      {"upper_arm", {0, 0, 0.4}, {0, 0, 1.0}, Vec3::UnitY(), 15, 0.07, 300, 0.6, 3},
      {"forearm", {0, 0, 1.0}, {0.3, 0, 1.0}, Vec3::UnitY(), 8, 0.05, 150, 0.7, 3},
      {"forearm_end", {0.3, 0, 1.0}, {0.6, 0, 1.0}, Vec3::UnitX(), 5, 0.05, 30, 1.5, 3},
      {"wrist", {0.6, 0, 1.0}, {0.7, 0, 1.0}, Vec3::UnitY(), 2, 0.04, 30, 0.8, 3},
      {"flange", {0.7, 0, 1.0}, {0.75, 0, 1.0}, Vec3::UnitX(), 1, 0.03, 10, 2.5, 6},
  };
  const double torque = parameters.at("torque");
  BodyId last = kGround;
  for (const Link& link : links) {
    const BodyId here = add_rod(scene, link.name, link.from, link.to, link.radius, link.mass);
    const JointId joint = world.add(std::string("axis_") + std::to_string(here.index),
                                    Hinge::at(world, last, here, link.from, link.axis));
    const AxisId angle = world.axis(joint, "angle");
    AxisMotor motor{.mode = AxisMotor::Mode::kTrajectory, .max_force = torque * link.torque};
    const double phase = 0.4 * here.index;
    motor.trajectory =
        harmonic_motion(-link.swing * std::sin(phase), link.swing, 2 * std::numbers::pi / 3, phase);
    world.set_motor(angle, motor);
    world.set_limits(angle, AxisLimits{.lower = -link.limit, .upper = link.limit});
    last = here;
  }
  scene.energy_scale = 51 * kMachineGravity * 1.0;
  add_probe(scene, last);
  return scene;
}

/// The wire goes from the winch's carriage over two sheaves at the tip to the hook; a rope from the mast
/// holds the boom.
Scene build_crane(const Parameters& parameters) {
  Scene scene = new_scene("crane", parameters, 8, 2e-3);
  World& world = scene.world;
  const Vec3 foot(0, 0, 1), tip(8, 0, 7), mast(-2, 0, 8), axis = Vec3::UnitY();
  draw(scene, kGround, {Cylinder{0.15, mast.z()}, {Quat::Identity(), {mast.x(), 0, mast.z() / 2}}});
  const BodyId boom = add_rod(scene, "boom", foot, tip, 0.2, 800);
  world.add("boom_foot", Hinge::at(world, kGround, boom, foot, axis));
  world.add("luffing_rope", Rope::between(world, kGround, boom, mast, tip));

  const Vec3 winch(-1, 0, 1), drum(0.5, 0.5, 0.5);
  const BodyId carriage =
      world.add_body({.name = "winch", .mass = MassProperties::box(drum, 100), .pose = {.p = winch}});
  draw(scene, carriage, {Box{drum}});
  const JointId guide = world.add("winch_guide", Slider::at(world, kGround, carriage, winch, -Vec3::UnitX()));
  const double speed = parameters.at("speed");
  world.add("winch_drive", Driver(world, world.axis(guide, "displacement"),
                                  speed_motion(Curve({{0, 0}, {1, speed}, {4, speed}, {5, 0}}), 0)));
  const Vec3 hook_at = tip + Vec3(0.3, 0, -4);
  const BodyId hook = world.add_body(
      {.name = "hook", .mass = MassProperties::sphere(0.3, parameters.at("load")), .pose = {.p = hook_at}});
  draw(scene, hook, {Sphere{0.3}});
  world.add("hoist_wire", Pulley::at(world, carriage, winch, boom, tip + Vec3(0, 0, 0.3),
                                     tip + Vec3(0.3, 0, 0), hook, hook_at));
  scene.energy_scale = (800 * 4 + parameters.at("load") * 4) * kMachineGravity;
  add_probe(scene, hook);
  return scene;
}

}  // namespace

std::vector<SceneInfo> machine_scenes() {
  return {
      {"n-four-bar",
       "n four-bar windows of 1 m that turn through their singular positions",
       {size(5, 1, 1000, "number of windows")},
       build_four_bars},
      {"car", "a car on a stand: engine, differential, sprung and steered wheels", {}, build_car},
      {"robot-arm",
       "six axes that follow a trajectory with limited torques",
       {{"torque", 1, "", "factor of the torques that the motors have", 0.01, 100, false}},
       build_robot},
      {"crane",
       "a boom on a rope, and a load on a wire over sheaves that a winch pulls in",
       {{"load", 500, "kg", "mass on the hook", 1, 1e5, false},
        {"speed", 0.5, "m/s", "of the winch", -2, 2, false}},
       build_crane},
  };
}

}  // namespace taut
