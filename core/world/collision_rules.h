#pragma once

#include <set>
#include <utility>

#include "core/state/state.h"
#include "core/world/joint_table.h"
#include "core/world/pair_table.h"

namespace taut::detail {

/// Which two bodies of a World may touch: as set, or else if no joint has both.
class CollisionRules {
 public:
  bool allow(BodyId a, BodyId b) const;
  const PairTable<BodyId, bool>& overrides() const { return overrides_; }  ///< as set
  void set(BodyId a, BodyId b, bool allowed);
  void copy_overrides(const CollisionRules& from);

  void add_joint(const Joint& joint);
  /// The joints are these now, without those that are out.
  void set_joints(const JointTable& joints);

 private:
  PairTable<BodyId, bool> overrides_;
  std::set<std::pair<BodyId, BodyId>> jointed_;
};

}  // namespace taut::detail
