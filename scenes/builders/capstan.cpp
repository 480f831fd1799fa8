#include "scenes/builders/capstan.h"

#include <cmath>
#include <numbers>

#include "core/joints/ball.h"
#include "scenes/builders/scene_parts.h"

namespace taut {
namespace {

using namespace scene_parts;

constexpr double kDrumRadius = 0.3, kDrumWidth = 0.3, kLinkRadius = 0.015, kWeightRadius = 0.1;  // [m]
constexpr double kLinkMass = 0.05, kWeight = 10;                                                 // [kg]

/// Half of the links lie on the upper half of the drum, each touching it in its middle, and a quarter hang
/// down on each side.  Friction acts on the surface of the drum, R from its axis, tension on the line of the
/// pins, R + r: their moments balance at dT (R + r) = μ T R dθ, so that the chain bears up to
///   T₂/T₁ = exp(μπ R/(R + r)).
Scene build_capstan(const Parameters& parameters) {
  Scene scene = new_scene("chain-over-cylinder", parameters, 2, 1e-3);
  World& world = scene.world;
  const int hanging = static_cast<int>(parameters.at("n")) / 4;
  const int laid = static_cast<int>(parameters.at("n")) - 2 * hanging;
  const Material surface = rubbing(parameters.at("friction"));
  const Quat across = exp_so3(Vec3(-std::numbers::pi / 2, 0, 0));
  world.add_shape(kGround, Cylinder{kDrumRadius, kDrumWidth}, {across, Vec3::Zero()}, surface);

  const double turn = std::numbers::pi / laid;
  const double pitch = 2 * (kDrumRadius + kLinkRadius) * std::tan(turn / 2);
  const double radius = (kDrumRadius + kLinkRadius) / std::cos(turn / 2);
  const auto pin = [&](int k) -> Vec3 {
    if (k < hanging) return {-radius, 0, -pitch * (hanging - k)};
    if (k > hanging + laid) return {radius, 0, -pitch * (k - hanging - laid)};
    const double angle = turn * (k - hanging);
    return {-radius * std::cos(angle), 0, radius * std::sin(angle)};
  };
  const int n = 2 * hanging + laid;
  std::vector<BodyId> links;
  for (int k = 0; k < n; ++k) {
    links.push_back(add_rod(scene, numbered("link", k), pin(k), pin(k + 1), kLinkRadius, kLinkMass));
    world.add_shape(links[k], Capsule{kLinkRadius, 0.9 * pitch},
                    {exp_so3(Vec3(0, std::numbers::pi / 2, 0)), Vec3::Zero()}, surface, {2, 1});
    if (k > 0) world.add(numbered("joint", k), Ball::at(world, links[k - 1], links[k], pin(k)));
  }
  const auto add_weight = [&](const char* name, BodyId link, const Vec3& p, double mass) {
    BodySpec body{.name = name, .mass = MassProperties::sphere(kWeightRadius, mass)};
    body.pose.p = p - Vec3(0, 0, kWeightRadius);
    const BodyId weight = world.add_body(body);
    draw(scene, weight, {Sphere{kWeightRadius}});
    world.add(std::string(name) + "_shackle", Ball::at(world, link, weight, p));
    return weight;
  };
  add_weight("light", links.front(), pin(0), kWeight);
  add_probe(scene, add_weight("heavy", links.back(), pin(n), parameters.at("ratio") * kWeight));
  scene.energy_scale = fall_energy(world, 1, scene.duration);
  return scene;
}

}  // namespace

std::vector<SceneInfo> capstan_scenes() {
  return {{"chain-over-cylinder",
           "a chain with a weight of 10 kg at one end and a heavier one at the other, over a fixed drum",
           {size(24, 8, 1000, "number of links, half of them on the drum"),
            {"friction", 0.3, "", "Coulomb coefficient between links and drum", 0, 10, false},
            {"ratio", 2.3, "", "of the weights; it slides above exp(pi friction / 1.05)", 1, 1000, false}},
           build_capstan}};
}

}  // namespace taut
