#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/constraints/rows.h"
#include "core/world/world.h"
#include "solvers/laws/axes/axis_limit_law.h"

namespace taut {

class Archive;

/// The rows that are no equalities, in the order of Rows::axis_rows(), and what acts along each of them: the
/// properties of a free axis, unless own ones are made in their place; of a softened row of a joint a spring
/// at rest where its gap is closed; of a spring between bodies that spring.
///
/// A spring between bodies has its length L as coordinate and, like a joint, one block in the Delassus
/// matrix; its stiffness across the line, T/L, is geometric stiffness.  A linear one of natural length 0 has
/// the three displacements of its points in axes of A instead, which are smooth where L is not, and L for its
/// damper only.  Elsewhere ends may pass each other within a step: L then counts as negative, and that one
/// step is not exact, since the force jumps.
class AxisTable {
 public:
  AxisTable(const World& world, const Rows& rows);

  std::size_t size() const { return rows_.size(); }
  const std::vector<Rows::AxisRow>& rows() const { return rows_; }
  int row(std::size_t i) const { return rows_[i].row; }
  /// The axis whose row it is, if it is one.
  const AxisId* axis(std::size_t i) const { return rows_[i].axis(); }
  bool angular(std::size_t i) const { return angular_[i]; }
  const World& world() const { return world_; }

  /// Reads the properties again if they have changed in the World; false if not.  Own ones are left out then.
  bool refresh();
  /// Those in force.
  const AxisProperties& properties(std::size_t i) const { return from_own_[i] ? own_[i] : given(i); }
  /// Those of the World, for an axis.
  const AxisProperties& given(std::size_t i) const { return world_.axis_properties(*rows_[i].axis()); }
  /// Puts own properties in force, to be changed; at first those of the World.
  AxisProperties& make_own(std::size_t i);
  AxisProperties& own(std::size_t i) { return own_[i]; }

  /// The axes and softened rows of a joint give no force any more.
  void release(JointId joint);
  bool released(std::size_t i) const { return released_[i]; }
  bool has_rigid_limit(std::size_t i) const { return !released_[i] && taut::has_rigid_limit(properties(i)); }
  /// Axes with a rigid limit, with friction that grows with the load, and with what may be stiff, a spring or
  /// a soft limit, among those of the World; all that have own properties are among the last two.  @{
  std::span<const int> limited() const { return limited_; }
  std::span<const int> loaded() const { return loaded_; }
  std::span<const int> sprung() const { return sprung_; }  /// @}
  /// A motor of any force.
  bool has_unbounded_motor(std::size_t i) const;

  /// Which are released, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  /// What acts along a row that is none of an axis.
  AxisSpring spring_of(const Rows::SoftenedRow& row, bool angular) const;
  AxisSpring spring_of(const Rows::SpringRow& row) const;

  const World& world_;
  std::vector<Rows::AxisRow> rows_;
  std::vector<AxisProperties> own_;  // by row; empty if there are none
  std::vector<char> from_own_, released_, angular_;
  std::vector<int> limited_, loaded_, sprung_;
  std::int64_t axis_version_ = -1;  // of World, when properties were read
};

}  // namespace taut
