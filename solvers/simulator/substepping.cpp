#include "solvers/simulator/substepping.h"

#include <algorithm>
#include <cmath>

#include "core/base/interruption.h"

namespace taut {
namespace {

/// Laws may be met inexactly in sub-steps below this part of the step.
constexpr double kHardPart = 0.6;

}  // namespace

double Substepping::substeps_needed(const ImpulseScheme& scheme, double dt) const {
  return std::clamp(std::ceil(dt / composition_.step_limit(scheme) - 1e-9), 1.0,
                    double(settings_.max_substeps));
}

Substepping::Outcome Substepping::advance(ImpulseScheme& scheme, double dt, StepReport& report) {
  Substeps substeps(dt, division_.choose(substeps_needed(scheme, dt)), settings_.max_substeps);
  const bool hard = division_.hard();
  scheme.stages().accept_inexact(hard ? settings_.inexact_tolerance : 0, hard);
  bool forgot = false;
  while (!substeps.done()) {
    detail::poll_interrupt();
    const double h = substeps.next(composition_.step_limit(scheme));
    const ImpulseScheme::Outcome outcome = composition_.advance(scheme, h, report);
    switch (outcome) {
      case ImpulseScheme::Outcome::kDone:
        substeps.accept();
        break;
      case ImpulseScheme::Outcome::kImpact:
      case ImpulseScheme::Outcome::kOverload:
        substeps.end_next_at(scheme.time_to_event());
        break;
      case ImpulseScheme::Outcome::kUnstable:
        substeps.shorten(composition_.step_limit(scheme));
        break;
      case ImpulseScheme::Outcome::kStalled:
        forgot = after_stall(scheme, substeps, hard, forgot);
        break;
      case ImpulseScheme::Outcome::kNotFinite:
        return Outcome::kNotFinite;
      case ImpulseScheme::Outcome::kBlind:
        return Outcome::kBlind;
    }
    remaining_ = substeps.remaining();
    if (substeps.exhausted())
      return outcome == ImpulseScheme::Outcome::kUnstable ? Outcome::kUnstable : Outcome::kStalled;
  }
  division_.note_done(report.status);
  return Outcome::kDone;
}

/// Laws that could not be met: once more without impulses of contacts as a guess, then in shorter sub-steps,
/// and inexactly.  Joints: in shorter ones.  Returns whether that guess has been tried.
bool Substepping::after_stall(ImpulseScheme& scheme, Substeps& substeps, bool hard, bool forgot) const {
  const bool laws = !scheme.stages().active_set_outcome().ok() && !scheme.contacts().empty();
  if (laws) scheme.forget_contact_impulses();
  if (!laws || forgot) substeps.shorten();
  if (laws && (hard || substeps.below(kHardPart)))
    scheme.stages().accept_inexact(settings_.inexact_tolerance, false);
  return laws || forgot;
}

}  // namespace taut
