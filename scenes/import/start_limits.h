#pragma once

#include "scenes/import/robot_model.h"

namespace taut::model {

/// Where an axis starts beyond its limits, moves the start to them: this axis, and the others of its loops
/// and relations by least values so that these hold; all else stays where it is.  Where no such start is
/// found, the limit is given up.  Each gets a notice.
void start_within_limits(RobotModel& model);

}  // namespace taut::model
