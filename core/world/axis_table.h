#pragma once

#include <span>
#include <vector>

#include "core/axes/axis.h"
#include "core/constraints/row_sinks.h"

namespace taut::detail {

/// The free axes of all joints of a World, one joint behind the other as in State::axes, and what acts along
/// them.
class AxisTable {
 public:
  int count() const { return static_cast<int>(infos_.size()); }
  int first(int joint) const { return starts_[joint]; }  ///< index of its first axis
  /// Number of axes.  @throws std::invalid_argument if there is no such joint.
  int count_of(JointId joint) const;
  /// Index of an axis.  @throws std::invalid_argument if there is no such one.
  int checked(AxisId id) const;

  const AxisInfo& info(int axis) const { return infos_[axis]; }
  const AxisProperties& properties(int axis) const { return properties_[axis]; }
  AxisProperties& properties(int axis) { return properties_[axis]; }
  /// Those of a joint.  @throws std::invalid_argument if there is no such one.
  std::span<const AxisProperties> properties_of(JointId joint) const;

  /// The axes of the next joint, with the limits that they have from the start.
  void add_joint(std::vector<AxisInfo> axes);
  /// The coordinates of a joint's axes are those of `axes`, which are the same ones otherwise.
  void set_coordinates(int joint, std::vector<AxisInfo> axes);
  /// Same properties as those of a table with the same axes.
  void copy_properties(const AxisTable& from);
  /// The axes of a joint are of the bodies that carry its own.
  void relocate(int joint, const Relocation& to);

 private:
  std::vector<int> starts_{0};  // first axis of each joint, then the number of axes
  std::vector<AxisInfo> infos_;
  std::vector<AxisProperties> properties_;
};

}  // namespace taut::detail
