// A hanging bridge of 200 planks on hinges, held at both ends, with a truck of two tonnes on its middle.
#include <taut/taut.h>

#include <iostream>

int main() {
  using namespace taut;
  const int planks = 200;
  const auto angle = [](double k) { return 0.002 * (k - planks / 2); };  // on an arc of 100 m radius
  const auto seam = [&](int k) { return Vec3(100 * std::sin(angle(k)), 0, 100 - 100 * std::cos(angle(k))); };
  World world;
  BodyId last = kGround, middle = kGround;
  for (int k = 0; k < planks; ++k) {
    const Pose pose{exp_so3(Vec3(0, -angle(k + 0.5), 0)), (seam(k) + seam(k + 1)) / 2};
    const BodyId plank = world.add_body({.mass = MassProperties::box({0.2, 1, 0.05}, 5), .pose = pose});
    world.add("seam " + std::to_string(k), Hinge::at(world, last, plank, seam(k), Vec3::UnitY()));
    if (k == planks / 2) middle = plank;
    last = plank;
  }
  world.add("last seam", Hinge::at(world, last, kGround, seam(planks), Vec3::UnitY()));
  const Pose on_top{Quat::Identity(), seam(planks / 2) + Vec3(0, 0, 0.275)};
  const BodyId truck = world.add_body({.mass = MassProperties::box({1, 0.8, 0.5}, 2000), .pose = on_top});
  world.add("load", Fixed::at(world, middle, truck, seam(planks / 2)));
  Simulator simulator(world);
  while (world.time() < 1)
    if (!simulator.step(1.0 / 240).ok()) return std::cerr << simulator.report().message << '\n', 1;
  std::cout << "truck at z = " << world.pose(truck).p.z() << " m, joints closed to "
            << simulator.report().gap.metres << " m, pull of the first seam "
            << simulator.reaction(world.joint("seam 0")).force.norm() << " N\n";
}
