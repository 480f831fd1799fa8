#include "scenes/builders/stacks.h"

#include <array>
#include <cmath>
#include <random>

#include "core/world/solid.h"
#include "scenes/builders/scene_parts.h"

namespace taut {
namespace {

using namespace scene_parts;

constexpr double kStackDensity = 1000;  ///< [kg/m³]

Scene on_a_floor(std::string name, const Parameters& parameters, double duration) {
  Scene scene = new_scene(std::move(name), parameters, duration);
  scene.world.add_shape(kGround, HalfSpace{});
  return scene;
}

BodyId add_solid(Scene& scene, std::string name, const Shape& shape, const Pose& pose,
                 double density = kStackDensity, const Material& material = {}) {
  const BodyId body =
      scene.world.add_body({.name = std::move(name),
                            .mass = solid_of(std::array{PlacedShape{shape, {}, density}}).mass,
                            .pose = pose});
  scene.world.add_shape(body, shape, {}, material);
  return body;
}

/// Cubes of 1 m on each other; with a heavy top, that one is of 1000 times the density.
Scene build_stack(const Parameters& parameters) {
  Scene scene = on_a_floor("stack", parameters, 5);
  const int n = static_cast<int>(parameters.at("n"));
  const bool top_heavy = parameters.at("top_heavy") != 0;
  BodyId last{};
  for (int i = 0; i < n; ++i)
    last = add_solid(scene, numbered("box", i), Box{Vec3(1, 1, 1)}, {.p = Vec3(0, 0, 0.5 + i)},
                     top_heavy && i < n - 1 ? 1e-3 * kStackDensity : kStackDensity);
  scene.energy_scale = fall_energy(scene.world, n, scene.duration);
  add_probe(scene, last);
  return scene;
}

/// n rows of n bricks, every other row set off by half a brick.
Scene build_wall(const Parameters& parameters) {
  Scene scene = on_a_floor("wall", parameters, 5);
  const int n = static_cast<int>(parameters.at("n"));
  const Vec3 size(0.4, 0.2, 0.2);
  BodyId last{};
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column)
      last = add_solid(scene, numbered("brick", row, column), Box{size},
                       {.p = Vec3((column + 0.5 * (row % 2)) * size.x(), 0, (row + 0.5) * size.z())});
  scene.energy_scale = fall_energy(scene.world, n * size.z(), scene.duration);
  add_probe(scene, last);
  return scene;
}

/// n rows of tents of two cards that lean on each other, on cards that lie from tent to tent.
Scene build_cards(const Parameters& parameters) {
  Scene scene = on_a_floor("card-house", parameters, 5);
  scene.dt = 1e-3;
  const int n = static_cast<int>(parameters.at("n"));
  constexpr double kLean = 0.35, kLength = 0.09, kWidth = 0.06, kThickness = 0.002, kPlay = 5e-4;
  const Vec3 card(kThickness, kWidth, kLength);
  const double c = std::cos(kLean), s = std::sin(kLean), spacing = kLength + kPlay;
  const double tent = kLength * c + kThickness * s, row = tent + kThickness;
  BodyId last{};
  for (int level = 0; level < n; ++level) {
    const int tents = n - level;
    for (int k = 0; k < tents; ++k) {
      const double x = spacing * (k - 0.5 * (tents - 1));
      for (const double side : {-1, 1}) {
        // Its inner upper edge is above the middle of the tent, its lower one on the row below.
        Pose pose;
        pose.p = Vec3(x + side * 0.5 * (kThickness * c + kLength * s), 0, row * level + 0.5 * tent);
        pose.q = exp_so3(Vec3(0, -side * kLean, 0));
        last = add_solid(scene, numbered(side < 0 ? "left" : "right", level, k), Box{card}, pose);
      }
      if (k > 0)
        add_solid(scene, numbered("flat", level, k), Box{Vec3(kLength, kWidth, kThickness)},
                  {.p = Vec3(x - 0.5 * spacing, 0, row * level + tent + 0.5 * kThickness)});
    }
  }
  scene.energy_scale = fall_energy(scene.world, n * row, scene.duration);
  add_probe(scene, last);
  return scene;
}

/// Four walls around a floor of this side.
void add_walls(Scene& scene, const Vec3& middle, double side, double height) {
  constexpr double kThick = 0.5;
  for (const Vec3& out : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
    const Vec3 size = out.cwiseAbs() * kThick + (Vec3(1, 1, 0) - out.cwiseAbs()) * (side + 2 * kThick);
    scene.world.add_shape(kGround, Box{size + Vec3(0, 0, height)},
                          {.p = middle + 0.5 * (side + kThick) * out + Vec3(0, 0, 0.5 * height)});
  }
}

/// Balls, boxes, capsules and cylinders that fall on each other, turned at random but always the same.
/// They are as stiff as stone: many rigid ones, pressed from all sides, have no determinate forces.  They
/// resist rolling as real ones do: balls would roll on for ever without.
Scene build_heap(const char* name, bool walls, const Parameters& parameters) {
  Scene scene = on_a_floor(name, parameters, 4);
  const int n = static_cast<int>(parameters.at("n")), side = std::max(1, static_cast<int>(std::cbrt(n)));
  constexpr double kSpacing = 0.6, kOff = 0.03;
  const double arm = parameters.at("rolling");
  const Material stone{
      .rolling_friction = arm, .spinning_friction = arm, .compliance = parameters.at("compliance")};
  const Shape shapes[] = {Sphere{0.2}, Box{Vec3(0.4, 0.3, 0.2)}, Capsule{0.1, 0.3}, Cylinder{0.15, 0.3}};
  std::mt19937 generator(1);
  const auto random = [&] { return 2.0 * generator() / std::mt19937::max() - 1; };
  BodyId last{};
  for (int i = 0; i < n; ++i) {
    Pose pose;
    const double x = kSpacing * (i % side), y = kSpacing * (i / side % side);
    const int layer = i / (side * side);
    pose.p = Vec3(x + kOff * random(), y + kOff * random(), 0.4 + kSpacing * layer);
    const double a = random(), b = random(), c = random(), d = random();
    pose.q = Quat(a, b, c, d).normalized();
    last = add_solid(scene, numbered("body", i), shapes[i % 4], pose, kStackDensity, stone);
  }
  if (walls) {
    const double centre = 0.5 * kSpacing * (side - 1);
    const int layers = 1 + n / (side * side);
    add_walls(scene, Vec3(centre, centre, 0), kSpacing * side, kSpacing * layers);
    draw(scene, kGround,
         {Box{{kSpacing * side, kSpacing * side, 0.01}}, {.p = Vec3(centre, centre, -0.005)}});
  }
  scene.energy_scale = fall_energy(scene.world, kSpacing * n / (side * side), scene.duration);
  add_probe(scene, last);
  return scene;
}

Scene build_open_heap(const Parameters& parameters) { return build_heap("heap", false, parameters); }
Scene build_pile(const Parameters& parameters) { return build_heap("pile", true, parameters); }

}  // namespace

std::vector<SceneInfo> stack_scenes() {
  const ParameterInfo top_heavy{"top_heavy", 0, "bool", "the uppermost cube has 1000 times the density",
                                0,           1, true};
  const ParameterInfo compliance{"compliance", 5e-10, "m/N", "of the surfaces of bodies; 0: rigid", 0, 1};
  const ParameterInfo rolling{"rolling", 1e-3, "m", "arm of rolling and spinning friction", 0, 0.1};
  return {{"stack",
           "n cubes of 1 m on each other",
           {size(20, 1, 1000, "number of cubes"), top_heavy},
           build_stack},
          {"wall", "n rows of n bricks", {size(5, 1, 100, "number of rows")}, build_wall},
          {"heap",
           "n balls, boxes, capsules and cylinders that fall on a heap",
           {size(8, 1, 10000, "number of bodies"), compliance, rolling},
           build_open_heap},
          {"pile",
           "heap between four walls",
           {size(50, 1, 10000, "number of bodies"), compliance, rolling},
           build_pile},
          {"card-house", "n rows of leaning cards", {size(3, 1, 20, "number of rows")}, build_cards}};
}

}  // namespace taut
