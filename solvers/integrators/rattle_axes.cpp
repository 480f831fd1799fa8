#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/rattle.h"
#include "solvers/integrators/rattle_tuning.h"
#include "solvers/laws/contact_drift.h"

// The two stages of a step with limits, motors, friction and springs: the same Newton and the same projection
// as without them, with an active set in place of each solve.  (solvers/laws, "Axes")
namespace taut {

/// θ₀, θ̇₀ and the springs' and dampers' scale for the step.
void Rattle::begin_bounds(double h) {
  size_ = system_size(phase_.state.poses);
  stages_.residual().begin_positions(std::abs(h), size_, phase_.state.twists);
  system_.rows().residual(phase_.state, values_.phi);
  if (stages_.friction_dominated())
    for (int r = 0; r < system_.row_count(); ++r)
      values_.start_theta[r] = std::clamp(values_.phi[r], -slack_, slack_);
  for (const Rows::AxisRow& axis : system_.rows().axis_rows())
    values_.start_theta[axis.row] = values_.phi[axis.row];
  system_.rates_of(phase_.state, values_.rates);
  stages_.renew_effective_masses();
  axes_.begin(phase_.state.time, h, values_.start_theta, values_.rates, stages_.effective_mass(),
              phase_.state.axes);
  axes_.find_unresolved(system_);
  axes_.find_effective_masses(system_, stages_.effective_mass());
  contacts_.begin(h, values_.rates, stages_.effective_mass());
  stages_.set_equalities();
}

/// Where the present λ leads to: q₁, φ(q₁), the mean rates and their laws.
void Rattle::try_positions(double h, std::span<const double> lambda, std::span<Pose> q1, bool near) {
  kick_and_drift(h, lambda, q1, phase_.trial_end(h), values_.phi);
  for (int r = 0; r < system_.row_count(); ++r)
    values_.rates[r] = (values_.phi[r] - values_.start_theta[r]) / h;
  if (!contacts_.empty()) contact_rates(h, q1, near, values_.rates);
  projection_.clear_loose_rows(values_.phi);
  renew_laws();
}

/// How far joints are open and laws missed at the present λ, over their tolerances; `closed`: what is open is
/// within them, so that the laws alone are left.  Before the first solve nothing is known.
struct Rattle::PositionError {
  double error = std::numeric_limits<double>::infinity();
  bool closed = false;

  bool is_hopeless(int iteration, const Settings& settings) const {
    return iteration > 0 &&
           (!std::isfinite(error) || iteration >= settings.max_newton_iterations + RattleTuning::kMoreSolves);
  }
};

/// φ(q₁) = 0 and λ ∈ law of (θ(q₁) − θ₀)/h: Newton, whose linear problem w = S (λ − λᵏ) + wᵏ is one for
/// StageSolver.  When joints are closed, the laws alone are to be met to what round-off allows.
bool Rattle::close_bounded_positions(double h, std::span<double> lambda, std::span<Pose> q1,
                                     SubstepReport& report) {
  const StageSolver::Renew renew = [this] { renew_laws(); };
  double last = std::numeric_limits<double>::infinity();
  int exact = 0;                     // solves for the laws alone
  StageEnd end = StageEnd::kSolved;  // of the last solve
  for (int iteration = 0;; ++iteration) {
    if (end != StageEnd::kUnchanged) {
      const Stopwatch watch(report.times.positions);
      try_positions(h, lambda, q1, iteration > 0);
    }
    const PositionError at = position_error(h, lambda, iteration);
    if (!axes_.finite()) return false;
    if (at.error <= 1) break;
    if (at.is_hopeless(iteration, settings_)) return give_up(lambda, values_.rates);
    if (at.closed && exact++ == StageSolver::kExactSolves) {
      if (!stages_.take_inexact(at.error)) return give_up(lambda, values_.rates);
      break;
    }
    if (!at.closed && !keep_pace(at.error, last, h, q1, report)) return give_up(lambda, values_.rates);
    last = at.error;
    if (!at.closed) contacts_.hold_again();
    const Stopwatch watch(report.times.positions);
    const StageSolver::Stage stage{lambda, values_.rates, renew, iteration > 0};
    const double tolerance =
        at.closed ? stages_.exact_tolerance() : StageSolver::kRatePart * settings_.position_tolerance / h;
    end = stages_.solve(stage, tolerance, report);
    if (end == StageEnd::kFailed) return give_up(lambda, stages_.rates());
    ++report.newton_iterations;
  }
  finish_position_laws(lambda);
  return true;
}

Rattle::PositionError Rattle::position_error(double h, std::span<const double> lambda, int iteration) {
  if (iteration == 0 || !axes_.finite()) return {};
  const double tolerance = settings_.position_tolerance - slack_;
  double curved = h * contacts_.curved_off(lambda, values_.rates, stages_.rates()) / tolerance;
  if (iteration > RattleTuning::kManySolves) curved /= RattleTuning::kLateCurved;
  if (curved <= 1) {  // surfaces have turned as the last solve was told: laws are judged by its rates
    const int first = system_.rows().first_contact_row();
    std::copy(stages_.rates().begin() + first, stages_.rates().end(), values_.rates.begin() + first);
  }
  const double open = std::max(stages_.motion_residual(lambda, values_.rates, h) / tolerance, curved);
  const double laws = stages_.residual_over_tolerance(lambda, values_.rates);
  return {laws <= open ? open : laws, open <= 1 && !contacts_.empty()};
}

/// False; those who miss these laws most are named.
bool Rattle::give_up(std::span<const double> lambda, std::span<const double> rates) {
  stages_.note_culprits(lambda, rates);
  return false;
}

void Rattle::finish_position_laws(std::span<const double> lambda) {
  stages_.note_residual(lambda, values_.rates);
  axes_.finish_positions(values_.rates);
  stages_.note_inexact(lambda, values_.rates);
  // Who was left out of the step limit may move.
  prediction_missed_ = limit_.misses_freed_bodies();
}

/// Free axes that the step takes to a limit with restitution are let through once, to see when they get
/// there.
/// @returns the length of the sub-step that ends with the first impact.
double Rattle::time_of_impact(double h, std::span<double> lambda, std::span<Pose> q1, SubstepReport& report) {
  double time = h;
  axes_.repeat_first_kick();
  if (stages_.iterative() ? stabilize_positions(h, lambda, q1, report)
                          : close_bounded_positions(h, lambda, q1, report))
    time = impacts_.first(h, values_.rates);
  else
    impacts_.give_up();
  restore(report);
  return time;
}

/// The second kick: its rates, what contacts know of the first one, and μ that meets its laws.  `anew`: by
/// itself, as an impact without restitution, 0 ≤ μ_n ⊥ w_n ≥ 0 and |μ_t| ≤ μ_c μ_n, which takes energy
/// whatever the first has given.
bool Rattle::give_second_kick(double h, std::span<const double> guess, bool anew, std::span<double> mu,
                              SubstepReport& report) {
  phase_.second_kick(h);
  stages_.residual().begin_velocities(phase_.state.twists);
  std::copy(guess.begin(), guess.end(), mu.begin());
  system_.rows().residual(phase_.accepted_end(), values_.phi);
  phase_.twists_from(phase_.momenta);
  system_.rates_of(phase_.state, values_.rates);
  stages_.renew_effective_masses();
  contacts_.begin_velocities(values_.rates, stages_.effective_mass(), anew);
  if (anew) std::fill(mu.begin() + system_.rows().first_contact_row(), mu.end(), 0.0);
  stages_.set_equalities();
  renew_laws();
  if (!axes_.finite()) return false;
  values_.add_rates_of(mu, system_);
  return project_bounded_momenta(h, false, mu, report);
}

/// μ with J V + φ_t = 0 for the joints and the laws of the second kick for the axes, and the momenta that it
/// leads to.  What rounding leaves of the rates, with very different inertias, is met once more from there.
/// `exact`: to round-off.
bool Rattle::project_bounded_momenta(double h, bool exact, std::span<double> mu, SubstepReport& report) {
  const StageSolver::Renew renew = [this] { renew_laws(); };
  const StageSolver::Stage stage{mu, values_.rates, renew, false, exact};
  for (const bool again : {false, true}) {
    if (again) renew_laws();
    // Sweeps: bodies that are held fast do not take in all of the impulses.
    std::fill(absorbed_.begin(), absorbed_.end(), Wrench{});
    if (!(stages_.iterative()
              ? stages_.iterate(stage, settings_.iterations,
                                StageSolver::kRatePart * settings_.velocity_tolerance, absorbed_, report)
              : stages_.solve_velocities(stage, report)))
      return false;
    phase_.second_kick(h);
    phase_.add_impulses(mu);
    if (velocities_hold(mu, report)) return true;
    if (stages_.iterative()) break;
  }
  return projection_.accepts(report.velocity_residual) || give_up(mu, values_.rates);
}

/// Contacts take back what they gave in the first kick, and that gives energy: bodies that wedge each other
/// had impulses that balanced at q₀, and their friction does not where they part at q₁.
bool Rattle::second_kick_gives(std::span<const double> mu) {
  if (contacts_.empty() || !contacts_.take_back(mu)) return false;
  works_.mean_rates(phase_.kicked, phase_.momenta, system_.jacobian(), values_.kick_rates);
  double size = 0;
  for (int r = system_.rows().first_contact_row(); r < system_.row_count(); ++r)
    if (const double mass = stages_.effective_mass()[r]; mass > 0) size += 0.5 * mu[r] * mu[r] / mass;
  return contacts_.works().of_rigid(mu, values_.kick_rates) > RattleTuning::kGivenPart * size;
}

/// What momenta leave of the rates that they had to have is within the tolerance; sweeps have none.
bool Rattle::velocities_hold(std::span<const double> mu, SubstepReport& report) {
  for (int b = 0; b < static_cast<int>(absorbed_.size()); ++b)
    if (system_.inverse_mass(b).moves()) phase_.momenta[b] = phase_.momenta[b] - absorbed_[b];
  note_velocities(mu, report);
  if (stages_.iterative()) return std::isfinite(report.velocity_residual);
  return report.velocity_residual <= settings_.velocity_tolerance;
}

/// Impacts at the end of the step, after its velocities are closed without them.
bool Rattle::strike(double h, std::span<double> mu, SubstepReport& report) {
  return impact_stage_.strike([&] {
    renew_laws();
    return project_bounded_momenta(h, true, mu, report) && phase_.finite();
  });
}

/// Records the first kick, at the pose where it acted.
void Rattle::keep_first_kick(std::span<const double> lambda) {
  works_.mean_rates(phase_.momenta, phase_.kicked, start_jacobian_.get(), values_.kick_rates);
  axes_.record_first_kick(lambda, values_.rates, values_.kick_rates);
  contacts_.record_first_kick(lambda, values_.rates, values_.kick_rates);
}

/// Mean rates of the contact rows in the drift.  Far from the solution they are linear where contacts hold:
/// many that hold one body agree about its motion only as rigid bodies move.
void Rattle::contact_rates(double h, std::span<const Pose> q1, bool near, std::span<double> rates) {
  works_.mean_rates(phase_.kicked, phase_.kicked, start_jacobian_.get(), values_.kick_rates);
  const int first = system_.rows().first_contact_row();
  std::copy(values_.kick_rates.begin() + first, values_.kick_rates.end(), rates.begin() + first);
  // Sweeps do not follow, and in a step that failed with it nothing else does.
  if (stages_.iterative() || flattened_ || (!near && contacts_.any_hold())) return;
  drift_rates(contacts_, {system_.mass(), phase_.state.poses, q1, phase_.kicked, h}, rates);
}

}  // namespace taut
