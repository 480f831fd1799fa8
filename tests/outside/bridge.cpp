// A hanging bridge of fifty planks on hinges, held at both ends, with a truck of two tonnes welded to its
// middle.
#include <taut/taut.h>

#include <cmath>
#include <iostream>

int main() {
  using namespace taut;
  const int planks = 50;
  const double theta = 0.2, radius = 0.1 / std::sin(theta / planks);  // an arc of chords of 0.2 m
  const auto angle = [&](double k) { return theta * (2 * k / planks - 1); };
  const auto seam = [&](int k) {
    return Vec3(radius * std::sin(angle(k)), 0, radius * (std::cos(theta) - std::cos(angle(k))));
  };

  World world;
  BodyId last = kGround, middle = kGround;
  for (int k = 0; k < planks; ++k) {
    const Pose pose{exp_so3(Vec3(0, -angle(k + 0.5), 0)), (seam(k) + seam(k + 1)) / 2};
    const BodyId plank = world.add_body(
        {.name = "plank " + std::to_string(k), .mass = MassProperties::box({0.2, 1, 0.05}, 5), .pose = pose});
    world.add("seam " + std::to_string(k), Hinge::at(world, last, plank, seam(k), Vec3::UnitY()));
    last = plank;
    if (k == planks / 2) middle = plank;
  }
  world.add("last seam", Hinge::at(world, last, kGround, seam(planks), Vec3::UnitY()));
  const Pose on_top{world.pose(middle).q, world.pose(middle).point({0, 0, 0.275})};
  const BodyId truck =
      world.add_body({.name = "truck", .mass = MassProperties::box({1, 0.8, 0.5}, 2000), .pose = on_top});
  world.add("load", Fixed::at(world, middle, truck, world.pose(middle).point({0, 0, 0.025})));

  Simulator simulator(world);
  double gap = 0;
  while (world.time() < 1) {
    const StepReport& report = simulator.step(1.0 / 240);
    if (!report.ok()) return std::cerr << report.message << '\n', 1;
    gap = std::max(gap, report.gap.metres);
  }
  std::cout << "truck at z = " << world.pose(truck).p.z() << " m, joints closed to " << gap << " m\n"
            << "pull of the first seam: " << simulator.reaction(world.joint("seam 0")).force.norm() << " N\n";
  return gap < 1e-9 ? 0 : 1;
}
