// How a World becomes Rows: the only place where rows know what they are compiled from.
#include <algorithm>

#include "core/constraints/rows.h"
#include "core/world/swing_properties.h"
#include "core/world/world.h"
#include "core/world/world_parts.h"

namespace taut {
namespace {

bool moves(const World& world, const Joint& joint) {
  const std::span<const BodyId> bodies = joint.bodies();
  return std::any_of(bodies.begin(), bodies.end(), [&](BodyId body) { return world.moves(body); });
}

/// What acts along the axes of a joint, and at the axes that stand in for a swing an empty property, so that
/// they have rows.
std::vector<AxisProperties> with_stand_ins(std::span<const AxisProperties> own,
                                           const SwingProperties& swing) {
  std::vector<AxisProperties> all(own.begin(), own.end());
  for (int t : {0, 1}) {
    if (swing.has_friction) all[swing.across.turns[t]].friction.emplace();
    if (swing.has_spring) all[swing.across.components[t]].spring.emplace();
  }
  return all;
}

}  // namespace

std::vector<int> detail::body_indices(const Joint* joint) {
  std::vector<int> indices;
  for (BodyId body : joint->bodies()) indices.push_back(body.index);
  return indices;
}

Pose detail::carrier_frame(const Relocation& to, const Joint& joint, int side) {
  return to.frame(joint.bodies()[side]);
}

void RowSink::add_rows_of(const Joint& joint, const Relocation& to) {
  const Relocation* outer = relocation_;
  const Joint* outer_source = source_;
  const Relocation all = outer ? outer->after(to) : to;
  relocation_ = &all, source_ = &joint;
  joint.append_rows(*this);
  relocation_ = outer, source_ = outer_source;
}

void AxisSink::add_axes_of(const Joint& joint, const Relocation& to) {
  const Relocation* outer = relocation_;
  const Joint* outer_source = source_;
  const Relocation all = outer ? outer->after(to) : to;
  relocation_ = &all, source_ = &joint;
  joint.append_axes(*this);
  relocation_ = outer, source_ = outer_source;
}

void Rows::append_empty_block(const Owner& owner) {
  joints_.push_back({row_count(), 0, static_cast<int>(sides_.size()), 0, 0, owner});
}

void Rows::append_joint(const World& world, int j, AxisRows axis_rows, Joints joints, Blocks blocks) {
  const JointId id{j};
  const Joint& joint = world.joint(id);
  if (!world.is_attached(id) || (joints == Joints::kMoving && !moves(world, joint)))
    return append_empty_block(id);
  const bool with_axes = axis_rows == AxisRows::kIncluded;
  RowSink counter;
  if (with_axes) world.parts_->soft_joints.soften(j, counter);
  joint.append_rows(counter);

  std::span<const AxisProperties> properties;  // of the axes; empty if none has rows
  std::vector<AxisProperties> of_swing;
  if (with_axes && world.has_axis_properties(id)) {
    properties = world.parts_->axes.properties_of(id);
    if (const auto swing = swing_properties(world, id))
      properties = of_swing = with_stand_ins(properties, *swing);
  }
  const auto axis_count =
      std::count_if(properties.begin(), properties.end(), [](const AxisProperties& p) { return p.any(); });
  const int joint_rows = counter.count_ + static_cast<int>(axis_count);
  if (joint_rows == 0) return append_empty_block(id);  // no sides either

  const int side_count = static_cast<int>(joint.bodies().size());
  joints_.push_back(
      {row_count(), joint_rows, static_cast<int>(sides_.size()), side_count, counter.count_, id});
  const bool arms = blocks == Blocks::kLeverArms && counter.any_point_ && joint_rows == 3 && side_count == 2;
  for (BodyId body : joint.bodies()) append_side(body.index, j, joint_rows, arms);

  RowSink sink;
  sink.rows_ = this;
  sink.joint_ = j;
  if (with_axes) world.parts_->soft_joints.soften(j, sink);
  joint.append_rows(sink);
  if (properties.empty()) return;
  AxisSink axes;
  axes.rows_ = this;
  axes.joint_index_ = j;
  axes.row_in_joint_ = counter.count_;
  axes.first_index_ = world.parts_->axes.first(j);
  axes.properties_ = properties.data();
  joint.append_axes(axes);
}

/// Its length; a linear spring without a length of its own has the displacements of Q against P in axes of A
/// instead, which are smooth where they meet, and its length only for a damper.
void Rows::append_spring(const World& world, ForceId id, Joints joints) {
  const LineSpring& spring = *world.force(id).spring();
  const int j = static_cast<int>(joints_.size());
  const bool moves = world.moves(spring.a) || world.moves(spring.b);
  const bool centred = spring.is_centred(), length = !centred || spring.is_damped();
  const int count = joints == Joints::kMoving && !moves ? 0 : 3 * centred + length;
  if (count == 0) return append_empty_block(id);
  joints_.push_back({row_count(), count, static_cast<int>(sides_.size()), 2, 0, id});
  for (BodyId body : {spring.a, spring.b}) append_side(body.index, j, count);
  const auto add = [&](const auto& part, int row, bool is_centred) {
    axis_rows_.push_back({row_count(), SpringRow{id, is_centred}});
    append(part, j, row, {}, RowKind::kSpring);
  };
  for (int k = 0; k < 3 && centred; ++k)
    add(row_parts::PointInPlane{spring.p_AP, Vec3::Unit(k), spring.p_BQ}, k, true);
  if (length) add(row_parts::Stretch{spring.p_AP, spring.p_BQ}, count - 1, false);
}

Rows::Rows(const World& world, AxisRows axis_rows, std::span<const ContactSlot> contacts, Joints joints,
           Springs springs, Blocks blocks)
    : spring_count_(springs == Springs::kIncluded ? static_cast<int>(world.springs().size()) : 0) {
  const std::size_t count = world.joint_count() + spring_count_ + contacts.size();
  joints_.reserve(count);
  sides_.reserve(2 * count);
  for (int j = 0; j < world.joint_count(); ++j) append_joint(world, j, axis_rows, joints, blocks);
  for (int s = 0; s < spring_count_; ++s) append_spring(world, world.springs()[s], joints);
  first_contact_row_ = row_count();
  for (const ContactSlot& slot : contacts) append_contact(slot);
  sort_by_body(world.body_count());
  cut_into_chunks();
}

}  // namespace taut
