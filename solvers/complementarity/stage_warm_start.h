#pragma once

#include <span>
#include <vector>

#include "solvers/complementarity/contact_solver.h"
#include "solvers/complementarity/contact_solver_tuning.h"
#include "solvers/complementarity/stage_attempt.h"
#include "solvers/complementarity/stage_pivoting.h"
#include "solvers/complementarity/stage_residual.h"
#include "solvers/complementarity/stage_tuning.h"

namespace taut {

class Archive;

/// Stages that the last impulses meet, as they are or nearly: what rests is done without a factor, or
/// with one linear solve where all contacts stick.  (solvers/complementarity, "Ladder")
class StageWarmStart {
 public:
  StageWarmStart(const StageModel& model, const StageResidual& residual, ContactSolver& contact_solver,
                 StagePivoting& pivoting);

  /// Rates that the last impulses may miss their laws by at rest, in a stage that begins now: `loose` after
  /// one that was solved, too, and where bodies are not the system, else `tight`.
  double begin(double loose, double tight);
  /// Takes the last impulses as they are, or with all contacts stuck; else laws that moved with them are
  /// renewed.
  StageVerdict solve(StageAttempt& attempt);

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  using Tuning = ContactSolverTuning;

  /// What impulses are to the laws: met, missed, or such that friction lets go or its load changes.
  enum class Trial { kMet, kMissed, kLawsMoved };

  bool may_rest() const;
  Trial accept(StageAttempt& attempt);
  Trial solve_all_sticking(StageAttempt& attempt);
  bool is_near_enough(const StageAttempt& attempt, double off) const;
  Trial try_impulses(StageAttempt& attempt, std::span<double> lambda, double off);

  StageModel model_;
  const StageResidual& residual_;
  ContactSolver& contact_solver_;
  StagePivoting& pivoting_;
  bool rested_ = false;  // of the last stage
  std::vector<double> held_;
  std::vector<int> segments_;
};

}  // namespace taut
