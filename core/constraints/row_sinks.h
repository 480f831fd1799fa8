#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/axes/axis.h"
#include "core/constraints/part_store.h"
#include "core/state/relocation.h"
#include "core/state/swing_axes.h"

/// What joints hand their row parts and free axes to (rows.h).
namespace taut {

class Joint;
class Rows;

/// Two bodies of a joint by their place in Joint::bodies(): the A and B of a row part.
struct Between {
  int a = 0, b = 1;  ///< places in Joint::bodies()
};

namespace detail {
/// A part by itself, with its rows from 0 on.
struct RowGroup {
  std::shared_ptr<const PartStoreBase> part;
  int rows = 0;
  bool angular = false;
};
std::vector<int> body_indices(const Joint* joint);
/// X_CB of a body of the joint, by its place in Joint::bodies().
Pose carrier_frame(const Relocation& to, const Joint& joint, int side);
/// The places of the two bodies in the joint as relocated.
inline Between relocated(const Between& sides, const Relocation& to) {
  return {to.side(sides.a), to.side(sides.b)};
}
/// A part of `joint` as the relocation changes it.
template <typename Part>
Part relocated(const Part& part, const Relocation& to, const Joint& joint, const Between& sides) {
  if constexpr (kIsWide<Part>)
    return relocated(part, to);
  else if (to.carriers)
    return carried(part, carrier_frame(to, joint, sides.a), carrier_frame(to, joint, sides.b));
  else
    return part;
}
}  // namespace detail

/// What a joint hands its row parts to: once to count its rows, then once to place them.
class RowSink {
 public:
  template <typename Part>
  void add(const Part& part, Between sides = {});  ///< the next rows of the joint, between these bodies
  /// All parts of a joint of another world, as World::append() or merging has changed its ids and bodies.
  void add_rows_of(const Joint& joint, const Relocation& to);
  /// Rows in metres, or in radians, of the joint give way by its compliance.
  void soften(bool translation, bool rotation) { soft_translation_ = translation, soft_rotation_ = rotation; }
  /// Appends the parts of a joint that give way to `parts`, each by itself.
  void keep_soft_parts(const Joint& joint, std::vector<detail::RowGroup>& parts) {
    made_for_ = &joint, groups_ = &parts;
  }

 private:
  friend class Rows;
  template <typename Part>
  void add_here(const Part& part, Between sides);
  template <typename Part>
  void place(const Part& part, Between sides);
  Rows* rows_ = nullptr;                                   // null while counting
  std::vector<detail::RowGroup>* groups_ = nullptr;        // … or where to keep the parts by themselves
  const Joint* made_for_ = nullptr;                        // with groups_
  bool soft_translation_ = false, soft_rotation_ = false;  // that a compliance softens
  const Relocation* relocation_ = nullptr;                 // null: parts stay as they are
  const Joint* source_ = nullptr;                          // … that this joint lists
  int joint_ = 0;
  int count_ = 0;
  bool any_point_ = false;
};

/// A free axis as its joint lists it.
struct AxisInfo {
  std::string name;          ///< unique in its joint
  bool angular = false;      ///< in radians; otherwise in metres
  bool accumulates = false;  ///< only its increments are known: no place for limits and springs
  AxisLimits limits;         ///< that the axis has from the start, as a rope; without effect if infinite
  /// The coordinate as a single row, with one Jacobian block of six for each of `bodies`.
  std::shared_ptr<const detail::PartStoreBase> coordinate;
  std::vector<int> bodies;  ///< indices of its bodies
  SwingAxes across{};       ///< of a swing
  bool is_wound = false;    ///< the length of a rope, which a winch can change
};

/// What a joint lists its free axes in: names for the World, or rows for Rows.
class AxisSink {
 public:
  /// An axis with the coordinate of `part`, a row part of one row (core/constraints/axis_parts.h).
  template <typename Part>
  void add(std::string_view name, const Part& part, Between sides = {});
  /// All axes of a joint of another world, as World::append() or merging has changed its ids and bodies.
  void add_axes_of(const Joint& joint, const Relocation& to);
  /// Appends a description of each axis of the joint to `infos`; the first has this index in State::axes.
  void describe(const Joint& joint, int first_index, std::vector<AxisInfo>& infos) {
    joint_ = &joint, first_index_ = first_index, infos_ = &infos;
  }
  /// The axis added last has these limits from the start.
  void limit(const AxisLimits& limits) {
    if (infos_) infos_->back().limits = limits;
  }
  /// The axis added last is the length of a rope, which a winch can change (AxisMotor::pulls_only).
  void wind() {
    if (infos_) infos_->back().is_wound = true;
  }

 private:
  friend class Rows;
  template <typename Part>
  void place(std::string_view name, const Part& part, Between sides);
  const Relocation* relocation_ = nullptr;  // null: parts stay as they are
  const Joint* source_ = nullptr;           // … that this joint lists
  const Joint* joint_ = nullptr;
  std::vector<AxisInfo>* infos_ = nullptr;  // where to describe the axes …
  Rows* rows_ = nullptr;                    // … or to place the next of them that has properties
  const AxisProperties* properties_ = nullptr;
  int joint_index_ = 0, first_index_ = 0, row_in_joint_ = 0;
  int count_ = 0;
};

}  // namespace taut
