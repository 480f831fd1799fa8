#pragma once

#include "solvers/common/step_report.h"

namespace taut {

class Archive;

/// Into how many sub-steps a simulation divides its steps, and whether laws may be met inexactly at once.  A
/// symplectic scheme keeps its energy only while its step stays the same, so the count goes up at once and
/// comes down only after a long quiet time.                           (solvers/simulator, "Sub-steps")
class StepDivision {
 public:
  /// Sub-steps of a step that needs so many.
  double choose(double needed);
  /// Laws were hard to meet lately: they are met inexactly at once.
  bool hard() const { return reduced_budget_steps_ > 0; }
  void note_done(Status status);
  void forget_reduced_budget() { reduced_budget_steps_ = 0; }

  /// To or from bytes (checkpoint_memory.cpp); no more than `most` sub-steps are believed.
  void transfer(Archive& archive, double most);

 private:
  double substeps_ = 1, most_substeps_ = 1;  // at present, and the most asked for in the quiet time
  int quiet_ = 0;                            // steps in a row that asked for fewer
  int reduced_budget_steps_ = 0;             // to come
};

}  // namespace taut
