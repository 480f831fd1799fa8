#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "solvers/simulator/merged_bodies.h"
#include "solvers/simulator/simulator.h"
#include "solvers/simulator/stepper.h"
#include "solvers/simulator/weld_loads.h"

namespace taut {

class Archive;

/// Reactions of the welds that are merged away (WeldLoads), by joint of the source, each solved when it is
/// first asked for.                                                          (solvers/simulator, "Merged
/// bodies")
class WeldReactions {
 public:
  explicit WeldReactions(const MergedBodies& bodies) : bodies_(bodies) {}

  /// For the present topology.
  void renew();
  /// Something is merged.
  bool any() const { return loads_ != nullptr; }
  bool is_weld(JointId joint) const { return loads_ && loads_->is_weld(joint); }
  /// All rows of the source, with those of welds.
  const Rows& rows() const { return loads_->rows(); }

  // Where a step starts, or that it came to nothing.
  void start_step(const State& of_world);
  void forget_step() { start_.poses.clear(); }
  void forget_means() { mean_.clear(), forget_step(); }

  /// Mean reaction over the last step, of dt; zero if there was none, or if the joint has become a weld
  /// since.
  Reaction mean(JointId weld, const Stepper& stepper, double dt);
  /// Mean reactions of the last step are those of the bodies as they then were: solved at the latest when the
  /// source has changed and is about to be followed.
  void solve_means_of_old_source(const Stepper& stepper, double dt);
  /// Reaction in the present state, in which the rows of the stepper have these multipliers.
  Reaction present(JointId weld, const World& world, const Stepper& stepper,
                   std::span<const double> multipliers);

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  void solve_means(const Stepper& stepper, double dt);
  std::vector<Reaction> by_joint() const;

  const MergedBodies& bodies_;
  std::unique_ptr<WeldLoads> loads_;      // null if nothing is merged
  State start_;                           // of the source, at the start of the step; no poses: not known
  std::vector<Reaction> mean_, present_;  // by joint; empty: not solved
  std::int64_t present_version_ = -1;     // of the world that is stepped
};

}  // namespace taut
