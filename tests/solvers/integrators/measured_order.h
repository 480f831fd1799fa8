#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "solvers/simulator/simulator.h"

namespace taut::testing {

/// Positions after 0.4 s at h, h/2 and h/4: the order by which the differences shrink.  `check` sees the
/// world and the simulator after each step.
inline double order_of(const std::function<World()>& make,
                       const std::function<void(const World&, Simulator&)>& check = nullptr) {
  const auto end = [&](int steps) {
    World world = make();
    Settings settings;
    settings.position_tolerance = 1e-13;
    settings.velocity_tolerance = 1e-12;
    settings.tension = TensionPolicy::kIgnore;
    settings.max_rotation = 10;
    Simulator simulator(world, settings);
    for (int i = 0; i < steps; ++i) {
      EXPECT_TRUE(simulator.step(0.4 / steps).exact()) << simulator.report().message;
      if (check) check(world, simulator);
    }
    Eigen::VectorXd p(3 * (world.body_count() - 1));
    for (int b = 1; b < world.body_count(); ++b) p.segment<3>(3 * (b - 1)) = world.pose(BodyId{b}).p;
    return p;
  };
  const Eigen::VectorXd coarse = end(80), middle = end(160), fine = end(320);
  return std::log2((coarse - middle).norm() / (middle - fine).norm());
}

}  // namespace taut::testing
