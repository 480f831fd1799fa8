#pragma once

#include "solvers/integrators/impulse_scheme.h"
#include "solvers/simulator/inquiry.h"

namespace taut {

/// What cannot hold together `horizon` [s] after a state, without joints that broke in the step.
Contradiction contradiction_from(const Inquiry& asked, const State& state, double horizon);

/// Why a scheme of impulses, as all that can stall are, could not do a step in sub-steps as short as allowed:
/// of the causes that (solvers/diagnosis, "A step that failed") lists the first that is found ends the step.
class StallDiagnosis {
 public:
  explicit StallDiagnosis(const Inquiry& asked);

  /// `remaining`: what was left of the step [s]; `unstable`: the last sub-step was too long for tension.
  void end_step(double remaining, bool unstable);

 private:
  bool is_finite() const;
  void find_contradiction_ahead(double remaining);
  void find_stuck();
  void name_jam();
  void end_by_open_joints(Status status, bool unstable);
  void end_by_unmet_laws(Status status);
  void take_culprits();

  const Inquiry& asked_;
  ImpulseScheme& scheme_;
  const ActiveSetOutcome& laws_;
  Contradiction& found_;
};

}  // namespace taut
