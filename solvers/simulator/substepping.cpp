#include "solvers/simulator/substepping.h"

#include <algorithm>
#include <cmath>

#include "core/base/interruption.h"

namespace taut {
namespace {

/// Laws may be met inexactly in sub-steps below this part of the step.
constexpr double kHardPart = 0.6;

}  // namespace

Scheme::Outcome Substepping::advance(Scheme& scheme, double dt, StepReport& report) {
  using enum Scheme::Outcome;
  const auto step_limit = [&] { return composition_.step_limit(scheme); };
  scheme.begin(dt);
  const double needed = std::clamp(std::ceil(dt / step_limit() - Substeps::kCountRoundOff), 1.0,
                                   double(settings_.max_substeps));
  Substeps substeps(dt, division_.choose(needed), settings_.max_substeps);
  const bool hard = division_.hard();
  scheme.accept_inexact(hard ? settings_.inexact_tolerance : 0, hard);
  bool forgot = false;
  while (!substeps.done()) {
    detail::poll_interrupt();
    const StepWorks kept = report.works;
    const Scheme::Outcome outcome = composition_.advance(scheme, substeps.next(step_limit()), report);
    if (outcome != kDone) report.works = kept;
    if (outcome == kNotFinite || outcome == kBlind) return outcome;
    if (outcome == kDone)
      substeps.accept();
    else if (outcome == kUnstable)
      substeps.shorten(step_limit());
    else if (outcome == kStalled)
      forgot = after_stall(scheme, substeps, hard, forgot);
    else  // something happens
      substeps.end_next_at(scheme.time_to_event());
    remaining_ = substeps.remaining();
    if (substeps.exhausted()) return outcome == kUnstable ? kUnstable : kStalled;
  }
  division_.note_done(report.status);
  return kDone;
}

/// Laws that could not be met: once more without impulses of contacts as a guess, then in shorter sub-steps,
/// and inexactly.  Joints: in shorter ones.  Returns whether that guess has been tried.
bool Substepping::after_stall(Scheme& scheme, Substeps& substeps, bool hard, bool forgot) const {
  const bool laws = scheme.drop_guess();
  if (!laws || forgot) substeps.shorten();
  if (laws && (hard || substeps.below(kHardPart))) scheme.accept_inexact(settings_.inexact_tolerance, false);
  return laws || forgot;
}

}  // namespace taut
