#pragma once

#include "scenes/import/robot_model.h"

namespace taut::model {

/// Gives what moves a mass: a link without one, or with one that no body can have, becomes part of a link
/// that it is fixed to.  Where all that are fixed to each other are no body either, each that is none gets
/// the mean of its principal moments as each of them, unless the model refuses that.  Each gets a notice.
/// Afterwards parents need not stand in front of their children.
/// @throws ImportError if links that move together have no mass, no inertia, or one that is refused.
void fuse_links_without_mass(RobotModel& model);

/// Whether the link never moves: it is fixed to the world, or to what is.
bool stands_still(const RobotModel& model, int link);

}  // namespace taut::model
