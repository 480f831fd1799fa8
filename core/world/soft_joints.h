#pragma once

#include <map>
#include <optional>
#include <vector>

#include "core/constraints/row_sinks.h"
#include "core/state/state.h"
#include "core/world/joint.h"
#include "core/world/joint_properties.h"

namespace taut::detail {

/// The joints of a World that have a compliance, with the rows that it softens.
class SoftJoints {
 public:
  std::optional<JointCompliance> compliance(int joint) const;  ///< none: rigid
  std::map<int, JointCompliance> compliances() const;          ///< of all, by joint index
  /// ½ φ²/compliance, summed over the softened rows of a joint [J]; 0 for a rigid one.
  double energy(int joint, const State& state) const;
  /// Has the sink take the rows of the joint that give way as soft ones.
  void soften(int joint, RowSink& sink) const;
  bool has_same_joints(const SoftJoints& other) const;

  /// nullopt: rigid.  True if other rows are soft now than before.
  bool set(int index, const Joint& joint, const std::optional<JointCompliance>& compliance);
  /// Same compliances as with another one, which has the same joints.
  void copy_compliances(const SoftJoints& from);

 private:
  struct Entry {
    JointCompliance compliance;
    std::vector<RowGroup> rows;  // that it softens
  };
  std::map<int, Entry> joints_;
};

}  // namespace taut::detail
