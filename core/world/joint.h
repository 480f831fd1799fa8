#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/constraints/axis_parts.h"
#include "core/constraints/row_parts.h"
#include "core/constraints/row_sinks.h"
#include "core/state/state.h"

namespace taut {

/// A point that a wire or rod passes, from the centre of mass of its body in body axes.
struct WirePoint {
  BodyId body;               ///< that it is fixed to
  Vec3 p_BP = Vec3::Zero();  ///< [m]
};

/// A joint between body A and body B, and for some types further bodies, described once and then immutable.
/// A type is one header in core/joints: its constructor checks the input, append_rows() lists the row parts
/// it is made of and append_axes() the coordinates that it leaves free. Nothing else knows the type.
class Joint {
 public:
  Joint(BodyId a, BodyId b) : bodies_{a, b} {}
  /// Two or more different bodies; the first two are A and B.
  explicit Joint(std::vector<BodyId> bodies) : bodies_(std::move(bodies)) {}
  virtual ~Joint() = default;

  virtual std::string_view type() const = 0;          ///< its name, as "hinge"
  virtual void append_rows(RowSink& rows) const = 0;  ///< lists its row parts
  /// The free axes, which can have axis properties (core/axes); always the same ones.  Rotations that
  /// are no scalar coordinate, as the three of a ball joint, are none.
  virtual void append_axes(AxisSink&) const {}
  /// Point of B (from its centre of mass, body axes) about which the reaction torque is reported.
  virtual Vec3 reaction_point_B() const = 0;

  /// The straight sections that a joint over a distance consists of, from end to end: rods, ropes, wires.
  /// Empty for joints whose bodies meet.
  virtual std::vector<WirePoint> course() const { return {}; }

  /// X_AB, if the joint holds B rigidly to A and has neither axes nor rows that follow the time: the two can
  /// then be merged into one body (core/merging/merged_world.h).
  virtual std::optional<Pose> rigid_pose() const { return {}; }

  /// One more than the highest entry of State::axes that its rows read (couplings of axes); 0 for most.
  virtual int axes_needed() const { return 0; }
  /// The joints whose axes its rows read: it goes when one of them goes.
  virtual std::vector<JointId> couples() const { return {}; }

  BodyId a() const { return bodies_[0]; }                     ///< body A
  BodyId b() const { return bodies_[1]; }                     ///< body B
  std::span<const BodyId> bodies() const { return bodies_; }  ///< A, B and further ones

 private:
  std::vector<BodyId> bodies_;
};

}  // namespace taut
