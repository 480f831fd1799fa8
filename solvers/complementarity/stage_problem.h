#pragma once

#include <algorithm>
#include <span>

#include "solvers/common/step_report.h"
#include "solvers/laws/row_law.h"

namespace taut {

/// One stage of a step: w = S λ + b with a law for each row.
struct StageProblem {
  std::span<const RowLaw> laws;
  std::span<const double> b;               ///< rates without λ
  std::span<const double> effective_mass;  ///< 1 / S_rr
  std::span<double> lambda, w;             ///< a guess, then the result
};

/// Impulses and rates of such a stage, to be measured.
struct StageSolution {
  std::span<const RowLaw> laws;
  std::span<const double> b, effective_mass, lambda, w;
};

/// What solving one has taken, and how good it is.
struct StageRecord {
  StageTimes times;
  int iterations = 0;   ///< Newton steps
  double residual = 0;  ///< largest natural residual of what was taken as met, relative
  double inexact = 0;   ///< the same beyond 1e-8, where that may be taken

  void add(const StageRecord& other) {
    times += other.times;
    iterations += other.iterations;
    residual = std::max(residual, other.residual);
    inexact = std::max(inexact, other.inexact);
  }
};

}  // namespace taut
