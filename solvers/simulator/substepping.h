#pragma once

#include <optional>

#include "solvers/common/settings.h"
#include "solvers/integrators/composition.h"
#include "solvers/simulator/step_division.h"
#include "solvers/simulator/substeps.h"

namespace taut {

/// Covers a step by as many equal sub-steps of a scheme as tension, rotation and convergence ask for: says
/// how long each advance of the scheme is to be, and by what becomes of it which is next.
/// (solvers/simulator, "Sub-steps")
class Substepping {
 public:
  /// `settings` live as long.
  explicit Substepping(const Settings& settings) : settings_(settings), composition_(settings.integrator) {}

  /// A step of dt [s] begins.
  void begin(Scheme& scheme, double dt);
  /// It has neither come to its end nor failed.
  bool goes_on() const { return !outcome_; }
  /// How long the next advance is [s]: a sub-step, or a stage of one.
  double next(const Scheme& scheme);
  /// Looks at what became of it, with its report; the step gets that of a sub-step which is done, and the
  /// cost of one that is not.
  void react(Scheme::Outcome outcome, const SubstepReport& report, Scheme& scheme, SubstepReport& step);

  /// How the step ended.  kDone; kStalled, kUnstable: sub-steps would have to be shorter than allowed, at
  /// last since laws or joints were not met, or for tension; kNotFinite, kBlind: as Scheme::advance().
  Scheme::Outcome outcome() const { return *outcome_; }
  /// What is left to do of it [s].
  double remaining() const { return substeps_.remaining(); }

  /// What is remembered from step to step.
  StepDivision& division() { return division_; }

 private:
  double step_limit(const Scheme& scheme) const { return composition_.step_limit(scheme); }
  void accept(SubstepReport& step);
  void after_stall(Scheme& scheme);

  const Settings& settings_;
  Composition composition_;
  StepDivision division_;
  std::optional<Scheme::Outcome> outcome_;
  Substeps substeps_;
  SubstepReport stages_;                // of the present one that are done
  bool hard_ = false, forgot_ = false;  // laws may be met inexactly at once; impulses have been no guess once
};

}  // namespace taut
