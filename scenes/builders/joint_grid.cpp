#include "scenes/builders/joint_grid.h"

#include "core/joints/ball.h"
#include "scenes/builders/drawing.h"
#include "scenes/builders/scene_parts.h"

namespace taut {
namespace {

using namespace scene_parts;

constexpr double kGridRadius = 0.4, kGridDensity = 1000;

Scene build_joint_grid(const Parameters& parameters) {
  const int n = static_cast<int>(parameters.at("n"));
  Scene scene = new_scene("joint-grid", parameters, 2);
  World& world = scene.world;
  world.set_gravity(parameters.at("swing") != 0 ? Vec3(0, 0, -9.81) : Vec3(0, -9.81, 0));

  const MassProperties mass = MassProperties::sphere(kGridRadius, kGridDensity * sphere_volume(kGridRadius));
  const auto id = [n](int row, int column) { return BodyId{1 + row * n + column}; };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      BodySpec body{.name = numbered("sphere", i, k), .mass = mass};
      body.pose.p = Vec3(k, -i, 0);
      body.fixed = i == 0;
      draw(scene, world.add_body(body), {Sphere{kGridRadius}});
    }
  const Vec3 right(0.5, 0, 0), down(0, -0.5, 0);
  for (int i = 1; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      world.add(numbered("vertical", i, k), Ball(id(i - 1, k), id(i, k), down, -down));
      if (k > 0) world.add(numbered("horizontal", i, k), Ball(id(i, k - 1), id(i, k), right, -right));
    }

  // The moving rows 1 … n − 1 are n/2 m from the fixed one on average; that is their fall when they swing.
  scene.energy_scale = fall_energy(world, 0.5 * n, scene.duration);
  add_probe(scene, id(n - 1, n / 2));
  return scene;
}

}  // namespace

std::vector<SceneInfo> joint_grid_scenes() {
  return {{"joint-grid",
           "n x n spheres on ball joints, the first row fixed",
           {size(10, 2, 500, "spheres along an edge"),
            {"swing", 0, "bool", "gravity across the grid, not along it", 0, 1, true}},
           build_joint_grid}};
}

}  // namespace taut
