#include "scenes/builders/tank.h"

#include <cmath>
#include <numbers>

#include "core/joints/joints.h"
#include "scenes/builders/scene_parts.h"
#include "scenes/builders/track.h"

namespace taut {
namespace {

using namespace scene_parts;

// Lengths [m], masses [kg], forces [N], torques [N·m].
constexpr double kGravityOfTank = 9.81;
constexpr double kGauge = 1.5;  ///< between the middles of the tracks
constexpr double kWheelWidth = 0.16;
constexpr TrackWheel kIdler{1.45, 0.55, 0.22}, kSprocket{-1.45, 0.55, 0.22};
constexpr double kRoadRadius = 0.18, kRoadMass = 20, kDriveMass = 40;
constexpr int kRoadWheels = 5;
constexpr double kFirstRoad = -1.0, kRoadSpacing = 0.5;
const Vec3 kHullSize(3.0, 1.1, 0.5);
constexpr double kHullMass = 3000, kHullHeight = 0.75;

constexpr double kPlate = 0.03, kShoeWidth = 0.4, kGrouser = 0.02, kShoeMassPerMetre = 60;
constexpr double kGuideRadius = 0.015, kGuideHeight = 0.06, kGuideDistance = 0.16;

const Vec3 kArm(-0.25, 0, -0.12);  ///< from its pivot to the wheel
constexpr double kArmMass = 15, kTorsion = 1e4, kTorsionDamping = 500;
constexpr double kTension = 12e3, kTensioner = 2e6, kTensionerDamping = 2e4;
constexpr double kTorque = 6000;
constexpr double kTankStart = 3.5;  ///< of ramp and bumps

// Who touches whom: plates and guides of shoes the wheels, their grousers and the hull the ground.
constexpr std::uint32_t kTankGroundGroup = 1, kHullGroup = 2, kShoeGroup = 4, kTankWheelGroup = 8,
                        kGrouserGroup = 16;
constexpr CollisionFilter kShoeFilter{kShoeGroup, kTankWheelGroup}, kWheelFilter{kTankWheelGroup, kShoeGroup},
    kGrouserFilter{kGrouserGroup, kTankGroundGroup}, kHullFilter{kHullGroup, kTankGroundGroup};

constexpr double kTyre = 5e-7, kPad = 2e-7;  ///< compliance [m/N] of rims and pads of rubber

constexpr double kTankRubber = 0.7, kTeeth = 40;  ///< friction; of a sprocket, in place of its teeth

const Quat kAcross = exp_so3(Vec3(-std::numbers::pi / 2, 0, 0));  ///< z along y

/// One side: wheels, then the track round them.
struct Side {
  Scene& scene;
  BodyId hull;
  std::string name;
  double y, speed;
  int shoes;
  World& world = scene.world;

  BodyId add_wheel(const std::string& wheel, const Vec3& p, double radius, double mass,
                   double friction = kTankRubber) {
    const BodyId body = world.add_body({.name = name + wheel,
                                        .mass = MassProperties::cylinder(radius, kWheelWidth, mass),
                                        .pose = {kAcross, p}});
    world.add_shape(body, Sphere{radius}, {}, rubbing(friction, kTyre), kWheelFilter);
    draw(scene, body, {Cylinder{radius, kWheelWidth}});
    draw(scene, body, {Box{{1.2 * radius, 0.2 * radius, 1.05 * kWheelWidth}}});  // so that it is seen to turn
    return body;
  }
  void add_sprocket() {
    const Vec3 p(kSprocket.x, y, kSprocket.z);
    const BodyId wheel = add_wheel("sprocket", p, kSprocket.radius, kDriveMass, kTeeth);
    const JointId drive = world.add(name + "drive", Hinge::at(world, hull, wheel, p, Vec3::UnitY()));
    AxisMotor motor{.target = speed / (kSprocket.radius + kPlate / 2)};
    motor.force_of_speed = Curve({{0, kTorque}, {10, kTorque}, {40, 0.25 * kTorque}});
    world.set_motor(world.axis(drive, "angle"), motor);
  }
  /// Its spring tensions the track.
  void add_idler() {
    const Vec3 p(kIdler.x, y, kIdler.z);
    const BodyId wheel = add_wheel("idler", p, kIdler.radius, kDriveMass);
    SixDof::Locks locks{{false, true, true}, {true, false, true}};
    const JointId fork =
        world.add(name + "tensioner", SixDof::at(world, hull, wheel, p, Quat::Identity(), locks));
    world.set_spring(
        world.axis(fork, "x"),
        AxisSpring{.stiffness = kTensioner, .damping = kTensionerDamping, .rest = kTension / kTensioner});
  }
  void add_road_wheel(int k, double height) {
    const Vec3 p(kFirstRoad + k * kRoadSpacing, y, height), pivot = p - kArm;
    const BodyId arm = add_rod(scene, name + numbered("arm", k), pivot, p, 0.03, kArmMass);
    const JointId torsion =
        world.add(name + numbered("torsion", k), Hinge::at(world, hull, arm, pivot, Vec3::UnitY()));
    const AxisId angle = world.axis(torsion, "angle");
    const double load = -kArm.x() * kHullMass * kGravityOfTank / (2 * kRoadWheels);
    world.set_spring(angle,
                     AxisSpring{.stiffness = kTorsion, .damping = kTorsionDamping, .rest = -load / kTorsion});
    world.set_limits(angle, AxisLimits{.lower = -0.5, .upper = 0.5, .compliance = 1e-5, .damping = 1000});
    const BodyId wheel = add_wheel(numbered("wheel", k), p, kRoadRadius, kRoadMass);
    world.add(name + numbered("axle", k), Hinge::at(world, arm, wheel, p, Vec3::UnitY()));
  }
  BodyId add_shoe(int k, const Vec3& from, const Vec3& to) {
    const double pitch = (to - from).norm();
    const Vec3 plate(0.94 * pitch, kShoeWidth, kPlate);
    BodySpec body{.name = name + numbered("shoe", k),
                  .mass = MassProperties::box(plate, kShoeMassPerMetre * pitch)};
    body.pose.p = 0.5 * (from + to);
    body.pose.q = exp_so3(Vec3(0, -std::atan2(to.z() - from.z(), to.x() - from.x()), 0));  // z is inwards
    const BodyId shoe = world.add_body(body);
    world.add_shape(shoe, Box{plate}, {}, rubbing(kTankRubber), kShoeFilter);
    const Capsule grouser{kGrouser, kShoeWidth - 2 * kGrouser}, guide{kGuideRadius, kGuideHeight};
    world.add_shape(shoe, grouser, {kAcross, {0, 0, -kPlate / 2}}, rubbing(kTankRubber, kPad),
                    kGrouserFilter);
    const double at = kGuideDistance + kGuideRadius;
    for (const double side : {-at, at})
      world.add_shape(shoe, guide, {Quat::Identity(), {0, side, kGuideHeight / 2}}, Material{}, kShoeFilter);
    return shoe;
  }
  void add_track(const TrackPins& track) {
    const auto pin = [&](int k) {
      const Eigen::Vector2d& p = track.pin[k % shoes];
      return Vec3(p.x(), y, p.y());
    };
    std::vector<BodyId> ring;
    for (int k = 0; k < shoes; ++k) ring.push_back(add_shoe(k, pin(k), pin(k + 1)));
    for (int k = 1; k < shoes; ++k)
      world.add(name + numbered("pin", k), Hinge::at(world, ring[k - 1], ring[k], pin(k), Vec3::UnitY()));
    // The others keep the ring in its plane; hinges all round would be redundant.
    world.add(name + numbered("pin", 0), SixDof::at(world, ring[shoes - 1], ring[0], pin(0), Quat::Identity(),
                                                    {{true, false, true}, {false, false, false}}));
  }
  void add() {
    // The lowest pins are at a height where the grousers stand on the ground.
    std::vector<TrackWheel> wheels{kIdler,
                                   kSprocket,
                                   {kFirstRoad, 0, kRoadRadius},
                                   {kFirstRoad + (kRoadWheels - 1) * kRoadSpacing, 0, kRoadRadius}};
    TrackPins track;
    double height = kRoadRadius + kPlate;
    for (int i = 0; i < 20 && wheels[2].z != height; ++i) {
      wheels[2].z = wheels[3].z = height;
      track = lay_track(wheels, shoes, kPlate / 2);
      height = kPlate / 2 + kGrouser + std::hypot(kRoadRadius + kPlate / 2, track.pitch / 2);
    }
    add_sprocket();
    add_idler();
    for (int k = 0; k < kRoadWheels; ++k) add_road_wheel(k, wheels[2].z);
    add_track(track);
  }
};

void add_ground(Scene& scene, double ramp, int bumps) {
  World& world = scene.world;
  world.add_shape(kGround, HalfSpace{}, {}, rubbing(kTankRubber));
  if (ramp > 0) {
    const double angle = ramp * std::numbers::pi / 180, length = 12, thickness = 0.5;
    const Quat q = exp_so3(Vec3(0, -angle, 0));
    const Vec3 p = Vec3(kTankStart, 0, 0) + q * Vec3(length / 2, 0, -thickness / 2);
    world.add_shape(kGround, Box{{length, 6, thickness}}, {q, p}, rubbing(kTankRubber));
  }
  constexpr double kBumpRadius = 0.3, kBumpHeight = 0.1, kBumpSpacing = 1.2;
  for (int k = 0; k < bumps; ++k)
    world.add_shape(kGround, Cylinder{kBumpRadius, 6},
                    {kAcross, {kTankStart + k * kBumpSpacing, 0, kBumpHeight - kBumpRadius}},
                    rubbing(kTankRubber));
}

Scene build_tank(const Parameters& parameters) {
  Scene scene;
  scene.name = "tank";
  scene.parameters = parameters;
  scene.dt = 1e-3;
  scene.duration = 5;
  World& world = scene.world;
  add_ground(scene, parameters.at("ramp"), static_cast<int>(parameters.at("bumps")));
  const BodyId hull = world.add_body({.name = "hull",
                                      .mass = MassProperties::box(kHullSize, kHullMass),
                                      .pose = {.p = Vec3(0, 0, kHullHeight)}});
  world.add_shape(hull, Box{kHullSize}, {}, Material{}, kHullFilter);
  draw(scene, hull, {Box{kHullSize}});
  draw(scene, hull, {Box{{1.2, 0.9, 0.3}}, {Quat::Identity(), {-0.2, 0, 0.4}}});
  draw(scene, hull, {rod_shape(1.6, 0.05).shape, {rod_shape(1.6, 0.05).pose.q, {1.1, 0, 0.42}}});
  const int n = static_cast<int>(parameters.at("n"));
  for (const double left : {1, -1})
    Side{scene,
         hull,
         left > 0 ? "left_" : "right_",
         left * kGauge / 2,
         parameters.at(left > 0 ? "left" : "right"),
         n}
        .add();
  scene.energy_scale = fall_energy(world, 1, scene.duration);
  add_probe(scene, hull);
  return scene;
}

}  // namespace

std::vector<SceneInfo> tank_scenes() {
  return {
      {"tank",
       "a tracked vehicle: sprocket, idler and road wheels on arms in a ring of hinged shoes on each side",
       {size(60, 30, 300, "number of shoes on each side"),
        {"left", 1.5, "m/s", "speed of the left track", -5, 5, false},
        {"right", 1.5, "m/s", "speed of the right track", -5, 5, false},
        {"ramp", 0, "deg", "of a ramp of 12 m ahead; 0: none", 0, 35, false},
        {"bumps", 0, "", "half-round bumps of 0.1 m across the way", 0, 100, true}},
       build_tank}};
}

}  // namespace taut
