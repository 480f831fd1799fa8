#pragma once

#include "solvers/common/settings.h"
#include "solvers/integrators/composition.h"
#include "solvers/simulator/step_division.h"
#include "solvers/simulator/substeps.h"

namespace taut {

/// Covers a step by as many equal sub-steps of a scheme as tension, rotation and convergence ask for.
/// (solvers/simulator, "Sub-steps")
class Substepping {
 public:
  /// `settings` live as long.
  explicit Substepping(const Settings& settings) : settings_(settings), composition_(settings.integrator) {}

  /// kDone; kStalled, kUnstable: sub-steps would have to be shorter than allowed, at last since laws or
  /// joints were not met, or for tension; kNotFinite, kBlind: as Scheme::advance().
  [[nodiscard]] Scheme::Outcome advance(Scheme& scheme, double dt, StepReport& report);
  /// What the last advance() left to do [s].
  double remaining() const { return remaining_; }

  /// What is remembered from step to step.
  StepDivision& division() { return division_; }

 private:
  bool after_stall(Scheme& scheme, Substeps& substeps, bool hard, bool forgot) const;

  const Settings& settings_;
  Composition composition_;
  StepDivision division_;
  double remaining_ = 0;
};

}  // namespace taut
