#include "solvers/laws/axes/axis_table.h"

#include <algorithm>

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
  for (auto* axes : {&limited_, &loaded_, &sprung_}) axes->clear();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const auto* softened = std::get_if<Rows::SoftenedRow>(&rows_[i].what);
    from_own_[i] = !axis(i);
    if (from_own_[i]) own_.resize(rows_.size());
    if (softened) own_[i].spring = spring_of(*softened, angular_[i]);
    if (const Rows::SpringRow* spring = rows_[i].spring()) own_[i].spring = spring_of(*spring);
    const AxisProperties& p = properties(i);
    const int axis = static_cast<int>(i);
    if (taut::has_rigid_limit(p)) limited_.push_back(axis);
    if (p.friction && p.friction->per_load != 0) loaded_.push_back(axis);
    if (p.spring || has_soft_limit(p)) sprung_.push_back(axis);
  }
  return true;
}

AxisProperties& AxisTable::make_own(std::size_t i) {
  own_.resize(rows_.size());
  if (!from_own_[i])
    for (auto* axes : {&loaded_, &sprung_})
      if (std::find(axes->begin(), axes->end(), i) == axes->end()) axes->push_back(static_cast<int>(i));
  from_own_[i] = 1;
  return own_[i] = given(i);
}

AxisSpring AxisTable::spring_of(const Rows::SoftenedRow& row, bool angular) const {
  const JointCompliance c = world_.compliance(row.joint).value_or(JointCompliance{});
  AxisSpring spring;
  spring.stiffness = 1 / (angular ? c.rotation : c.translation);
  spring.damping = angular ? c.rotation_damping : c.translation_damping;
  return spring;
}

/// Of one that has rows of displacements, the length bears the damper alone.
AxisSpring AxisTable::spring_of(const Rows::SpringRow& row) const {
  const LineSpring& given = *world_.force(row.spring).spring();
  AxisSpring spring;
  if (row.centred)
    spring.stiffness = given.law.stiffness;
  else
    spring = given.law;
  if (!row.centred && given.is_centred()) spring.stiffness = 0;
  return spring;
}

void AxisTable::release(JointId joint) {
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (rows_[i].joint() == joint) released_[i] = 1;
}

bool AxisTable::has_unbounded_motor(std::size_t i) const {
  const AxisProperties& p = properties(i);
  return !released_[i] && p.motor && is_unbounded(*p.motor);
}

}  // namespace taut
