#include "solvers/simulator/step_division.h"

#include <algorithm>

namespace taut {
namespace {

/// Steps in a row that ask for fewer sub-steps before there are fewer.
constexpr int kQuietSteps = 300;
/// Steps after one with inexact laws in which they may be inexact in any sub-step.
constexpr int kHardSteps = 10;

}  // namespace

double StepDivision::choose(double needed) {
  if (needed >= substeps_) {
    substeps_ = needed;
    quiet_ = 0;
  } else {
    most_substeps_ = quiet_ == 0 ? needed : std::max(most_substeps_, needed);
    if (++quiet_ >= kQuietSteps) {
      substeps_ = most_substeps_;
      quiet_ = 0;
    }
  }
  return substeps_;
}

void StepDivision::note_done(Status status) {
  hard_steps_ = status == Status::kInexact ? kHardSteps : std::max(hard_steps_ - 1, 0);
}

}  // namespace taut
