#include "solvers/simulator/step_division.h"

#include <algorithm>

#include "solvers/simulator/substep_tuning.h"

namespace taut {

double StepDivision::choose(double needed) {
  if (needed >= substeps_) {
    substeps_ = needed;
    quiet_ = 0;
  } else {
    most_substeps_ = quiet_ == 0 ? needed : std::max(most_substeps_, needed);
    if (++quiet_ >= SubstepTuning::kQuietSteps) {
      substeps_ = most_substeps_;
      quiet_ = 0;
    }
  }
  return substeps_;
}

void StepDivision::note_done(Status status) {
  reduced_budget_steps_ = status == Status::kInexact ? SubstepTuning::kReducedBudgetSteps
                                                     : std::max(reduced_budget_steps_ - 1, 0);
}

}  // namespace taut
