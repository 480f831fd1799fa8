#pragma once

#include <functional>

#include "solvers/complementarity/stage_attempt.h"
#include "solvers/friction/friction_problem.h"

namespace taut {

/// A stage of a step as a friction problem by itself, as it has just been solved, or not.  Contacts that may
/// press have their three rows, joints their equalities; all else (limits, motors, springs, spinning and
/// rolling friction, contacts at a bound of their impulse) is held at the impulses that were found.
///                                                                      (solvers/friction, Eq. 1, Eq. 2)
struct ContactStage {
  enum class Kind { kPositions, kVelocities };

  FrictionProblem problem;  ///< its r: impulses of both kicks together, on B [N·s]; compliances are in W
  Eigen::VectorXd found;    ///< r of the step
  Kind kind = Kind::kVelocities;  ///< RATTLE closes positions, then velocities
  bool met = false;               ///< the step takes it as solved
};

namespace detail {

/// While one lives, direct solves of stages with contacts on this thread tell its watch what they have left.
/// A watch that is null or empty is told nothing.
class StageWatchScope {
 public:
  using Watch = std::function<void(const ContactStage&)>;

  explicit StageWatchScope(const Watch* watch);
  ~StageWatchScope();
  StageWatchScope(const StageWatchScope&) = delete;
  StageWatchScope& operator=(const StageWatchScope&) = delete;

  /// To the watch of this thread, if there is one: what a stage has left in `solution`.  Stages in which no
  /// contact may press are not told.
  static void tell(const StageModel& model, const StageSolution& solution, bool met);

 private:
  const Watch* outer_;
};

}  // namespace detail
}  // namespace taut
