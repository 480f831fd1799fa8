#include "scenes/builders/bridge.h"

#include <cmath>
#include <numbers>

#include "core/joints/ball.h"
#include "core/joints/fixed.h"
#include "core/joints/hinge.h"
#include "scenes/builders/drawing.h"
#include "scenes/builders/scene_parts.h"

namespace taut {
namespace {

using namespace scene_parts;

constexpr double kBridgeArc = 0.2;  ///< θ: half the angle of the arc [rad]
constexpr double kHalfPlank = 0.1;  ///< half a plank along the bridge [m]
const Vec3 kBridgePlankSize(2 * kHalfPlank, 1.0, 0.05), kTruckSize(1.0, 0.8, 0.5);  // [m]
constexpr double kBridgePlankMass = 5;                                              // [kg]
constexpr double kBallOffset = 0.4;  ///< of the ball joints from the middle of a seam [m]

/// Vertex k of the arc: V_k = (R sin φ, 0, R (cos θ − cos φ)) with φ(k) = θ (2k/n − 1) and R such that all
/// chords are 0.2 m.
struct Arc {
  explicit Arc(int planks) : n(planks), radius(kHalfPlank / std::sin(kBridgeArc / planks)) {}
  double angle(double k) const { return kBridgeArc * (2 * k / n - 1); }
  Vec3 vertex(int k) const {
    return {radius * std::sin(angle(k)), 0, radius * (std::cos(kBridgeArc) - std::cos(angle(k)))};
  }
  Pose plank(int k) const {
    Pose pose;
    pose.p = (vertex(k) + vertex(k + 1)) / 2;
    pose.q = exp_so3(Vec3(0, -angle(k + 0.5), 0));
    return pose;
  }
  int n;
  double radius;
};

void add_seam(World& world, int index, BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ, bool hinge) {
  const std::string name = numbered("seam", index);
  if (hinge) {
    world.add(name, Hinge(a, b, p_AP, Vec3::UnitY(), p_BQ, Vec3::UnitY()));
    return;
  }
  const Vec3 left(0, kBallOffset, 0);
  world.add(name + "_right", Ball(a, b, p_AP - left, p_BQ - left));
  world.add(name + "_left", Ball(a, b, p_AP + left, p_BQ + left));
}

/// A load bed with a cab and six wheels, for the eye; in mechanics it is one box of kTruckSize.
void draw_truck(Scene& scene, BodyId truck) {
  const Quat across = exp_so3(Vec3(std::numbers::pi / 2, 0, 0));
  draw(scene, truck, {Box{{0.66, 0.76, 0.24}}, {Quat::Identity(), {-0.17, 0, 0.02}}});
  draw(scene, truck, {Box{{0.30, 0.72, 0.40}}, {Quat::Identity(), {0.35, 0, 0.05}}});
  draw(scene, truck, {Box{{1.0, 0.60, 0.06}}, {Quat::Identity(), {0, 0, -0.13}}});
  for (const double x : {-0.36, -0.12, 0.34})
    for (const double y : {-0.33, 0.33}) draw(scene, truck, {Cylinder{0.11, 0.14}, {across, {x, y, -0.14}}});
}

void add_truck(Scene& scene, BodyId plank) {
  World& world = scene.world;
  BodySpec body{.name = "truck", .mass = MassProperties::box(kTruckSize, 2000)};
  body.pose = world.pose(plank);
  body.pose.p = world.pose(plank).point(Vec3(0, 0, 0.275));
  const BodyId truck = world.add_body(body);
  draw_truck(scene, truck);
  world.add("truck_weld", Fixed(plank, truck, Vec3(0, 0, 0.025), Vec3(0, 0, -0.25), Quat::Identity()));
}

Scene build_bridge(const char* name, bool hinges, const Parameters& parameters) {
  const int n = static_cast<int>(parameters.at("n"));
  const bool truck = parameters.at("truck") != 0;
  Scene scene = new_scene(name, parameters, duration_for(n, {{10, 5.0}, {200, 2.0}, {1000, 1.0}}));
  World& world = scene.world;

  const std::vector<BodyId> planks = add_bridge(scene, n, hinges).planks;
  if (truck) add_truck(scene, planks[n / 2]);
  scene.energy_scale = fall_energy(world, -Arc(n).vertex(n / 2).z(), scene.duration);
  add_probe(scene, planks[n / 2]);
  return scene;
}

Scene build_hinge(const Parameters& parameters) { return build_bridge("bridge-hinge", true, parameters); }
Scene build_balls(const Parameters& parameters) { return build_bridge("bridge-balls", false, parameters); }

std::vector<ParameterInfo> bridge_parameters(int planks, bool truck) {
  return {size(planks, 2, 1e6, "number of planks"),
          {"truck", truck ? 1.0 : 0.0, "bool", "a body of 2000 kg on plank n / 2", 0, 1, true}};
}

}  // namespace

Bridge add_bridge(Scene& scene, int n, bool hinges) {
  World& world = scene.world;
  const Arc arc(n);
  const MassProperties mass = MassProperties::box(kBridgePlankSize, kBridgePlankMass);
  const Vec3 end(kHalfPlank, 0, 0);
  std::vector<BodyId> planks;
  for (int k = 0; k < n; ++k)
    planks.push_back(
        world.add_body(BodySpec{.name = numbered("plank", k), .mass = mass, .pose = arc.plank(k)}));
  for (const BodyId plank : planks) draw(scene, plank, {Box{kBridgePlankSize}});
  add_seam(world, 0, kGround, planks[0], arc.vertex(0), -end, hinges);
  for (int k = 1; k < n; ++k) add_seam(world, k, planks[k - 1], planks[k], end, -end, hinges);
  add_seam(world, n, kGround, planks[n - 1], arc.vertex(n), end, hinges);
  return {planks, kBridgePlankSize, arc.vertex(n).x()};
}

std::vector<SceneInfo> bridge_scenes() {
  return {
      {"bridge-hinge", "n planks on a hanging arc, one hinge per seam", bridge_parameters(50, false),
       build_hinge},
      {"bridge-balls", "n planks on a hanging arc, two ball joints per seam", bridge_parameters(50, false),
       build_balls},
      {"bridge", "bridge-balls with 200 planks and the truck", bridge_parameters(200, true), build_balls},
  };
}

}  // namespace taut
