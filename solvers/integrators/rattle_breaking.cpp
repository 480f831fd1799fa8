#include "solvers/integrators/rattle.h"

// Joints that leave within a step.  (solvers/laws, "Breaking")
namespace taut {

/// After a sub-step whose velocities are closed: true if it was taken back because a joint does not bear it.
bool Rattle::break_joints(double h, std::span<const double> lambda, std::span<const double> mu,
                          SubstepReport& report) {
  if (!breaking_.check({system_, phase_.state, lambda, mu, h})) return false;
  time_to_event_ = breaking_.time_to_break();
  const bool now = time_to_event_ == 0;
  impacts_.end();
  roll_back(report);
  tension_.end();
  if (!now) return true;
  release_overloaded();
  if (!stages_.iterative()) system_.factorize(report.times);
  return true;
}

/// From the present state on the overloaded joints give no impulse: their rows are masked, so that pattern
/// and analysis stay.
void Rattle::release_overloaded() {
  breaking_.release(phase_.state);
  for (const BreakEvent& event : breaking_.events()) axes_.release(event.joint);
  for (auto* rows : {&values_.lambda, &values_.mu, &values_.force_multipliers}) breaking_.clear_rows(*rows);
  prediction_.clear(breaking_.rows());
  prediction_.restart();  // loads jump
  if (bounded()) return;
  broken_states_.assign(system_.row_count(), 0.0);
  for (int r : breaking_.rows()) broken_states_[r] = kMasked;
  system_.set_row_states(broken_states_);
}

}  // namespace taut
