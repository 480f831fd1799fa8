#pragma once

#include "core/world/rigid_body.h"
#include "tests/core/random_state.h"

namespace taut::testing {

/// A box of random size and mass in random axes.
inline MassProperties random_mass(Random& random) {
  const Vec3 size(random.uniform(0.3, 1), random.uniform(0.3, 1), random.uniform(0.3, 1));
  const MassProperties box = MassProperties::box(size, random.uniform(0.5, 2));
  const Mat3 R = random.rotation().toRotationMatrix();
  return {box.mass(), Mat3(R * box.inertia_B() * R.transpose())};
}

}  // namespace taut::testing
