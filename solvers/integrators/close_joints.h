#pragma once

#include <span>
#include <vector>

#include "solvers/common/step_report.h"
#include "solvers/laws/axes/axis_forces.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// Closes all joints by Gauss–Newton in the mass metric: q ← q ⊕ M⁻¹ Jᵀ S⁺ (−φ), a least move of the bodies.
/// Axes that are beyond their `limits` are brought back with them.
/// Returns whether every |φ| came below `tolerance`; the poses of `state` are then closed, else they are the
/// best that was found.
bool close_joints(ConstraintSystem& system, State& state, double tolerance, SubstepReport& report,
                  std::span<const AxisForces::Bound> limits = {});

/// The joints that hold the part of φ that no motion can reduce to first order, the null-space part φ − S S⁺
/// φ at these poses, as those of a taut line do that bears a load across.  Sets of up to 24 joints are made
/// minimal: without any one of them the rest could hold.  Larger ones are in the order of the world.
Contradiction find_stuck_joints(const World& world, ConstraintSystem& system, const std::vector<Pose>& poses,
                                SubstepReport& report);

}  // namespace taut
