#pragma once

#include <optional>
#include <span>
#include <vector>

#include "solvers/complementarity/active_set.h"
#include "solvers/complementarity/contact_solver.h"
#include "solvers/complementarity/stage_attempt.h"
#include "solvers/complementarity/stage_culprits.h"
#include "solvers/complementarity/stage_residual.h"
#include "solvers/complementarity/stage_tuning.h"

namespace taut {

class Archive;

/// Stages by the active set on the factor of S: again where static friction lets go, and until the friction
/// of contacts, which has the radius and slip of the solve before, agrees with their slip and normal impulse.
/// Remembers the segments of the rows.  (solvers/complementarity, "Ladder", "The
/// active set")
class StagePivoting {
 public:
  StagePivoting(const StageModel& model, const StageResidual& residual, StageCulprits& culprits);

  /// Left to the next rung where there are contacts or S is not formed.
  StageVerdict solve(StageAttempt& attempt);

  ActiveSet& active_set() { return *active_; }
  std::span<const int> segments() const { return active_->segments(); }
  /// The segments of a solution that was found without, for the next solve and for law errors.
  void take_segments(const StageSolution& solution);
  /// Rows of the system are others; row r was `from[r]`, −1: new.
  void move_rows(std::span<const int> from, std::span<const RowLaw> laws);
  /// How the last active set went.
  const ActiveSetOutcome& outcome() const { return outcome_; }
  void note_not_converged() { outcome_.status = ActiveSetStatus::kNotConverged; }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  using Tuning = StageTuning;

  bool has_many_bounded_rows() const;
  StageVerdict give_up(StageAttempt& attempt);
  StageVerdict after_stall(StageAttempt& attempt, bool polishes);

  StageModel model_;
  const StageResidual& residual_;
  StageCulprits& culprits_;
  std::optional<ActiveSet> active_;
  ActiveSetOutcome outcome_;
  std::vector<double> guess_;
  std::vector<int> segments_scratch_;
};

}  // namespace taut
