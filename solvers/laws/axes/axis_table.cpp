#include "solvers/laws/axes/axis_table.h"

#include "solvers/laws/axes/axis_motor_law.h"
#include "solvers/laws/axes/axis_spring_law.h"

namespace taut {

AxisTable::AxisTable(const World& world, const Rows& rows)
    : world_(world), rows_(rows.axis_rows().begin(), rows.axis_rows().end()) {
  from_own_.assign(rows_.size(), 0);
  released_ = from_own_;
  for (const Rows::AxisRow& row : rows_) angular_.push_back(rows.row(row.row).angular);
}

bool AxisTable::refresh() {
  if (axis_version_ == world_.axis_version()) return false;
  axis_version_ = world_.axis_version();
  any_rigid_limit_ = any_load_ = any_spring_ = false;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    from_own_[i] = 0;
    if (rows_[i].axis.axis < 0) read_spring(i);
    const AxisProperties& p = properties(i);
    any_rigid_limit_ = any_rigid_limit_ || taut::has_rigid_limit(p);
    any_load_ = any_load_ || (p.friction && p.friction->per_load != 0);
    any_spring_ = any_spring_ || p.spring || has_soft_limit(p);
  }
  return true;
}

AxisProperties& AxisTable::make_own(std::size_t i) {
  own_.resize(rows_.size());
  from_own_[i] = 1;
  return own_[i] = given(i);
}

/// Of a spring between bodies that has rows of displacements, its length bears the damper alone.
void AxisTable::read_spring(std::size_t i) {
  own_.resize(rows_.size());
  from_own_[i] = 1;
  AxisSpring& own = own_[i].spring.emplace();
  if (rows_[i].spring.index >= 0) {
    const LineSpring& spring = *world_.force(rows_[i].spring).spring();
    if (rows_[i].centred)
      own.stiffness = spring.law.stiffness;
    else
      own = spring.law;
    if (!rows_[i].centred && spring.is_centred()) own.stiffness = 0;
    return;
  }
  const JointCompliance c = world_.compliance(rows_[i].axis.joint).value_or(JointCompliance{});
  own.stiffness = 1 / (angular_[i] ? c.rotation : c.translation);
  own.damping = angular_[i] ? c.rotation_damping : c.translation_damping;
}

void AxisTable::release(JointId joint) {
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (rows_[i].axis.joint == joint) released_[i] = 1;
}

bool AxisTable::has_unbounded_motor(std::size_t i) const {
  const AxisProperties& p = properties(i);
  return !released_[i] && p.motor && is_unbounded(*p.motor);
}

}  // namespace taut
