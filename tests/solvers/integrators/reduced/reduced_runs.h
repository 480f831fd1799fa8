#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/world/world.h"
#include "solvers/simulator/simulator.h"

namespace taut::testing {

inline constexpr Integrator kReduced[] = {Integrator::kRecursive, Integrator::kRecursiveMidpoint,
                                          Integrator::kLagrangian, Integrator::kLagrangianMidpoint};

/// Joints are closed to round-off, and a step is one step.
inline Settings fine_settings(Integrator integrator) {
  Settings settings;
  settings.integrator = integrator;
  settings.position_tolerance = 1e-12;
  settings.velocity_tolerance = 1e-11;
  settings.tension = TensionPolicy::kIgnore;
  settings.max_rotation = 10;
  return settings;
}

inline void run(World& world, const Settings& settings, double time, int steps) {
  Simulator simulator(world, settings);
  for (int i = 0; i < steps; ++i)
    ASSERT_TRUE(simulator.step(time / steps).exact()) << i << ": " << simulator.report().message;
}

/// The largest displacement [m] or rotation [rad] of a body between two states of a world.
inline double distance(const World& a, const World& b) {
  double most = 0;
  for (int i = 1; i < a.body_count(); ++i) {
    most = std::max(most, (a.pose({i}).p - b.pose({i}).p).norm());
    most = std::max(most, log_so3(a.pose({i}).q * b.pose({i}).q.conjugate()).norm());
  }
  return most;
}

/// The order by which the distance from the truth shrinks as steps are halved.
inline double order_towards(const World& truth, const World& start, const Settings& settings, double time,
                            int steps) {
  double errors[2];
  for (int k : {0, 1}) {
    World world = start;
    run(world, settings, time, steps << k);
    errors[k] = distance(world, truth);
  }
  EXPECT_LE(errors[0], 0.05);
  EXPECT_GE(errors[1], 1e-11);  // what is left is no round-off
  return std::log2(errors[0] / errors[1]);
}

/// A run, and one that goes on in another simulator from a checkpoint in the middle, come to the same bits.
/// `look` sees the worlds and simulators of both at the end.
inline void expect_checkpoints_keep_bits(
    const std::function<World()>& make, const Settings& settings, double dt, int steps,
    const std::function<void(const World&, Simulator&, const World&, Simulator&)>& look = nullptr) {
  World whole = make(), first = make(), second = make();
  Simulator uninterrupted(whole, settings), before(first, settings), after(second, settings);
  for (int i = 0; i < steps; ++i) ASSERT_TRUE(uninterrupted.step(dt).exact());
  for (int i = 0; i < steps / 2; ++i) ASSERT_TRUE(before.step(dt).exact());
  after.restore(before.checkpoint());
  for (int i = steps / 2; i < steps; ++i) ASSERT_TRUE(after.step(dt).exact());
  for (int b = 1; b < whole.body_count(); ++b) {
    EXPECT_EQ(whole.pose({b}).p, second.pose({b}).p);
    EXPECT_EQ(whole.pose({b}).q.coeffs(), second.pose({b}).q.coeffs());
    EXPECT_EQ(whole.twist({b}).w, second.twist({b}).w);
    EXPECT_EQ(whole.twist({b}).v, second.twist({b}).v);
  }
  if (look) look(whole, uninterrupted, second, after);
}

}  // namespace taut::testing
