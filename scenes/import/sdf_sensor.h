#pragma once

#include "scenes/import/robot_model.h"
#include "scenes/import/xml_files.h"

namespace taut::model {

/// A <sensor> of SDF, also of a <gazebo> in a URDF, as probes: of a link `imu`, angular velocity and
/// orientation; of the joint that the link hangs on `force_torque`, its reaction.  What others measure has no
/// probe, and is named as left out.
/// @param at the link; kWorld with `of_joint`: the joint closes a loop
void read_sdf_sensor(XmlFiles& files, const pugi::xml_node& sensor, const LinkFrame& at, bool of_joint,
                     RobotModel& model);

}  // namespace taut::model
