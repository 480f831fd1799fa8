#pragma once

#include "solvers/common/settings.h"

namespace taut::testing {

/// Bodies that fixed joints hold together move as one.
inline Settings merging(Integrator integrator = Integrator::kRattle) {
  Settings settings;
  settings.integrator = integrator;
  settings.merge_fixed_joints = true;
  return settings;
}
/// The same with these joints solved.
inline Settings solving(Integrator integrator = Integrator::kRattle) {
  Settings settings = merging(integrator);
  settings.merge_fixed_joints = false;
  return settings;
}

}  // namespace taut::testing
