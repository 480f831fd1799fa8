#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/world/diagnostics.h"
#include "core/world/world.h"
#include "core/world/world_versions.h"

/// Bodies that fixed joints hold together, as one body each.             (solvers/simulator, "Merged bodies")
namespace taut {

/// Bodies that move as one, and the joints that hold them.
struct MergedGroup {
  BodyId carrier;               ///< the first of the members, or the fixed body that they are welded to
  std::vector<BodyId> members;  ///< moving bodies, each after the one that its tree weld joins it to
  std::vector<JointId> welds;   ///< welds[i] joins members[i] to what comes before it; index −1: the root
  std::vector<JointId> loops;   ///< the other welds between them: what they bear is not unique
  bool fixed = false;           ///< the carrier is a fixed body

  friend bool operator==(const MergedGroup&, const MergedGroup&) = default;
};

/// The groups of a world.  A joint is merged away if Joint::rigid_pose() says that it is rigid and it is
/// attached, cannot break and has no compliance.  A group stays as it is, with its joints, where
///   - a weld has arms so long that round-off alone opens it by `tolerance`; the others may still be merged,
///   - its welds do not fit each other to `tolerance` [m, rad], so that the contradiction shows,
///   - it is welded to two fixed bodies or more,
///   - another joint has nothing else to join: all of its bodies are in the group, or are held fast, or
///   - a joint that can break has two of its bodies in it.
std::vector<MergedGroup> merged_groups(const World& world, double tolerance);

/// R I_B Rᵀ [kg m²]: about the centre of mass, in axes in which the body is turned by q.
Mat3 turned_inertia(const MassProperties& mass, const Quat& q);

/// A copy of a world, its source, in which each group is one rigid body: total mass, common centre of mass,
/// inertia by the parallel-axis theorem.  Ids of bodies, joints, axes and shapes are those of the source.
/// The body of a group is that with the id of its carrier; it has its frame at the common centre, in the axes
/// of the first member.  The other members are bodies that are fixed and touch nothing.  Welds are detached,
/// other joints and shapes sit on the carriers, forces see the bodies of the source.
///
///     X_WB = X_WC X_CB,    ω_B = ω_C,    v_B = v_C + ω_C × R_WC p_CB
/// (core/merging, Eq. 1)
class MergedWorld {
 public:
  /// @throws std::invalid_argument if a joint of a group has row parts that cannot be moved to other bodies.
  MergedWorld(const World& source, double tolerance);

  World& world() { return world_; }
  const World& world() const { return world_; }
  const std::vector<MergedGroup>& groups() const { return groups_; }
  /// Of each body of the source.
  const Carriers& carriers() const { return *carriers_; }
  bool is_carried(BodyId body) const { return carried_[body.index]; }

  /// Takes over what has changed in the source since the last time: topology and strengths may make other
  /// groups.  True if the state was set there or the groups were made anew; it is then the nearest one with
  /// closed welds, by the masses.
  bool update(const World& source);
  /// update() would change anything.
  bool is_behind(const World& source) const;
  /// Members sleep if their carrier does.
  void give_sleep(World& source) const;
  /// The source has the state of world() now; update() need not look at it.
  void note_state(const World& source) {
    seen_.state = source.state_version();
    known_ = source.state();
  }
  /// Wakes in the source so far are those that the bodies of world() have, too.
  void note_wakes(const World& source);
  /// State of the source for one of world().
  void expand(const State& merged, State& source) const;
  /// The weld that is open furthest in a state of the source, and by how much; index −1 without welds.
  struct OpenWeld {
    JointId joint;
    Gap gap;
  };
  OpenWeld widest_weld(const World& source, const State& state) const;
  /// World::forces() of the source at the last update().
  void source_forces(const State& source, std::span<Wrench> wrenches,
                     Springs springs = Springs::kIncluded) const;
  /// Both ends are on one carrier, so that it has no rows.
  bool is_within_carrier(const LineSpring& spring) const;
  /// Mass properties of a body of the source.
  const MassProperties& source_mass(BodyId body) const { return source_masses_[body.index]; }

 private:
  void rebuild(const World& source);
  void place_frames(const World& source);
  void make_bodies(const World& source);
  void make_joints(const World& source);
  void make_shapes(const World& source);
  void make_forces(const World& source);
  std::vector<std::shared_ptr<const Force>> carried_laws(const World& source) const;
  double held_potential(const World& source) const;
  void take_properties(const World& source);
  void take_state(const World& source);
  void take_wakes(const World& source);
  Pose nearest_pose(const MergedGroup& group, const World& source) const;
  Twist common_twist(const MergedGroup& group, const World& source) const;

  double tolerance_;
  World world_;
  std::vector<MergedGroup> groups_;
  std::shared_ptr<const Carriers> carriers_;
  std::vector<char> carried_;  // members
  std::vector<MassProperties> source_masses_;
  std::vector<char> source_fixed_;
  std::vector<int> wake_counts_seen_;
  State known_;  // of the source, as the merged world left it
  std::vector<std::shared_ptr<const Force>> source_laws_;
  detail::WorldVersions seen_{.state = -1};  // of the source; sleep is not looked at
  std::int64_t wake_version_seen_ = -1;
};

}  // namespace taut
