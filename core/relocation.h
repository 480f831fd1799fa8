#pragma once

#include "core/state.h"

namespace taut {

/// Index of a shape in its World.
struct ShapeId {
  int index = -1;
  friend auto operator<=>(ShapeId, ShapeId) = default;
};

/// What the ids of one World are in another that World::append() has added it to.
struct Relocation {
  BodyId ground = kGround;                                       ///< what its ground has become
  int bodies = 0, joints = 0, axes = 0, shapes = 0, forces = 0;  ///< added to indices of the other things

  BodyId operator()(BodyId id) const { return id == kGround ? ground : BodyId{id.index + bodies}; }
  JointId operator()(JointId id) const { return {id.index + joints}; }
  AxisId operator()(const AxisId& id) const { return {(*this)(id.joint), id.axis}; }
  ShapeId operator()(ShapeId id) const { return {id.index + shapes}; }
  ForceId operator()(ForceId id) const { return {id.index + forces}; }
  int body(int index) const { return (*this)(BodyId{index}).index; }
  /// Of an entry of State::axes; a negative one is none and stays.
  int axis(int index) const { return index < 0 ? index : index + axes; }

  /// First that one, then this one.
  Relocation after(const Relocation& first) const {
    return {(*this)(first.ground), bodies + first.bodies, joints + first.joints,
            axes + first.axes,     shapes + first.shapes, forces + first.forces};
  }
};

}  // namespace taut
