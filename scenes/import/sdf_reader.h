#pragma once

#include "scenes/import/robot_model.h"
#include "scenes/import/xml_files.h"

namespace taut::model {

/// Models and worlds in the Simulation Description Format.  Links stand where their poses put them; joints
/// may form any graph.  A link that no joint has as its child is free, unless its model is static.
/// @throws ImportError for what is no SDF.
RobotModel read_sdf(XmlFiles& files, const pugi::xml_node& sdf);

}  // namespace taut::model
