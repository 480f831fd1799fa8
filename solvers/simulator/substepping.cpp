#include "solvers/simulator/substepping.h"

#include <algorithm>
#include <cmath>

#include "core/base/interruption.h"

namespace taut {
namespace {

/// Laws may be met inexactly in sub-steps below this part of the step.
constexpr double kHardPart = 0.6;

}  // namespace

Substepping::Outcome Substepping::advance(Composition& composition, double dt, StepReport& report) {
  const double needed =
      std::clamp(std::ceil(dt / composition.step_limit() - 1e-9), 1.0, double(settings_.max_substeps));
  Substeps substeps(dt, division_.choose(needed), settings_.max_substeps);
  ImpulseScheme& scheme = composition.scheme();
  const bool hard = division_.hard();
  scheme.stages().accept_inexact(hard ? settings_.inexact_tolerance : 0, hard);
  bool forgot = false;
  while (!substeps.done()) {
    detail::poll_interrupt();
    const double h = substeps.next(composition.step_limit());
    const Scheme::Outcome outcome = composition.advance(h, report);
    switch (outcome) {
      case Scheme::Outcome::kDone:
        substeps.accept();
        break;
      case Scheme::Outcome::kImpact:
      case Scheme::Outcome::kOverload:
        substeps.end_next_at(composition.time_to_event());
        break;
      case Scheme::Outcome::kUnstable:
        substeps.shorten(composition.step_limit());
        break;
      case Scheme::Outcome::kStalled:
        forgot = after_stall(scheme, substeps, hard, forgot);
        break;
      case Scheme::Outcome::kNotFinite:
        return Outcome::kNotFinite;
      case Scheme::Outcome::kBlind:
        return Outcome::kBlind;
    }
    remaining_ = substeps.remaining();
    if (substeps.exhausted())
      return outcome == Scheme::Outcome::kUnstable ? Outcome::kUnstable : Outcome::kStalled;
  }
  division_.note_done(report.status);
  return Outcome::kDone;
}

/// Laws that could not be met: once more without impulses of contacts as a guess, then in shorter sub-steps,
/// and inexactly.  Joints: in shorter ones.  Returns whether that guess has been tried.
bool Substepping::after_stall(ImpulseScheme& scheme, Substeps& substeps, bool hard, bool forgot) const {
  const bool laws = !scheme.stages().active_set_outcome().ok() && !scheme.contacts().empty();
  if (laws) scheme.contact_pattern().forget_impulses();
  if (!laws || forgot) substeps.shorten();
  if (laws && (hard || substeps.below(kHardPart)))
    scheme.stages().accept_inexact(settings_.inexact_tolerance, false);
  return laws || forgot;
}

}  // namespace taut
