#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/rattle.h"

// The two stages of a step with limits, motors, friction and springs: the same Newton and the same projection
// as without them, with an active set in place of each solve.  (solvers/laws, "Axes")
namespace taut {
namespace {

/// More solves of a stage, because friction let go or velocities were not yet exact.
constexpr int kMaxAxisSolves = 40;
/// With contacts, their friction is looked at every so many solves: if it has not come nearer to Coulomb's
/// law by this factor, Newton's method takes over, for as many stages.
constexpr int kFrictionPatience = 4, kNewtonsInARow = 60;
constexpr double kFrictionProgress = 0.2;
/// Rounds of an active set with contacts, which has a fall-back of its own.
constexpr int kContactRounds = 30;
/// Bounded rows from which on an active set that stalls is not descended from: the bodies are faster.
constexpr int kManyRows = 60;
/// Solves more where contacts met their laws within a tolerance of rates only.
constexpr int kExactSolves = 2;

}  // namespace

/// Zero in rows that hold nothing by themselves: of axes, soft joints, contacts, and joints that broke.
void Rattle::clear_loose_rows(std::span<double> rows) const {
  clear_broken_rows(rows);
  system_.clear_bounded_rows(rows);
}

/// θ₀, θ̇₀ and the springs' and dampers' scale for the step.
void Rattle::begin_bounds(double h) {
  stage_h_ = std::abs(h);
  size_ = system_size();
  contact_noise_ = rate_noise();
  system_.rows().residual(state_, phi_);
  if (rubs())
    for (int r = 0; r < system_.row_count(); ++r) start_theta_[r] = std::clamp(phi_[r], -slack_, slack_);
  for (const Rows::AxisRow& axis : system_.rows().axis_rows()) start_theta_[axis.row] = phi_[axis.row];
  system_.rows().apply(system_.jacobian(), state_.twists, rates_);
  system_.rows().add_rate(state_, rates_);
  system_.row_inertias(inertia_);
  axes_.begin(state_.time, h, start_theta_, rates_, inertia_);
  axes_.find_unresolved(system_);
  contacts_.begin(h, rates_, inertia_);
  for (int r = 0; r < system_.rows().first_contact_row(); ++r)
    if (system_.rows().is_equality(r)) laws_[r] = RowLaw::equality();
}

bool Rattle::seek_impacts() {
  const bool axis = axes_.seek_impacts(rates_), contact = contacts_.seek_impacts(rates_);
  return axis || contact;
}

void Rattle::forget_impacts(bool for_good) {
  axes_.forget_impacts(for_good);
  contacts_.forget_impacts(for_good);
}

/// Where the present λ leads to: q₁, φ(q₁), the mean rates and their laws.
void Rattle::try_positions(double h) {
  kick_and_drift(h, end_of_step(h));
  for (int r = 0; r < system_.row_count(); ++r) rates_[r] = (phi_[r] - start_theta_[r]) / h;
  if (!contacts_.empty()) contact_rates();
  clear_loose_rows(phi_);
  renew_position_laws();
}

/// delta_ = b of w = S λ + b, such that `lambda` gives the present rates.
void Rattle::rates_without(std::span<const double> lambda) {
  system_.multiply(lambda, delta_);
  for (int r = 0; r < system_.row_count(); ++r) delta_[r] = rates_[r] - delta_[r];
}

/// φ(q₁) = 0 and λ ∈ law of (θ(q₁) − θ₀)/h: Newton, whose linear problem w = S (λ − λᵏ) + wᵏ is an active
/// set.
bool Rattle::close_bounded_positions(double h, StepReport& report) {
  double last = std::numeric_limits<double>::infinity();
  const double patience = settings_.max_newton_iterations + 4;
  int exact = 0;  // solves for the laws alone
  for (int iteration = 0;; ++iteration) {
    {
      const Stopwatch watch(report.times.positions);
      if (iteration == 0 || !rubs() || !rested_) try_positions(h);  // else λ is the same
    }
    if (!axes_.finite()) return false;
    double error = std::numeric_limits<double>::infinity();
    bool closed = false;
    if (iteration > 0) {
      const double open = law_error(h) / (settings_.position_tolerance - slack_);
      const double laws = laws_off(lambda_, rates_);
      error = laws <= open ? open : laws;
      closed = open <= 1 && !contacts_.empty();
    }
    if (error <= 1) break;
    if (std::isnan(error) || (iteration > 0 && !std::isfinite(error)) || iteration >= patience) {
      note_culprits(lambda_, rates_);
      return false;
    }
    if (closed && exact++ == kExactSolves) {
      if (!take_loosely(error)) {
        note_culprits(lambda_, rates_);
        return false;
      }
      break;
    }
    if (iteration > 1 && !closed && error > kSlow * last) {
      if (refactored_ || error > 10 * last) {
        note_culprits(lambda_, rates_);
        return false;
      }
      refactor_at_iterate(h, report);
    }
    last = error;
    const Stopwatch watch(report.times.positions);
    near_ = iteration > 0;
    const double tolerance = closed ? exact_tolerance() : 0.1 * settings_.position_tolerance / h;
    if (!solve_laws(lambda_, tolerance, &Rattle::renew_position_laws, report)) {
      note_culprits(lambda_, w_);
      return false;
    }
    ++report.newton_iterations;
  }
  note_residual(lambda_);
  axes_.finish_positions(rates_);
  note_loose(lambda_);
  surprised_ = holds_bodies_ && axes_.any_broken();  // who was left out of the step limit may move
  return true;
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

/// What laws depend on beside the rates has changed with this solution: friction lets go, its load or the
/// tangents of tables are others.
bool Rattle::laws_move(std::span<const double> lambda, double rate_tolerance) {
  const bool broke = axes_.break_away(w_, rate_tolerance), bent = axes_.bend(w_, rate_tolerance);
  const bool turned = axes_.turn_swings(lambda, w_);
  return axes_.update_loads(system_.rows(), system_.jacobian(), lambda) || broke || bent || turned;
}

/// Solves w = S λ + b for the laws, with b such that the present λ gives the present rates; again where
/// static friction lets go, and until the friction of contacts agrees with their slip and normal impulse.
bool Rattle::solve_laws(std::span<double> lambda, double rate_tolerance, Renew renew, StepReport& report) {
  loose_ = 0;
  rates_without(lambda);
  ActiveSetSettings settings{.rate_tolerance = rate_tolerance};
  const bool many = std::ssize(system_.rows().axis_rows()) >= kManyRows;
  if (!contacts_.empty()) settings.max_rounds = kContactRounds;
  if (!contacts_.empty() || many) settings.max_descent_rounds = 0;  // the bodies are the fall-back
  const double resting = resting_tolerance(rate_tolerance, std::exchange(rested_, false) || !rubs());
  laws_moved_ = false;
  if (may_rest() &&
      (holds(lambda, resting, report) || (!laws_moved_ && holds_by_factor(lambda, resting, report))))
    return true;
  if (laws_moved_) (this->*renew)();
  if (system_.through_bodies() || contacts_.soft() || (newtons_left_ > 0 && newtons_left_-- > 0))
    return solve_through_bodies(lambda, rate_tolerance, resting, renew, report);
  guess_.assign(lambda.begin(), lambda.end());
  double earlier = std::numeric_limits<double>::infinity();
  for (int solve = 0;; ++solve) {
    settings.keep_null_space = solve > 0;
    outcome_ = active_->solve(laws_, delta_, lambda, w_, report.times, settings);
    report.pivots += outcome_.pivots;
    if (!outcome_.ok() && contacts_.empty()) {
      const bool polishes = settings.rate_tolerance == 0;
      if (!polishes && (!many || outcome_.status != ActiveSetStatus::kNotConverged)) return false;
      if (many) newtons_left_ = kNewtonsInARow;
      std::copy(guess_.begin(), guess_.end(), lambda.begin());
      return solve_through_bodies(lambda, rate_tolerance, resting, renew, report);
    }
    const bool moved = laws_move(lambda, rate_tolerance);
    const bool slid = contacts_.adapt(lambda, w_, rate_tolerance);
    const bool met = outcome_.ok() && !moved && !slid;
    if (met && !exact(lambda)) {  // the tolerance of rates has let it pass
      if (settings.rate_tolerance == 0)
        return solve_through_bodies(lambda, rate_tolerance, resting, renew, report);
      settings.rate_tolerance = 0;
      continue;
    }
    if (met && !contacts_.slips_where_it_held()) break;
    if (met && hold_on(lambda, rate_tolerance, report)) {
      take_pieces(lambda);
      if (!laws_move(lambda, rate_tolerance)) return true;
    } else if (met && !contacts_.weakened()) {
      break;
    }
    if (contacts_.empty()) {
      if (solve == kMaxAxisSolves) {
        note_jam(lambda);
        return false;
      }
    } else {
      const bool check = solve % kFrictionPatience == kFrictionPatience - 1;
      if (!outcome_.ok() || solve >= kMaxAxisSolves ||
          (check && !met && contacts_.residual() > kFrictionProgress * earlier)) {
        newtons_left_ = kNewtonsInARow;
        std::copy(guess_.begin(), guess_.end(), lambda.begin());
        return solve_through_bodies(lambda, rate_tolerance, resting, renew, report);
      }
      if (check) earlier = contacts_.residual();
      if (!contacts_.turns().empty()) turn_contacts(lambda, report);
    }
    (this->*renew)();
  }
  report.complementarity_residual =
      std::max({report.complementarity_residual, outcome_.residual, contacts_.residual()});
  return true;
}

void Rattle::renew_position_laws() {
  axes_.position_laws(rates_, laws_);
  contacts_.position_laws(laws_);
  for (int r : breaking_.rows()) laws_[r] = RowLaw::none();
}

void Rattle::renew_velocity_laws() {
  axes_.velocity_laws(phi_, laws_);
  contacts_.velocity_laws(laws_);
  for (int r = 0; r < system_.rows().first_contact_row(); ++r)
    if (system_.rows().is_equality(r)) laws_[r] = RowLaw::equality();
  for (int r : breaking_.rows()) laws_[r] = RowLaw::none();
}

/// Rates and laws of the second kick.
void Rattle::begin_velocities() {
  stage_h_ = std::numeric_limits<double>::infinity();
  // A first guess for its pieces: the impulses of the first kick.
  std::copy(lambda_.begin(), lambda_.end(), mu_.begin());
  system_.rows().residual(end_of_step(0), phi_);
  twists_from_momenta();
  system_.rows().apply(system_.jacobian(), state_.twists, rates_);
  system_.rows().add_rate(state_, rates_);
  system_.row_inertias(inertia_);
  contacts_.begin_velocities(rates_, inertia_);
  renew_velocity_laws();
  system_.multiply(mu_, delta_);
  for (int r = 0; r < system_.row_count(); ++r) rates_[r] += delta_[r];
}

/// μ of the laws of a velocity stage from the present one, to what round-off allows where the tolerance of
/// rates lets too much pass; inexactly where that may be.
bool Rattle::solve_velocity_laws(Renew renew, StepReport& report) {
  near_ = false;
  double tolerance = 0.1 * settings_.velocity_tolerance;
  for (int exact = 0;; ++exact) {
    if (!solve_laws(mu_, tolerance, renew, report)) break;
    const double off = contacts_.empty() ? 0 : laws_off(mu_, w_);
    if (off <= 1 || (exact == kExactSolves && take_loosely(off))) return true;
    if (exact == kExactSolves) break;
    tolerance = exact_tolerance();
    std::copy(w_.begin(), w_.end(), rates_.begin());
  }
  note_culprits(mu_, w_);
  return false;
}

/// μ with J V + φ_t = 0 for the joints and the laws of the second kick for the axes.
bool Rattle::project_bounded_momenta(StepReport& report) {
  begin_velocities();
  if (!axes_.finite() || !solve_velocity_laws(&Rattle::renew_velocity_laws, report)) return false;
  end_velocities(report);
  note_residual(mu_);
  if (report.velocity_residual <= settings_.velocity_tolerance) return true;
  note_culprits(mu_, rates_);
  return false;
}

/// The momenta that μ leads to, and what is left of their rates.
void Rattle::end_velocities(StepReport& report) {
  for (int b = 0; b < world_.body_count(); ++b) {
    if (!system_.inverse_mass(b).moves()) continue;
    momenta_[b] = momenta_[b] + system_.rows().wrench_on(b, system_.jacobian(), mu_);
    if (iterative()) momenta_[b] = momenta_[b] - absorbed_[b];
  }
  twists_from_momenta();
  system_.rows().apply(system_.jacobian(), state_.twists, velocity_rows_);
  system_.rows().add_rate(state_, velocity_rows_);
  std::copy(velocity_rows_.begin(), velocity_rows_.end(), rates_.begin());
  note_loose(mu_);
  clear_loose_rows(velocity_rows_);
  report.velocity_residual = max_abs(velocity_rows_);
}

/// The first kick for the books, at the pose where it acted.
void Rattle::keep_first_kick() {
  mean_rates(momenta_, kicked_, kick_jacobian(), kick_rates_);
  axes_.keep(lambda_, rates_, kick_rates_);
  contacts_.keep(lambda_, rates_, kick_rates_);
}

/// Mean rates of the rows in a kick from momenta p₀ to p₁ at the poses of state_.
void Rattle::mean_rates(std::span<const Wrench> from, std::span<const Wrench> to,
                        std::span<const double> jacobian, std::span<double> out) {
  for (int b = 0; b < world_.body_count(); ++b) mean_twists_[b] = mean_twist(b, from[b], to[b]);
  system_.rows().apply(jacobian, mean_twists_, out);
}

/// After a step: who is held now, and the books of both kicks.
void Rattle::finish_bounds(StepReport& report) {
  system_.rows().residual(state_, phi_);  // axes are up to date here
  mean_rates(kicked_, momenta_, system_.jacobian(), kick_rates_);
  axes_.book(mu_, rates_, kick_rates_);
  axes_.finish_velocities(phi_, rates_, state_.time);
  contacts_.finish(mu_, kick_rates_, state_.time);
  report.axis_work = {};
  for (const AxisReport& axis : axes_.reports()) report.axis_work += axis.work;
  report.contact_work = contacts_.work();
}

}  // namespace taut
