#include <algorithm>
#include <cmath>

#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/rattle.h"

// The two stages of a step by iterative impulses, for comparison: what RATTLE calls λ is then the
// pre-stabilisation of positions of [Weinstein2006], and μ the post-stabilisation of velocities.  Neither is
// closed to a tolerance: the report says how open they are.  (solvers/complementarity, "Iterative impulses")
namespace taut {
namespace {

/// Sweeps after which positions are looked at again: rows are linear in impulses, positions are not.
constexpr int kSweepsPerPass = 10;

}  // namespace

void Rattle::start_iterative() {
  find_forces();
  twists_from_momenta();
  std::fill(mu_.begin(), mu_.end(), 0.0);
  std::fill(force_multipliers_.begin(), force_multipliers_.end(), 0.0);
  update_step_limit(force_multipliers_);
  system_.rows().residual(state_, phi_);
  system_.rows().apply(system_.jacobian(), state_.twists, rates_);
  axes_.start(phi_, rates_);
}

/// λ that takes φ(q₁) towards 0 and the other rows towards their laws.
bool Rattle::stabilize_positions(double h, StepReport& report) {
  const Stopwatch watch(report.times.positions);
  std::fill(absorbed_.begin(), absorbed_.end(), Wrench{});
  for (int left = settings_.iterations;; left -= kSweepsPerPass) {
    try_positions(h);
    if (!std::isfinite(max_abs(phi_)) || !axes_.finite()) return false;
    if (left <= 0) break;
    rates_without(lambda_);
    const double tolerance = 0.1 * settings_.position_tolerance / h;
    if (!iterate(lambda_, std::min(left, kSweepsPerPass), tolerance, report)) return false;
    ++report.newton_iterations;
  }
  note_residual(lambda_);
  axes_.finish_positions(rates_);
  surprised_ = false;
  return true;
}

/// μ that takes J V + φ_t towards 0 and the other rows towards their laws.
bool Rattle::stabilize_velocities(StepReport& report) {
  std::fill(absorbed_.begin(), absorbed_.end(), Wrench{});
  begin_velocities();
  rates_without(mu_);
  if (!iterate(mu_, settings_.iterations, 0.1 * settings_.velocity_tolerance, report)) return false;
  end_velocities(report);
  note_residual(mu_);
  return std::isfinite(report.velocity_residual);
}

/// w = S λ + b with b in delta_; false if a number is not finite.
bool Rattle::iterate(std::span<double> lambda, int sweeps, double rate_tolerance, StepReport& report) {
  double least = 0;  // √ of the least inertia: a tolerance for impulses
  for (int r = 0; r < system_.row_count(); ++r)
    if (inertia_[r] > 0) least = least > 0 ? std::min(least, std::sqrt(inertia_[r])) : std::sqrt(inertia_[r]);
  const IterationLimits limits{settings_.solver, sweeps, settings_.relaxation, rate_tolerance * least};
  const IterationOutcome outcome =
      contact_solver_.iteration().solve(contacts_, laws_, delta_, lambda, w_, limits, absorbed_);
  report.sweeps += outcome.sweeps;
  if (!std::isfinite(outcome.residual)) return false;
  (void)laws_move(lambda, 0);
  contacts_.take_over(lambda, w_, rate_tolerance);
  return true;
}

}  // namespace taut
