#pragma once

#include <vector>

#include "core/world/axis_table.h"
#include "core/world/body_table.h"
#include "core/world/breakable_joints.h"
#include "core/world/collision_rules.h"
#include "core/world/force_laws.h"
#include "core/world/joint_table.h"
#include "core/world/material_table.h"
#include "core/world/passing_loads.h"
#include "core/world/shape_table.h"
#include "core/world/sleep_table.h"
#include "core/world/soft_joints.h"
#include "core/world/world_identity.h"
#include "core/world/world_versions.h"

namespace taut::detail {

/// What a World consists of, beside its state and gravity, and who it is.  Only the sources of World and its
/// friends see it: not installed.
struct WorldParts {
  WorldIdentity identity;
  WorldVersions versions;
  BodyTable bodies;
  SleepTable sleep;
  ForceLaws forces;
  JointTable joints;
  AxisTable axes;
  BreakableJoints breakable;
  SoftJoints soft_joints;
  ShapeTable shapes;
  MaterialTable materials;
  CollisionRules collisions;
  std::vector<BodyLoad> next_loads;  // for the next step alone
};

}  // namespace taut::detail
