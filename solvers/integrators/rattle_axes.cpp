#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/rattle.h"

// The two stages of a step with limits, motors, friction and springs: the same Newton and the same projection
// as without them, with an active set in place of each solve.  (solvers/laws, "Axes")
namespace taut {
namespace {

/// Impacts closer together than this part of a step are one.
constexpr double kStrikeTogether = 1e-3;

}  // namespace

/// θ₀, θ̇₀ and the springs' and dampers' scale for the step.
void Rattle::begin_bounds(double h) {
  size_ = system_size();
  stages_.residual().begin_positions(std::abs(h), size_, state_.twists);
  system_.rows().residual(state_, phi_);
  if (stages_.friction_dominated())
    for (int r = 0; r < system_.row_count(); ++r) start_theta_[r] = std::clamp(phi_[r], -slack_, slack_);
  for (const Rows::AxisRow& axis : system_.rows().axis_rows()) start_theta_[axis.row] = phi_[axis.row];
  system_.rows().apply(system_.jacobian(), state_.twists, rates_);
  system_.rows().add_rate(state_, rates_);
  stages_.renew_effective_masses();
  axes_.begin(state_.time, h, start_theta_, rates_, stages_.effective_mass());
  axes_.find_unresolved(system_);
  contacts_.begin(h, rates_, stages_.effective_mass());
  std::vector<RowLaw>& laws = stages_.laws();
  for (int r = 0; r < system_.rows().first_contact_row(); ++r)
    if (system_.rows().is_equality(r)) laws[r] = RowLaw::equality();
}

bool Rattle::seek_impacts() {
  const bool axis = axes_.seek_impacts(rates_), contact = contacts_.impacts().seek(rates_);
  return axis || contact;
}

void Rattle::forget_impacts(bool for_good) {
  axes_.forget_impacts(for_good);
  contacts_.impacts().forget(for_good);
}

/// Where the present λ leads to: q₁, φ(q₁), the mean rates and their laws.
void Rattle::try_positions(double h) {
  kick_and_drift(h, end_of_step(h));
  for (int r = 0; r < system_.row_count(); ++r) rates_[r] = (phi_[r] - start_theta_[r]) / h;
  if (!contacts_.empty()) contact_rates();
  clear_loose_rows(phi_);
  renew_position_laws();
}

/// φ(q₁) = 0 and λ ∈ law of (θ(q₁) − θ₀)/h: Newton, whose linear problem w = S (λ − λᵏ) + wᵏ is an active
/// set.
bool Rattle::close_bounded_positions(double h, StepReport& report) {
  double last = std::numeric_limits<double>::infinity();
  const double patience = settings_.max_newton_iterations + 4;
  int exact = 0;  // solves for the laws alone
  const StageSolver::Renew renew = [this] { renew_position_laws(); };
  for (int iteration = 0;; ++iteration) {
    {
      const Stopwatch watch(report.times.positions);
      if (iteration == 0 || !stages_.friction_dominated() || !stages_.rested())
        try_positions(h);  // else λ is the same
    }
    if (!axes_.finite()) return false;
    double error = std::numeric_limits<double>::infinity();
    bool closed = false;
    if (iteration > 0) {
      const double open = stages_.law_error(lambda_, rates_, h) / (settings_.position_tolerance - slack_);
      const double laws = stages_.laws_off(lambda_, rates_);
      error = laws <= open ? open : laws;
      closed = open <= 1 && !contacts_.empty();
    }
    if (error <= 1) break;
    if (std::isnan(error) || (iteration > 0 && !std::isfinite(error)) || iteration >= patience) {
      stages_.note_culprits(lambda_, rates_);
      return false;
    }
    if (closed && exact++ == StageSolver::kExactSolves) {
      if (!stages_.take_inexact(error)) {
        stages_.note_culprits(lambda_, rates_);
        return false;
      }
      break;
    }
    if (iteration > 1 && !closed && error > kSlow * last) {
      if (refactored_ || error > 10 * last) {
        stages_.note_culprits(lambda_, rates_);
        return false;
      }
      refactor_at_iterate(h, report);
    }
    last = error;
    const Stopwatch watch(report.times.positions);
    const double tolerance = closed ? stages_.exact_tolerance() : 0.1 * settings_.position_tolerance / h;
    const StageSolver::Stage stage{lambda_, rates_, renew, kept_contact_jacobian(), iteration > 0};
    if (!stages_.solve(stage, tolerance, report)) {
      stages_.note_culprits(lambda_, stages_.rates());
      return false;
    }
    ++report.newton_iterations;
  }
  stages_.note_residual(lambda_, rates_);
  axes_.finish_positions(rates_);
  stages_.note_inexact(lambda_, rates_);
  prediction_missed_ =
      limit_.leaves_out_bodies() && axes_.any_broken();  // who was left out of the step limit may move
  return true;
}

/// Where contacts' part of J(q₀) is kept, if J is another now.
std::span<double> Rattle::kept_contact_jacobian() {
  if (!refactored_) return {};
  return std::span(start_jacobian_).subspan(contact_offset());
}

/// Free axes that the step takes to a limit with restitution are let through once, to see when they get
/// there.
/// @returns the length of the sub-step that ends with the first impact.
double Rattle::time_of_impact(double h, StepReport& report) {
  double time = h;
  if (iterative() ? stabilize_positions(h, report) : close_bounded_positions(h, report))
    time = first_impact(h);
  else
    forget_impacts(true);
  restore(report);
  return time;
}

void Rattle::renew_position_laws() {
  std::vector<RowLaw>& laws = stages_.laws();
  axes_.position_laws(rates_, laws);
  contacts_.position_laws(laws);
  for (int r : breaking_.rows()) laws[r] = RowLaw::none();
}

void Rattle::renew_velocity_laws() {
  std::vector<RowLaw>& laws = stages_.laws();
  axes_.velocity_laws(phi_, laws);
  contacts_.velocity_laws(laws);
  for (int r = 0; r < system_.rows().first_contact_row(); ++r)
    if (system_.rows().is_equality(r)) laws[r] = RowLaw::equality();
  for (int r : breaking_.rows()) laws[r] = RowLaw::none();
}

/// Rates and laws of the second kick.
void Rattle::begin_velocities() {
  stages_.residual().begin_velocities(state_.twists);
  // A first guess for its segments: the impulses of the first kick.
  std::copy(lambda_.begin(), lambda_.end(), mu_.begin());
  system_.rows().residual(end_of_step(0), phi_);
  twists_from_momenta();
  system_.rows().apply(system_.jacobian(), state_.twists, rates_);
  system_.rows().add_rate(state_, rates_);
  stages_.renew_effective_masses();
  contacts_.begin_velocities(rates_, stages_.effective_mass());
  renew_velocity_laws();
  system_.multiply(mu_, delta_);
  for (int r = 0; r < system_.row_count(); ++r) rates_[r] += delta_[r];
}

/// μ with J V + φ_t = 0 for the joints and the laws of the second kick for the axes.
bool Rattle::project_bounded_momenta(StepReport& report) {
  begin_velocities();
  const StageSolver::Renew renew = [this] { renew_velocity_laws(); };
  if (!axes_.finite() || !stages_.solve_velocities({mu_, rates_, renew}, report)) return false;
  take_impulses();
  note_velocities(report);
  stages_.note_residual(mu_, rates_);
  if (report.velocity_residual <= settings_.velocity_tolerance) return true;
  stages_.note_culprits(mu_, rates_);
  return false;
}

/// The first kick for the books, at the pose where it acted.
void Rattle::keep_first_kick() {
  works_.mean_rates(momenta_, kicked_, kick_jacobian(), kick_rates_);
  axes_.record_first_kick(lambda_, rates_, kick_rates_);
  contacts_.record_first_kick(lambda_, rates_, kick_rates_);
}

/// Rates of the contact rows in the drift: J(q₀) M⁻¹ p.  The momenta stay, so that is what counts, and not
/// how far points have come that were in contact at the start.
void Rattle::contact_rates() {
  works_.mean_rates(kicked_, kicked_, kick_jacobian(), kick_rates_);
  std::copy(kick_rates_.begin() + system_.rows().first_contact_row(), kick_rates_.end(),
            rates_.begin() + system_.rows().first_contact_row());
}

/// Where the Jacobian of contact rows begins, which are the last.
std::size_t Rattle::contact_offset() const {
  const Rows& rows = system_.rows();
  if (rows.contact_count() == 0) return rows.jacobian_size();
  return rows.sides()[rows.joints()[rows.contact_joint(0)].first_side].offset;
}

/// The first of the impacts that were sought; those at that time are due.
double Rattle::first_impact(double h) {
  const double first =
      std::max(std::min(axes_.first_impact(rates_), contacts_.impacts().first(rates_)), kStrikeTogether * h);
  axes_.take_impacts(first + kStrikeTogether * h, rates_);
  contacts_.impacts().take(first + kStrikeTogether * h, rates_);
  return first > (1 - kStrikeTogether) * h ? h : first;
}

}  // namespace taut
