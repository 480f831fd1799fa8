#include "core/world/axis_table.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/base/check.h"
#include "core/world/id_check.h"

namespace taut::detail {

int AxisTable::count_of(JointId joint) const {
  const int j = index_of(joint, starts_.size() - 1, "joint");
  return starts_[j + 1] - starts_[j];
}

int AxisTable::checked(AxisId id) const {
  if (id.axis < 0 || id.axis >= count_of(id.joint)) fail("axis id", "no such axis", id.axis);
  return starts_[id.joint.index] + id.axis;
}

void AxisTable::add_joint(std::vector<AxisInfo> axes) {
  for (AxisInfo& axis : axes) {
    AxisProperties properties;
    if (axis.limits.lower > -kUnlimited || axis.limits.upper < kUnlimited) properties.limits = axis.limits;
    properties_.push_back(std::move(properties));
    infos_.push_back(std::move(axis));
  }
  starts_.push_back(count());
}

void AxisTable::relocate(int joint, const Relocation& to) {
  for (int k = starts_[joint]; k < starts_[joint + 1]; ++k) {
    infos_[k].coordinate = infos_[k].coordinate->relocated(to);
    for (int& body : infos_[k].bodies) body = to.body(body);
  }
}

void AxisTable::set_coordinates(int joint, std::vector<AxisInfo> axes) {
  assert(static_cast<int>(axes.size()) == starts_[joint + 1] - starts_[joint]);
  std::move(axes.begin(), axes.end(), infos_.begin() + starts_[joint]);
}

void AxisTable::copy_properties(const AxisTable& from) { properties_ = from.properties_; }

std::span<const AxisProperties> AxisTable::properties_of(JointId joint) const {
  const int count = count_of(joint);
  return {properties_.data() + starts_[joint.index], static_cast<std::size_t>(count)};
}

}  // namespace taut::detail
