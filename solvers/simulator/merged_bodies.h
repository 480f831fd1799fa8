#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/merging/merged_world.h"
#include "solvers/common/contact_report.h"
#include "solvers/common/settings.h"

namespace taut {

/// The world that is stepped for the user's, its source: a copy in which bodies that fixed joints hold
/// together are one (Settings::merge_fixed_joints), or the source itself.  The copy follows the source before
/// a step, and the source gets what the copy has come to after it.                (solvers/simulator, "Merged
/// bodies")
class MergedBodies {
 public:
  /// @throws std::invalid_argument as MergedWorld.
  MergedBodies(World& source, const Settings& settings);

  World& source() { return source_; }
  const World& source() const { return source_; }
  World& world() { return merged_ ? merged_->world() : source_; }  ///< that is stepped
  /// The copy; null without one.
  const MergedWorld* merged() const { return merged_.get(); }
  bool is_behind() const { return merged_ && merged_->is_behind(source_); }
  void wake_all();

  // Before a step.
  /// The copy takes over what the user has changed in the source.
  void follow();
  /// The world that has the state as the user has left it.
  const World& as_set() const { return set_since_step_ ? source_ : world_; }

  // After it.
  /// Of the state that the members get, the weld that is open furthest.
  MergedWorld::OpenWeld place_members(const State& state);
  /// The gap of the weld that is open furthest, where the members are placed already.
  Gap placed_gap() const { return merged_->widest_weld(source_, placed_).gap; }
  /// What is done is published.
  void end_step(bool done) {
    set_since_step_ = false;
    if (done) publish();
  }
  /// The source gets what the copy has come to.
  void publish();
  /// There is nothing to publish: the source stays as it was.
  void note_published() { published_version_ = world_.state_version(); }
  /// The copy was read from a checkpoint, and so is who sleeps in it; the source has the same state.
  void give_sleep();
  void note_restored();

  // Names of the source.
  BodyId carrier(BodyId body) const { return merged_ ? merged_->carriers().bodies[body.index] : body; }
  /// A contact between carriers as one between the bodies that have the shapes.
  void refer_to_source(Contact& contact) const;
  /// Points of the source's bodies as those of carriers, and back.
  void refer_to_carriers(std::vector<ContactStretch>& stretches) const;
  void refer_to_source(std::vector<ContactStretch>& stretches) const;

 private:
  World& source_;
  std::unique_ptr<MergedWorld> merged_;
  World& world_;
  bool set_since_step_ = false;          // the source, since the last step
  State placed_;                         // of the source
  std::int64_t published_version_ = -1;  // of world_
};

}  // namespace taut
