#include "scenes/builders/chain.h"

#include <numbers>

#include "core/joints/ball.h"
#include "core/joints/hinge.h"
#include "scenes/builders/drawing.h"
#include "scenes/builders/scene_parts.h"

namespace taut {
namespace {

using namespace scene_parts;

struct ChainSpec {
  const char* name;
  double length, mass;  ///< of a rod [m, kg]
  bool hinges = false;  ///< about world y; ball joints otherwise
  bool heavy = false;   ///< a 100 kg sphere at the end
  double cone = 0;      ///< limit of the bend of each joint [rad]; 0: none
};

constexpr double kSphereMass = 100, kSphereRadius = 0.15;

void add_joint(World& world, int index, BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ,
               const ChainSpec& spec) {
  std::string name = numbered("joint", index);
  if (spec.hinges) {
    world.add(std::move(name), Hinge(a, b, p_AP, Vec3::UnitY(), p_BQ, Vec3::UnitY()));
  } else if (spec.cone > 0) {
    const JointId joint = world.add(std::move(name), Ball(a, b, p_AP, p_BQ).with_axes(world, Vec3::UnitX()));
    world.set_limits(world.axis(joint, "swing"), AxisLimits{.upper = spec.cone});
  } else {
    world.add(std::move(name), Ball(a, b, p_AP, p_BQ));
  }
}

/// Distance of the centre of mass from the pivot: how far it falls until the chain hangs straight down.
double fall_height(const World& world) {
  double mass = 0, moment = 0;
  for (int b = 1; b < world.body_count(); ++b) {
    const double m = world.mass_properties(BodyId{b}).mass();
    mass += m;
    moment += m * world.pose(BodyId{b}).p.x();
  }
  return moment / mass;
}

Scene build_chain(const ChainSpec& spec, int n, double duration) {
  Scene scene;
  scene.name = spec.name;
  scene.parameters = {{"n", n}};
  scene.duration = duration;
  World& world = scene.world;

  const MassProperties rod = thin_rod(spec.length, spec.mass);
  const Vec3 end(spec.length / 2, 0, 0);
  BodyId last = kGround;
  for (int k = 0; k < n; ++k) {
    BodySpec body{.name = numbered("rod", k), .mass = rod};
    body.pose.p = Vec3((k + 0.5) * spec.length, 0, 0);
    const BodyId next = world.add_body(body);
    draw(scene, next, rod_shape(spec.length, kRodRadius));
    add_joint(world, k, last, next, k == 0 ? Vec3(Vec3::Zero()) : end, -end, spec);
    last = next;
  }
  if (spec.heavy) {
    const Vec3 radius(kSphereRadius, 0, 0);
    BodySpec body{.name = "sphere", .mass = MassProperties::sphere(kSphereRadius, kSphereMass)};
    body.pose.p = Vec3(n * spec.length, 0, 0) + radius;
    const BodyId sphere = world.add_body(body);
    draw(scene, sphere, {Sphere{kSphereRadius}});
    add_joint(world, n, last, sphere, end, -radius, spec);
    last = sphere;
  }

  scene.energy_scale = fall_energy(world, fall_height(world), duration);
  add_probe(scene, last);
  return scene;
}

constexpr ChainSpec kPendulumBall{"pendulum-ball", 1.0, 1.0};
constexpr ChainSpec kPendulumHinge{"pendulum-hinge", 1.0, 1.0, true};
constexpr ChainSpec kChain{"chain", 0.1, 0.1};
constexpr ChainSpec kChainLimited{"chain-limited", 0.1, 0.1, false, false, std::numbers::pi / 6};
constexpr ChainSpec kChainHeavy{"chain-heavy", 0.1, 0.1, false, true};

template <const ChainSpec& spec>
Scene build_pendulum(const Parameters& parameters) {
  return build_chain(spec, static_cast<int>(parameters.at("n")), 10);
}

template <const ChainSpec& spec>
Scene build_chain(const Parameters& parameters) {
  const int n = static_cast<int>(parameters.at("n"));
  return build_chain(spec, n, duration_for(n, {{10, 5.0}, {1000, 2.0}, {10000, 1.0}}));
}

}  // namespace

std::vector<SceneInfo> chain_scenes() {
  const ParameterInfo pendulum_size = size(2, 1, 1000, "number of rods");
  const ParameterInfo chain_size = size(100, 1, 1e6, "number of rods");
  return {
      {"pendulum-ball",
       "n rods of 1 m on ball joints, released from the horizontal",
       {pendulum_size},
       build_pendulum<kPendulumBall>},
      {"pendulum-hinge",
       "n rods of 1 m on hinges about y, released from the horizontal",
       {pendulum_size},
       build_pendulum<kPendulumHinge>},
      {"chain",
       "n rods of 0.1 m on ball joints, released from the horizontal",
       {chain_size},
       build_chain<kChain>},
      {"chain-limited",
       "chain whose ball joints bend by at most 30 degrees",
       {chain_size},
       build_chain<kChainLimited>},
      {"chain-heavy",
       "chain with a sphere of 100 kg at its free end, 1000 times the mass of its neighbour",
       {chain_size},
       build_chain<kChainHeavy>},
  };
}

}  // namespace taut
