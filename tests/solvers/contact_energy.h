#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "solvers/simulator/simulator.h"

namespace taut::testing {

/// Steps in none of which contacts and friction give more than a part of the largest kinetic energy so far.
inline void expect_contacts_give_nothing(Simulator& simulator, double h, int steps, double part) {
  double most = 0;
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = simulator.step(h);
    ASSERT_TRUE(report.ok()) << i << ": " << report.message;
    most = std::max(most, report.kinetic_energy);
    ASSERT_LE(report.ledger.contacts + report.ledger.friction, part * most) << i;
  }
}

}  // namespace taut::testing
