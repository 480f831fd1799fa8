#include "core/world/collision_rules.h"

#include <span>

namespace taut::detail {

bool CollisionRules::allow(BodyId a, BodyId b) const {
  if (const bool* set = overrides_.find(a, b)) return *set;
  return !jointed_.contains(unordered(a, b));
}

void CollisionRules::add_joint(const Joint& joint) {
  const std::span<const BodyId> bodies = joint.bodies();
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t k = i + 1; k < bodies.size(); ++k) jointed_.insert(unordered(bodies[i], bodies[k]));
}

void CollisionRules::set_joints(const JointTable& joints) {
  jointed_.clear();
  for (int j = 0; j < joints.count(); ++j)
    if (joints.is_attached(j)) add_joint(joints[j]);
}

void CollisionRules::set(BodyId a, BodyId b, bool allowed) { overrides_.set(a, b, allowed); }

void CollisionRules::copy_overrides(const CollisionRules& from) { overrides_ = from.overrides_; }

}  // namespace taut::detail
