#include "scenes/builders/suspension_bridge.h"

#include <cmath>

#include "core/joints/joints.h"
#include "scenes/builders/scene_parts.h"

namespace taut {
namespace {

using namespace scene_parts;

constexpr double kPlank = 2;  ///< length [m]
const Vec3 kSuspensionPlankSize(kPlank, 3, 0.2);
constexpr double kSag = 0.12;       ///< of the cable, part of the span
constexpr double kClearance = 1.5;  ///< shortest hanger [m]
constexpr double kSuspensionPlankMass = 400, kCableMass = 60;
constexpr double kSuspensionGravity = 9.81;

/// The cable hangs in a parabola; node k is above the seam between planks k − 1 and k.
struct CableShape {
  explicit CableShape(int planks) : n(planks) {}
  double x(double k) const { return kPlank * (k - 0.5 * n); }
  Vec3 node(int k) const {
    const double s = 2.0 * k / n - 1;
    return {x(k), 0, kClearance + kSag * kPlank * n * s * s};
  }
  int n;
};

/// A weight that drives over the planks at constant speed.
ForceCallback driving_weight(std::vector<BodyId> planks, double weight, double speed) {
  const auto force = [planks = std::move(planks), weight, speed](const State& state,
                                                                 std::span<Wrench> wrenches) {
    const double along = speed * state.time, most = kPlank * static_cast<double>(planks.size());
    if (!(along >= 0 && along < most)) return;
    const std::size_t k = std::min(static_cast<std::size_t>(along / kPlank), planks.size() - 1);
    const Pose& plank = state.poses[planks[k].index];
    const Vec3 arm = plank.q * Vec3(along - kPlank * (static_cast<double>(k) + 0.5), 0, 0);
    const Vec3 down(0, 0, -weight);
    wrenches[planks[k].index].force += down;
    wrenches[planks[k].index].torque += arm.cross(down);
  };
  return ForceCallback(force, false);
}

Scene build_suspension_bridge(const Parameters& parameters) {
  const int n = static_cast<int>(parameters.at("n"));
  Scene scene = new_scene("suspension-bridge", parameters);
  World& world = scene.world;
  const CableShape shape(n);
  std::vector<BodyId> planks, cable;
  for (int k = 0; k < n; ++k) {
    BodySpec plank{.name = numbered("plank", k),
                   .mass = MassProperties::box(kSuspensionPlankSize, kSuspensionPlankMass)};
    plank.pose.p = Vec3(shape.x(k + 0.5), 0, 0);
    planks.push_back(world.add_body(plank));
    draw(scene, planks.back(), {Box{kSuspensionPlankSize}});
  }
  for (int k = 0; k < n; ++k)
    cable.push_back(add_rod(scene, numbered("cable", k), shape.node(k), shape.node(k + 1), 0.05, kCableMass));
  const auto seam = [&](int k) { return Vec3(shape.x(k), 0, 0); };
  world.add("left_end", Hinge::at(world, kGround, planks[0], seam(0), Vec3::UnitY()));
  for (int k = 1; k < n; ++k) {
    const JointId joint =
        world.add(numbered("seam", k), Hinge::at(world, planks[k - 1], planks[k], seam(k), Vec3::UnitY()));
    world.set_spring(world.axis(joint, "angle"), AxisSpring{.stiffness = 2e4, .damping = 4e3});
  }
  SixDof::Locks rolls{};
  rolls.translation[2] = true;  // the right end rests on a roller
  world.add("right_end", SixDof::at(world, kGround, planks[n - 1], seam(n), Quat::Identity(), rolls));
  world.add("left_tower", Ball::at(world, kGround, cable[0], shape.node(0)));
  for (int k = 1; k < n; ++k)
    world.add(numbered("cable_joint", k), Ball::at(world, cable[k - 1], cable[k], shape.node(k)));
  world.add("right_tower", Ball::at(world, kGround, cable[n - 1], shape.node(n)));
  for (int k = 1; k < n; ++k) {
    const JointId hanger =
        world.add(numbered("hanger", k), Rope::between(world, cable[k], planks[k], shape.node(k), seam(k)));
    world.set_break(
        hanger, BreakLimits{.force = parameters.at("strength") * kSuspensionPlankMass * kSuspensionGravity});
  }
  for (int k : {0, n}) {  // towers
    const double height = shape.node(k).z();
    draw(scene, kGround, {Cylinder{0.3, height}, {Quat::Identity(), {shape.x(k), 0, height / 2}}});
  }
  const double speed = parameters.at("speed");
  world.add_force(driving_weight(planks, parameters.at("load") * kSuspensionGravity, speed));
  scene.duration = kPlank * n / speed;
  scene.energy_scale = (kSuspensionPlankMass + kCableMass) * n * kSuspensionGravity * kSag * kPlank * n;
  add_probe(scene, planks[n / 2]);
  return scene;
}

}  // namespace

std::vector<SceneInfo> suspension_bridge_scenes() {
  return {{"suspension-bridge",
           "a deck on ropes that break under a load that drives over it",
           {size(20, 2, 1000, "number of planks of 2 m"),
            {"load", 1000, "kg", "mass that drives over the bridge", 0, 1e6, false},
            {"speed", 5, "m/s", "of the load", 0.1, 100, false},
            {"strength", 2.2, "", "force at which a rope breaks, in weights of a plank", 0.1, 1e6, false}},
           build_suspension_bridge}};
}

}  // namespace taut
