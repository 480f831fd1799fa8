#pragma once

#include "scenes/import/robot_model.h"
#include "scenes/import/xml_files.h"

namespace taut::model {

/// A robot in the Unified Robot Description Format, all joints at 0 but those that mimic others.
/// The link without parent is the world if it is called "world", is free if it or what is fixed to it has a
/// mass, and is fixed otherwise.
/// @throws ImportError for what is no URDF, or no tree of links.
RobotModel read_urdf(XmlFiles& files, const pugi::xml_node& robot);

}  // namespace taut::model
