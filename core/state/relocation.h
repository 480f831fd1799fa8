#pragma once

#include <memory>
#include <vector>

#include "core/state/state.h"

namespace taut {

/// Index of a shape in its World.
struct ShapeId {
  int index = -1;  ///< −1: none
  friend auto operator<=>(ShapeId, ShapeId) = default;
};

/// Bodies of another world that carry the bodies of one, several perhaps on the same.
struct Carriers {
  std::vector<BodyId> bodies;  ///< of each body the one that carries it
  std::vector<Pose> frames;    ///< X_CB: where it is on that
};

/// What the ids of one World are in another that World::append() has added it to, or in that of its merged
/// bodies (core/merging/merged_world.h), where parts are in axes of the bodies that carry theirs.
struct Relocation {
  BodyId ground = kGround;                                       ///< what its ground has become
  int bodies = 0, joints = 0, axes = 0, shapes = 0, forces = 0;  ///< added to indices of the other things
  std::shared_ptr<const Carriers> carriers{};  ///< of the bodies that have these ids; null: themselves
  /// The places that the bodies of a joint have in Joint::bodies() there; empty: unchanged.
  std::vector<int> sides{};
  /// What the id of a body has become.
  BodyId operator()(BodyId id) const { return carriers ? carriers->bodies[shifted(id).index] : shifted(id); }
  /// X_CB, the pose of a body B in the body C that carries it; the identity if none does.
  Pose frame(BodyId id) const { return carriers ? carriers->frames[shifted(id).index] : Pose{}; }
  int side(int place) const { return sides.empty() ? place : sides[place]; }  ///< of a place in the joint
  JointId operator()(JointId id) const { return {id.index + joints}; }        ///< what it has become
  AxisId operator()(const AxisId& id) const { return {(*this)(id.joint), id.axis}; }  ///< what it has become
  ShapeId operator()(ShapeId id) const { return {id.index + shapes}; }                ///< what it has become
  ForceId operator()(ForceId id) const { return {id.index + forces}; }                ///< what it has become
  int body(int index) const { return (*this)(BodyId{index}).index; }  ///< of an index of a body
  /// What an index in State::axes has become; a negative one is none and stays.
  int axis(int index) const { return index < 0 ? index : index + axes; }

  /// First that one, then this one.
  Relocation after(const Relocation& first) const;

 private:
  /// Carriers of all bodies: frames on frames.  @pre the first changes no ids (World::set_joint_frame()).
  void carry(const Relocation& second, const Relocation& first);
  BodyId shifted(BodyId id) const { return id == kGround ? ground : BodyId{id.index + bodies}; }
};

}  // namespace taut
