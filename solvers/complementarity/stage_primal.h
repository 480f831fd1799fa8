#pragma once

#include <span>
#include <vector>

#include "solvers/complementarity/contact_islands.h"
#include "solvers/complementarity/contact_solver.h"
#include "solvers/complementarity/interior_point.h"
#include "solvers/complementarity/primal_dual_active_set.h"
#include "solvers/complementarity/stage_attempt.h"
#include "solvers/complementarity/stage_culprits.h"
#include "solvers/complementarity/stage_pivoting.h"
#include "solvers/complementarity/stage_residual.h"
#include "solvers/complementarity/stage_tuning.h"

namespace taut {

class Archive;

/// Stages through the bodies, on the primal matrix: contacts island by island, axes by Newton's method on the
/// segments of the guess or by interior points; again where static friction lets go or its load changes.
/// (solvers/complementarity, "Ladder", "Many contacts", "Many axes with friction")
class StagePrimal {
 public:
  StagePrimal(const StageModel& model, const StageResidual& residual, ContactSolver& contact_solver,
              StagePivoting& pivoting, StageCulprits& culprits);

  StageVerdict solve(StageAttempt& attempt);

  /// The system has other rows.
  void forget_pattern() { islands_.forget_pattern(); }
  /// Threads that could not be started.
  int missing_threads() const { return islands_.missing_threads(); }
  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer_axes(Archive& archive) { primal_dual_.transfer(archive); }
  void transfer_islands(Archive& archive) { islands_.transfer(archive); }

 private:
  using Tuning = StageTuning;

  bool solve_axes(const StageAttempt& attempt, StageRecord& record);
  bool solve_near(const StageAttempt& attempt, StageRecord& record);
  bool solve_by_interior_point(const StageAttempt& attempt, StageRecord& record);
  bool solve_on_segments(const StageAttempt& attempt, const PrimalDualLimits& limits, StageRecord& record);
  bool exact(const StageAttempt& attempt) const {
    return residual_.exact(attempt.solution(attempt.stage.lambda));
  }

  StageModel model_;
  const StageResidual& residual_;
  ContactSolver& contact_solver_;
  StagePivoting& pivoting_;
  StageCulprits& culprits_;
  ContactIslands islands_;
  InteriorPoint interior_;
  PrimalDualActiveSet primal_dual_;
  std::vector<double> guess_;
};

}  // namespace taut
