#pragma once

#include "core/state/force.h"
#include "core/state/state.h"

namespace taut {

class World;

/// A wrench about the centre of mass of a body, world axes [N·m, N], during the next step alone, of whichever
/// simulator of this world takes it: constant in world axes over its sub-steps.  Several calls add up.  It
/// wakes the body, is among `forces` of the ledger and in checkpoints, and does nothing to a fixed body.  It
/// is gone with a step that is ok(), of run_until() with the first; one that fails keeps it for the next try.
/// A copy of the world has it, too; World::forces(), append() and files know nothing of it.
/// @throws std::invalid_argument, with the name of the body, for a value that is not finite, and
/// std::logic_error inside a step.
void apply_force(World& world, BodyId body, const Wrench& wrench);
/// apply_force() of the wrench (r × f, f) of a force f [N], world axes, at point P of the body, with
/// r = R_WB p_BP [m] as the body is turned now.
void apply_force(World& world, BodyId body, const Vec3& p_BP, const Vec3& force);

}  // namespace taut
