#pragma once

#include "scenes/import/robot_model.h"
#include "scenes/import/xml_files.h"

namespace taut::model {

/// A model in MuJoCo's format, in its reference configuration; controls are 0.
/// @throws ImportError for what is no MJCF.
RobotModel read_mjcf(XmlFiles& files, const pugi::xml_node& mujoco);

}  // namespace taut::model
