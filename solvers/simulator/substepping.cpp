#include "solvers/simulator/substepping.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/interruption.h"
#include "solvers/simulator/substep_tuning.h"

namespace taut {

void Substepping::begin(Scheme& scheme, double dt) {
  scheme.begin(dt);
  const double needed = std::clamp(std::ceil(dt / step_limit(scheme) - SubstepTuning::kCountRoundOff), 1.0,
                                   double(settings_.max_substeps));
  substeps_ = Substeps(dt, division_.choose(needed), settings_.max_substeps);
  composition_.forget();
  stages_ = {};
  outcome_.reset();
  hard_ = division_.hard();
  forgot_ = false;
  scheme.accept_inexact(hard_ ? settings_.inexact_tolerance : 0, hard_);
}

double Substepping::next(const Scheme& scheme) {
  if (composition_.is_done()) {
    detail::poll_interrupt();
    composition_.begin(scheme, substeps_.next(step_limit(scheme)));
  }
  return composition_.next();
}

void Substepping::react(Scheme::Outcome outcome, const SubstepReport& report, Scheme& scheme,
                        SubstepReport& step) {
  using enum Scheme::Outcome;
  if (outcome == kDone) {
    add_taken(stages_, report);
    if (composition_.is_done()) accept(step);
    return;
  }
  add_cost(stages_, report);
  add_cost(step, std::exchange(stages_, {}));
  const bool lost = outcome == kNotFinite || outcome == kBlind;
  if (!lost) composition_.give_up(scheme, step);
  if (lost)
    outcome_ = outcome;
  else if (outcome == kUnstable)
    substeps_.shorten(step_limit(scheme));
  else if (outcome == kStalled)
    after_stall(scheme);
  else  // something happens
    substeps_.end_next_at(scheme.time_to_event());
  if (substeps_.exhausted()) outcome_ = outcome == kUnstable ? kUnstable : kStalled;
}

/// The sub-step is done, and the step with the last one.
void Substepping::accept(SubstepReport& step) {
  add_taken(step, std::exchange(stages_, {}));
  substeps_.accept();
  if (!substeps_.done()) return;
  outcome_ = Scheme::Outcome::kDone;
  division_.note_done(step.status);
}

/// Laws that could not be met: once more without impulses of contacts as a guess, then in shorter sub-steps,
/// and inexactly.  Joints: in shorter ones.
void Substepping::after_stall(Scheme& scheme) {
  const bool laws = scheme.drop_guess();
  if (!laws || forgot_) substeps_.shorten();
  if (laws && (hard_ || substeps_.below(SubstepTuning::kHardPart)))
    scheme.accept_inexact(settings_.inexact_tolerance, false);
  forgot_ = laws || forgot_;
}

}  // namespace taut
