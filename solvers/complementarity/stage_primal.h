#pragma once

#include <span>
#include <vector>

#include "solvers/complementarity/contact_solver.h"
#include "solvers/complementarity/interior_point.h"
#include "solvers/complementarity/primal_dual_active_set.h"
#include "solvers/complementarity/stage_attempt.h"
#include "solvers/complementarity/stage_residual.h"
#include "solvers/complementarity/stage_tuning.h"

namespace taut {

class Archive;

/// Stages without contacts through the bodies, on the primal matrix: by Newton's method on the segments of
/// the guess, or by interior points.  (solvers/complementarity, "Ladder", "Many axes with friction")
class StagePrimal {
 public:
  StagePrimal(const StageModel& model, const StageResidual& residual, ContactSolver& contact_solver)
      : model_(model),
        residual_(residual),
        contact_solver_(contact_solver),
        interior_(model.system),
        primal_dual_(model.system) {}

  bool solve(const StageAttempt& attempt, StageRecord& record);

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive) { primal_dual_.transfer(archive); }

 private:
  using Tuning = StageTuning;

  bool solve_near(const StageAttempt& attempt, StageRecord& record);
  bool solve_by_interior_point(const StageAttempt& attempt, StageRecord& record);
  bool exact(const StageAttempt& attempt) const {
    return residual_.exact(attempt.solution(attempt.stage.lambda));
  }

  StageModel model_;
  const StageResidual& residual_;
  ContactSolver& contact_solver_;
  InteriorPoint interior_;
  PrimalDualActiveSet primal_dual_;
  std::vector<double> guess_;
};

}  // namespace taut
