#include "core/world/breakable_joints.h"

#include <algorithm>

namespace taut::detail {

void BreakableJoints::set(JointId id, std::optional<BreakLimits> limits) {
  const auto place = std::lower_bound(joints_.begin(), joints_.end(), id,
                                      [](const auto& entry, JointId joint) { return entry.first < joint; });
  const bool there = place != joints_.end() && place->first == id;
  if (there && limits)
    place->second = *limits;
  else if (there)
    joints_.erase(place);
  else if (limits)
    joints_.insert(place, {id, *limits});
}

}  // namespace taut::detail
