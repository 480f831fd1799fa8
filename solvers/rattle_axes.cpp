#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/max_abs.h"
#include "solvers/rattle.h"
#include "solvers/stopwatch.h"

// The two stages of a step with limits, motors, friction and springs: the same Newton and the same projection
// as without them, with an active set in place of each solve.  (solvers/README, "Axes")
namespace taut {
namespace {

/// An iteration that takes away less than this part restarts with a fresh factor, or gives up.
constexpr double kSlow = 0.6;
/// Impulses on a level of their law are right to this part of the largest.
constexpr double kLevelTolerance = 1e-9;
/// More solves of a stage, because friction let go or velocities were not yet exact.
constexpr int kMaxSolves = 40;

}  // namespace

/// Rows that hold nothing by themselves: of axes, of soft joints, and of joints that broke.
void Rattle::clear_axis_rows(std::span<double> rows) const {
  clear_broken_rows(rows);
  for (const Rows::AxisRow& axis : system_.rows().axis_rows()) rows[axis.row] = 0;
}

/// θ₀, θ̇₀ and the springs' and dampers' scale for the step.
void Rattle::begin_axes(double h) {
  system_.rows().residual(state_, phi_);
  for (const Rows::AxisRow& axis : system_.rows().axis_rows()) start_theta_[axis.row] = phi_[axis.row];
  system_.rows().apply(system_.jacobian(), state_.twists, rates_);
  system_.rows().add_rate(state_, rates_);
  system_.row_inertias(inertia_);
  axes_.begin(state_.time, h, start_theta_, rates_, inertia_);
}

/// φ(q₁) = 0 and λ ∈ law of (θ(q₁) − θ₀)/h: Newton, whose linear problem w = S (λ − λᵏ) + wᵏ is an active
/// set.
bool Rattle::close_bounded_positions(double h, StepReport& report) {
  double last = std::numeric_limits<double>::infinity();
  const double patience = settings_.max_newton_iterations + 4;
  for (int iteration = 0;; ++iteration) {
    {
      const Stopwatch watch(report.times.positions);
      kick_and_drift(h);
      system_.rows().residual(end_of_step(h), phi_);
      for (int r = 0; r < system_.row_count(); ++r) rates_[r] = (phi_[r] - start_theta_[r]) / h;
    }
    clear_axis_rows(phi_);
    renew_position_laws();
    if (!axes_.finite()) {
      phi_[0] = std::numeric_limits<double>::quiet_NaN();  // for the diagnosis
      return false;
    }
    const double error = iteration > 0 ? law_error(h) : std::numeric_limits<double>::infinity();
    if (error <= settings_.position_tolerance) break;
    if (std::isnan(error) || (iteration > 0 && !std::isfinite(error)) || iteration >= patience) return false;
    if (iteration > 1 && error > kSlow * last) {
      if (refactored_ || error > 10 * last) return false;
      refactor_at_iterate(h, report);
    }
    last = error;
    const Stopwatch watch(report.times.positions);
    if (!solve_laws(
            lambda_, 0.1 * settings_.position_tolerance / h, [&] { renew_position_laws(); }, report))
      return false;
    ++report.newton_iterations;
  }
  axes_.finish_positions(rates_);
  surprised_ = false;
  return true;
}

/// Free axes that the step takes to a limit with restitution are let through once, to see when they get
/// there.
/// @returns the length of the sub-step that ends with the first impact.
double Rattle::time_of_impact(double h, StepReport& report) {
  double time = h;
  if (close_bounded_positions(h, report))
    time = axes_.first_impact(rates_);
  else
    axes_.forget_impacts(true);
  restore(report);
  return time;
}

/// Distance of the motion from the laws [m or rad]: of verticals from their rate, of levels from their range,
/// and of impulses from their level.
double Rattle::law_error(double h) const {
  double error = 0, largest = max_abs(lambda_);
  for (int r = 0; r < system_.row_count(); ++r) {
    const RowLaw& law = laws_[r];
    const int piece = active_.pieces()[r];
    const double w = rates_[r];
    double off = 0;
    if (RowLaw::is_vertical(piece)) {
      off = std::abs(w - law.rate(piece));
    } else {
      off = std::max({0.0, law.first(piece) - w, w - law.last(piece)});
      const double missing = std::abs(lambda_[r] - (law.force(piece) - law.slope * w));
      if (missing > kLevelTolerance * largest) off = std::max(off, missing / inertia_[r]);
    }
    if (!(h * off <= error)) error = h * off;
  }
  return error;
}

/// Solves w = S λ + b for the laws, with b such that the present λ gives the present rates; again where
/// static friction lets go.
template <typename Laws>
bool Rattle::solve_laws(std::span<double> lambda, double rate_tolerance, Laws&& renew, StepReport& report) {
  system_.multiply(lambda, delta_);
  for (int r = 0; r < system_.row_count(); ++r) delta_[r] = rates_[r] - delta_[r];
  for (int solve = 0; solve < kMaxSolves; ++solve) {
    outcome_ = active_.solve(laws_, delta_, lambda, w_, report.times, {.rate_tolerance = rate_tolerance});
    report.pivots += outcome_.pivots;
    report.complementarity_residual = std::max(report.complementarity_residual, outcome_.residual);
    if (!outcome_.ok()) return false;
    const bool broken_away = axes_.break_away(w_);
    if (!axes_.update_loads(system_.rows(), system_.jacobian(), lambda) && !broken_away) return true;
    renew();
  }
  return false;
}

void Rattle::renew_position_laws() {
  axes_.position_laws(rates_, laws_);
  for (int r : breaking_.rows()) laws_[r] = RowLaw::none();
}

void Rattle::renew_velocity_laws() {
  axes_.velocity_laws(phi_, laws_);
  for (int r = 0; r < system_.row_count(); ++r)
    if (system_.rows().is_equality(r)) laws_[r] = RowLaw::equality();
  for (int r : breaking_.rows()) laws_[r] = RowLaw::none();
}

/// μ with J V + φ_t = 0 for the joints and the laws of the second kick for the axes.
bool Rattle::project_bounded_momenta(StepReport& report) {
  // A first guess for its pieces: the impulses of the first kick.
  std::copy(lambda_.begin(), lambda_.end(), mu_.begin());
  system_.rows().residual(end_of_step(0), phi_);
  renew_velocity_laws();
  twists_from_momenta();
  system_.rows().apply(system_.jacobian(), state_.twists, rates_);
  system_.rows().add_rate(state_, rates_);
  system_.multiply(mu_, delta_);
  for (int r = 0; r < system_.row_count(); ++r) rates_[r] += delta_[r];
  if (!solve_laws(
          mu_, 0.1 * settings_.velocity_tolerance, [&] { renew_velocity_laws(); }, report))
    return false;
  for (int b = 0; b < world_.body_count(); ++b)
    if (inverse_mass_.moves(b))
      momenta_[b] = momenta_[b] + system_.rows().wrench_on(b, system_.jacobian(), mu_);
  twists_from_momenta();
  system_.rows().apply(system_.jacobian(), state_.twists, velocity_rows_);
  system_.rows().add_rate(state_, velocity_rows_);
  std::copy(velocity_rows_.begin(), velocity_rows_.end(), rates_.begin());
  clear_axis_rows(velocity_rows_);
  report.velocity_residual = max_abs(velocity_rows_);
  return report.velocity_residual <= settings_.velocity_tolerance;
}

/// The first kick for the books, at the pose where it acted.
void Rattle::keep_first_kick() {
  mean_rates(momenta_, kicked_, kick_jacobian(), kick_rates_);
  axes_.keep(lambda_, rates_, kick_rates_);
}

/// Mean rates of the rows in a kick from momenta p₀ to p₁ at the poses of state_.
void Rattle::mean_rates(std::span<const Wrench> from, std::span<const Wrench> to,
                        std::span<const double> jacobian, std::span<double> out) {
  for (int b = 0; b < world_.body_count(); ++b) mean_twists_[b] = mean_twist(b, from[b], to[b]);
  system_.rows().apply(jacobian, mean_twists_, out);
}

/// After a step: who is held now, and the books of both kicks.
void Rattle::finish_axes(StepReport& report) {
  system_.rows().residual(state_, phi_);  // axes are up to date here
  mean_rates(kicked_, momenta_, system_.jacobian(), kick_rates_);
  axes_.book(mu_, rates_, kick_rates_);
  axes_.finish_velocities(phi_, rates_, state_.time);
  report.axis_work = {};
  for (const AxisReport& axis : axes_.reports()) report.axis_work += axis.work;
}

}  // namespace taut
