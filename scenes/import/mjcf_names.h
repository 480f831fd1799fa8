#pragma once

#include <map>
#include <set>
#include <string>

#include "scenes/import/mjcf_element.h"
#include "scenes/import/robot_model.h"

namespace taut::model {

/// Where a geom has come to: the number of its shape among those of its body, -1 if it has none.
struct GeomPlace {
  int link = kWorld;
  int shape = -1;
};

/// Names of what a MJCF file defines, for what refers to it.
struct MjcfNames {
  std::map<std::string, int> bodies{{"world", kWorld}};
  std::map<std::string, LinkFrame> sites;
  std::map<std::string, GeomPlace> geoms;
  std::map<std::string, AxisName> joints;
  std::set<std::string> free_joints;
  std::set<std::string> copied;  ///< names that <replicate> has given endings
  bool lacks_some = false;       ///< a part of the model has no counterpart, and may have defined others
};

}  // namespace taut::model
