#pragma once

#include <span>

#include "scenes/import/robot_model.h"

namespace taut::model {

/// Axes of a link that one joint of a scene has, in world axes at the start.
struct JointSegment {
  std::string type;               ///< in the words of a scene file
  int first = 0, count = 0;       ///< among the link's axes
  std::vector<std::string> keys;  ///< names of these axes in the joint; none of a ball
  Vec3 anchor = Vec3::Zero();     ///< [m]
  Quat frame = Quat::Identity();  ///< of a six_dof
  bool turned = false;            ///< the joint goes from the link to its parent
};

/// The axes of a link as a chain of joints, as few as possible.  Bodies between them are the caller's.
std::vector<JointSegment> joint_segments(const Link& link);

/// Names of motions that a six_dof locks: all but the keys.
std::vector<std::string> locked_by(const JointSegment& segment);

}  // namespace taut::model
