#pragma once

#include <span>
#include <vector>

#include "core/world/diagnostics.h"
#include "solvers/simulator/stepper.h"

namespace taut {

/// The larger of both gaps, and NaN if one is.
Gap wider(const Gap& a, const Gap& b);

/// The proof of quality of a step: gaps, residuals, contacts and rank at the state that the user gets.
class StepQuality {
 public:
  void renew(int row_count);  ///< of a new pattern

  /// φ of all rows at a state, until the next call.
  std::span<const double> residual(const Rows& rows, const State& state);
  /// By φ, of joints, and of axes beyond rigid limits.
  static Gap gap(const Stepper& stepper, std::span<const double> phi);

  /// Fills the report at the end of a step, where the integrator is.
  void measure(Stepper& stepper, StepReport& report);

 private:
  Gap gap_at_end(const Stepper& stepper);
  double velocity_residual(Stepper& stepper);

  std::vector<double> phi_, rates_;  // of rows
};

}  // namespace taut
