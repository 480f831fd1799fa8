// A rod on a hinge for a user who takes taut::taut from its sources: short enough to run without
// optimisation.
#include <taut/taut.h>

#include <iostream>

int main() {
  taut::World world;
  const taut::BodyId rod = world.add_body({.name = "rod",
                                           .mass = taut::MassProperties::box({1, 0.04, 0.04}, 1),
                                           .pose = {taut::Quat::Identity(), taut::Vec3(0.5, 0, 0)}});
  world.add("hinge", taut::Hinge::at(world, taut::kGround, rod, taut::Vec3::Zero(), taut::Vec3::UnitY()));
  taut::Simulator simulator(world);
  while (world.time() < 0.2)
    if (!simulator.step(0.01).ok()) return std::cerr << simulator.report().message << '\n', 1;
  const double z = world.pose(rod).p.z();
  std::cout << "rod at z = " << z << " m\n";
  return z < -0.05 && z > -0.2 ? 0 : 1;  // -3/4 g t² / 2, as long as it is nearly level
}
