#include "solvers/integrators/rattle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/state/reach.h"
#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/force_level.h"
#include "solvers/integrators/free_flow.h"

namespace taut {
namespace {

/// Multipliers off their prediction by more than this part are checked against the tension limit before they
/// are accepted.
constexpr double kSurprise = 0.25;
/// Leeway on the limit for such a check: the limit itself has a safety factor of about 3 against instability
/// at ω h = 2.
constexpr double kLeeway = 1.5;
constexpr int kMaxVelocityPasses = 6;
/// A part of the rates that each pass leaves is summed up if it is no more than this, and has been the same
/// to that part of itself in so many sub-steps in a row.
constexpr double kMostLeftOver = 0.2, kAlike = 0.05;
constexpr int kSteady = 20;
/// With dependent rows positions count as closed only if no body is further than this part of the size of the
/// whole system from where its joints want it: a weakly held direction hides a long way behind a small gap.
constexpr double kFarOpen = 1e-9;
/// Gaps below this may be mended by moving the bodies, without an impulse.
constexpr double kMendable = 1e-6;
/// Passes of the fixed point for velocity-dependent forces; a pass that takes away less than half of the
/// change stalls it.
constexpr int kMaxForcePasses = 60;
constexpr double kForceTolerance = 1e-12;

/// Part of the position tolerance that many rubbing axes leave alone.
constexpr double kSlack = 0.25;

}  // namespace

Rattle::Rattle(const World& world, ConstraintSystem& system, const Settings& settings)
    : world_(world),
      system_(system),
      settings_(settings),
      springs_(system.rows().spring_count() > 0 ? Springs::kLeftOut : Springs::kIncluded),
      breaking_(world, system.rows()),
      axes_(world, system.rows()),
      contacts_(world, settings),
      stages_(world, system, axes_, contacts_, settings),
      limit_(world, system, settings, axes_, breaking_, stages_),
      tension_(system),
      works_(world, system, springs_),
      prediction_(system.row_count()) {
  const int bodies = world.body_count(), rows = system.row_count();
  for (auto* wrenches : {&momenta_, &start_momenta_, &forces_, &last_forces_, &kicked_, &move_})
    wrenches->resize(bodies);
  for (auto* values :
       {&lambda_, &mu_, &delta_, &phi_, &velocity_rows_, &last_rates_, &impulses_, &force_multipliers_})
    values->assign(rows, 0.0);
  for (auto* values : {&start_theta_, &rates_, &kick_rates_}) values->assign(bounded() ? rows : 0, 0.0);
  start_jacobian_.resize(system.jacobian().size());
  unmended_.resize(bodies);
  // Loops that stick cannot be closed, nor axes be moved back, by a little here and there.
  if (stages_.friction_dominated()) slack_ = kSlack * settings.position_tolerance;
  axes_.set_slack(slack_);
  if (iterative()) absorbed_.resize(bodies);
}

void Rattle::start(const State& state, StepReport& report) {
  state_ = state;
  knows_residual_ = false;
  poses_ = state.poses;
  if (!contacts_.empty()) start_contacts();
  system_.release_bounded_rows();
  std::fill(lambda_.begin(), lambda_.end(), 0.0);
  prediction_.start();
  size_ = system_size();
  for (int b = 0; b < world_.body_count(); ++b)
    momenta_[b] = system_.mass().momentum(b, state_.poses[b], state_.twists[b]);
  linearize_and_factorize(report);
  if (iterative()) return start_iterative();
  const Stopwatch watch(report.times.velocities);
  project_momenta(report, mu_);
  find_forces();

  // Multipliers of the acceleration equation S λ = −(γ + J M⁻¹ (f − ω × Iω)): the first prediction.
  system_.rows().bias(state_, state_.twists, force_multipliers_);
  accelerations_.resize(world_.body_count());
  world_.forces(state_, last_forces_);
  free_accelerations(system_.mass(), state_, last_forces_, accelerations_);
  system_.rows().apply(system_.jacobian(), accelerations_, delta_);
  for (int r = 0; r < system_.row_count(); ++r) force_multipliers_[r] = -(force_multipliers_[r] + delta_[r]);
  clear_loose_rows(force_multipliers_);
  system_.solve(force_multipliers_);
  update_step_limit();
  if (!bounded()) return;
  system_.rows().residual(state_, phi_);
  system_.rows().apply(system_.jacobian(), state_.twists, rates_);
  axes_.start(phi_, rates_);
  stages_.forget_pieces();
}

void Rattle::linearize(StepReport& report) {
  const Stopwatch watch(report.times.assembly);
  system_.linearize(state_);
  system_.set_mass(state_.poses);
}

void Rattle::linearize_and_factorize(StepReport& report) {
  if (iterative()) return linearize(report);
  {
    const Stopwatch watch(report.times.assembly);
    system_.linearize_and_assemble(state_);
  }
  system_.factorize(report.times);
}

Rattle::Outcome Rattle::advance(double h, StepReport& report) {
  stages_.begin_advance();
  unsettled_ = 0;
  tension_.end();
  if (settings_.tension == TensionPolicy::kImplicit &&
      limit_.omega() * std::abs(h) > settings_.max_tension_number) {
    tension_.begin(h, state_.poses, limit_.stiffness(), breaking_, contacts_);
    system_.factorize(report.times);
  }
  {
    const Stopwatch watch(report.times.positions);
    predict_multipliers(h);
  }
  if (bounded()) begin_bounds(h);
  if (!(iterative() ? stabilize_positions(h, report)
        : bounded() ? close_bounded_positions(h, report)
                    : close_positions(h, report))) {
    forget_impacts(false);
    restore(report);
    return Outcome::kStalled;
  }
  if (bounded() && seek_impacts()) {
    time_to_impact_ = time_of_impact(h, report);
    return Outcome::kImpact;
  }
  if (settings_.tension == TensionPolicy::kSubstep && surprised_) {
    for (int r = 0; r < system_.row_count(); ++r) force_multipliers_[r] = 2 / h * lambda_[r];
    update_step_limit();
    if (std::abs(h) > kLeeway * limit_.step()) {
      forget_impacts(false);
      restore(report);
      return Outcome::kUnstable;
    }
  }
  report.tension_number = std::max(report.tension_number, limit_.omega() * std::abs(h));
  works_before_ = works_of(report);
  if (settings_.report_energy) {
    account_for_kick(h, report);
    constexpr auto kSplit = KickWorks::Bodies::kSplit;
    if (works_.has_split_flow())
      report.ledger.integration +=
          works_.spin_energy(kicked_, poses_, kSplit) - works_.spin_energy(kicked_, state_.poses, kSplit);
  }
  if (bounded()) keep_first_kick();

  std::swap(state_.poses, poses_);  // these now hold the old ones
  std::swap(momenta_, start_momenta_);
  start_time_ = state_.time;
  state_.time += h;
  if (!contacts_.empty()) find_contacts();
  if (blind()) {
    roll_back(report);
    forget_impacts(false);
    return Outcome::kBlind;
  }
  if (bounded() && !iterative()) stages_.prepare(lambda_);
  if (stages_.factors_on_demand())
    linearize(report);
  else
    linearize_and_factorize(report);
  refactored_ = false;
  if (!close_velocities(h, report)) {
    roll_back(report);
    forget_impacts(false);
    return Outcome::kStalled;
  }
  if (!finite()) return Outcome::kNotFinite;
  if (breaking_.possible() && break_joints(h, report)) return Outcome::kOverload;
  system_.rows().update_axes(end_of_step(0), state_.axes);
  if (bounded()) finish_bounds(report);
  if (settings_.report_energy)
    works_.add({state_, kicked_, momenta_, system_.jacobian(), mu_}, forces_, h, report);

  keep_multipliers(h);
  if (breaking_.any_due() && breaking_.due(state_.time)) {
    release_overloaded();
    if (!iterative()) system_.factorize(report.times);
  }
  ++report.substeps;
  stages_.report_residuals(report);
  const Stopwatch watch(report.times.velocities);
  update_step_limit();
  return Outcome::kDone;
}

/// Impulses for reactions, forces at the end of the step, and what the next prediction starts from.
void Rattle::keep_multipliers(double h) {
  const double per_h = 1 / h;
  for (int r = 0; r < system_.row_count(); ++r) {
    impulses_[r] += lambda_[r] + mu_[r];
    if (!struck()) force_multipliers_[r] = 2 * per_h * mu_[r];  // the impulse of an impact is no force
  }
  prediction_.keep(h, lambda_, mu_, struck());
}

/// Momenta, and a state that a World takes.  A sum is finite if and, short of overflow, only if all its terms
/// are.
bool Rattle::finite() const {
  double sum = 0;
  bool near = true;
  for (int b = 0; b < world_.body_count(); ++b) {
    sum += std::abs(momenta_[b].torque.sum()) + std::abs(momenta_[b].force.sum()) +
           std::abs(state_.poses[b].q.coeffs().sum());
    near = near && within_reach(state_.poses[b], state_.twists[b]);
  }
  return near && std::isfinite(sum);
}

void Rattle::restore(StepReport& report) {
  axes_.roll_back();
  contacts_.roll_back(false);
  if (!refactored_ && !tension_.active()) return;
  if (refactored_)
    std::copy(start_jacobian_.begin(), start_jacobian_.end(), system_.change_jacobian().begin());
  system_.set_mass(state_.poses);
  system_.factorize(report.times);
  refactored_ = false;
  tension_.end();
}

/// Back to the start of a step whose positions were already accepted.
void Rattle::roll_back(StepReport& report) {
  set_works(report, works_before_);
  knows_residual_ = false;
  std::swap(state_.poses, poses_);
  std::swap(momenta_, start_momenta_);
  state_.time = start_time_;
  axes_.roll_back();
  contacts_.roll_back(true);
  contacts_.give_points(system_);
  linearize_and_factorize(report);
  twists_from_momenta();
  find_forces();
  tension_.end();
}

/// With dependent rows it is the μ of before alone.  Contacts that press and the joints between them go on
/// with the division of the load that they have: of many that their laws allow, another one each step would
/// let some contact slip each time.  Those of contacts are held within their cones.
void Rattle::predict_multipliers(double h) {
  const int rows = system_.row_count();
  if (iterative()) {
    prediction_.repeat(h, rows, lambda_);
  } else if (system_.singular() && (contacts_.empty() || struck())) {
    // Newton's method and interior points through the bodies leave a null space as they find it.
    const bool good_guess = !bounded() || (contacts_.empty() && stages_.factors_on_demand());
    const int joint_rows = system_.rows().first_contact_row();
    if (prediction_.takes_from_dependent_rows() && good_guess)
      prediction_.repeat(h, joint_rows, lambda_);
    else
      std::fill_n(lambda_.begin(), joint_rows, 0.0);
  } else if (system_.singular() || !prediction_.has_history()) {
    for (int r = 0; r < rows; ++r) lambda_[r] = 0.5 * h * force_multipliers_[r];
  } else {
    prediction_.extrapolate(h, lambda_);
  }
}

/// J(q₀), along which λ acts.
std::span<const double> Rattle::kick_jacobian() const {
  return refactored_ ? std::span<const double>(start_jacobian_) : system_.jacobian();
}

/// Poses after h with the impulses λ, and φ there.
void Rattle::kick_and_drift(double h, const Configuration& end) {
  const Rows& rows = system_.rows();
  const std::span<const double> J = kick_jacobian();
  const auto kick = [&](int b) {
    kicked_[b] = momenta_[b] + 0.5 * h * forces_[b] + rows.wrench_on(b, J, lambda_);
  };
  if (tension_.active()) {
    for (int b = 0; b < world_.body_count(); ++b)
      if (!system_.mass()[b].fixed) kick(b);
    tension_.filter(state_.poses, kicked_);
  }
  for (const Rows::Piece& piece : rows.pieces()) {
    for (int b = piece.begin; b < piece.end; ++b) {
      if (system_.mass()[b].fixed) continue;
      if (!tension_.active()) kick(b);
      if (iterative()) kicked_[b] = kicked_[b] - absorbed_[b];
      poses_[b] = free_flow(system_.mass(), b, state_.poses[b], kicked_[b].torque, kicked_[b].force, h);
    }
    rows.residual(end, phi_, piece);
  }
}

bool Rattle::close_positions(double h, StepReport& report) {
  double last = std::numeric_limits<double>::infinity(), correction = 0;
  bool polished = false;
  knows_residual_ = false;
  for (int iteration = 0;; ++iteration) {
    {
      const Stopwatch watch(report.times.positions);
      kick_and_drift(h, {poses_, state_.time + h, state_.axes});
    }
    clear_broken_rows(phi_);
    const double gap = max_abs(phi_);
    bool half_solved = false;  // by the distance to closure
    if (!std::isfinite(gap)) return false;
    if (gap <= settings_.position_tolerance) {
      if (!system_.singular() || distance_to_closure(report) <= kFarOpen * size_) break;
      if (polished) return mend_positions(h, report);
      polished = half_solved = true;
    } else {
      const bool slow = iteration > 0 && gap > kSlow * last;
      const bool spent = iteration >= settings_.max_newton_iterations;
      if ((slow || spent) && system_.singular() && gap < kMendable) return mend_positions(h, report);
      if (spent) return false;
      if (slow) {
        if (refactored_ || gap > 10 * last) return false;
        refactor_at_iterate(h, report);
      }
    }
    last = gap;
    const Stopwatch watch(report.times.positions);
    if (half_solved) {
      for (double& d : delta_) d *= -1 / h;
      system_.project(delta_);
    } else {
      for (int r = 0; r < system_.row_count(); ++r) delta_[r] = -1 / h * phi_[r];
      system_.solve(delta_);
    }
    for (int r = 0; r < system_.row_count(); ++r) lambda_[r] += delta_[r];
    correction += max_abs(delta_);
    ++report.newton_iterations;
  }
  surprised_ = correction > kSurprise * max_abs(lambda_);
  knows_residual_ = true;
  return true;
}

/// The true derivative of φ(q₁) is h J(q₁) M⁻¹ J(q₀)ᵀ; S of the mean Jacobian is its symmetric neighbour of
/// least error.
void Rattle::refactor_at_iterate(double h, StepReport& report) {
  std::copy(system_.jacobian().begin(), system_.jacobian().end(), start_jacobian_.begin());
  system_.linearize({poses_, state_.time + h, state_.axes});
  std::span<double> J = system_.change_jacobian();
  for (std::size_t i = 0; i < J.size(); ++i) J[i] = 0.5 * (J[i] + start_jacobian_[i]);
  // Contacts belong to the start.
  std::copy(start_jacobian_.begin() + contact_offset(), start_jacobian_.end(), J.begin() + contact_offset());
  system_.factorize(report.times);
  refactored_ = true;
  ++report.refactorizations;
}

bool Rattle::close_velocities(double h, StepReport& report) {
  {
    const Stopwatch watch(report.times.forces);
    // Velocity-dependent laws see the velocities at the middle of the step first.
    if (world_.forces_depend_on_velocity(springs_)) {
      std::swap(momenta_, kicked_);
      twists_from_momenta();
      std::swap(momenta_, kicked_);
    }
    find_forces();
  }
  const Stopwatch watch(report.times.velocities);
  double last_change = std::numeric_limits<double>::infinity();
  for (int pass = 0;; ++pass) {
    if (!bounded()) {
      project_momenta(report, mu_, h);
    } else {
      for (int b = 0; b < world_.body_count(); ++b)
        if (system_.inverse_mass(b).moves()) second_kick(b, h);
      if (!(iterative() ? stabilize_velocities(report) : project_bounded_momenta(report))) return false;
    }
    if (!world_.forces_depend_on_velocity(springs_)) return true;
    // f(q₁, V₁) with the V₁ that it leads to: a fixed point, which keeps the scheme symmetric.
    std::swap(forces_, last_forces_);
    find_forces();
    const Fixed fixed = fixed_point(pass, last_change);
    if (fixed != Fixed::kNotYet) return fixed == Fixed::kYes;
  }
}

Rattle::Fixed Rattle::fixed_point(int pass, double& last_change) {
  double change = 0, size = 0;
  int most = 0;
  for (int b = 0; b < world_.body_count(); ++b) {
    const double of_body = std::max((forces_[b].force - last_forces_[b].force).cwiseAbs().maxCoeff(),
                                    (forces_[b].torque - last_forces_[b].torque).cwiseAbs().maxCoeff());
    if (of_body > change) change = of_body, most = b;
    size = std::max({size, forces_[b].force.cwiseAbs().maxCoeff(), forces_[b].torque.cwiseAbs().maxCoeff()});
  }
  if (!(change > kForceTolerance * size)) return Fixed::kYes;
  if (pass >= kMaxForcePasses || (pass > 0 && change > 0.5 * last_change)) {
    unsettled_ = most;
    return Fixed::kStalled;
  }
  last_change = change;
  return Fixed::kNotYet;
}

/// Momenta as `change` makes them of each body that moves, then twists and J V + φ_t: each joint as soon as
/// the twists of its bodies are there, while its Jacobian is still near.
template <typename Change>
void Rattle::twists_and_rates(Change change) {
  const Rows& rows = system_.rows();
  for (int b = 0; b < world_.body_count(); ++b) {
    if (system_.inverse_mass(b).moves()) {
      change(b);
      state_.twists[b] = system_.inverse_mass(b).twist(momenta_[b]);
    }
    for (int j : rows.joints_due(b))
      rows.apply(rows.joints()[j], system_.jacobian(), state_.twists, velocity_rows_);
  }
  rows.add_rate(state_, velocity_rows_);
  clear_loose_rows(velocity_rows_);
}

/// μ with J M⁻¹ (p + Jᵀμ) + φ_t = 0, refined until |J V + φ_t| is within its tolerance.  It is in the range
/// of S, also with dependent rows.  With h ≠ 0 the momenta are those after the second kick of h without μ.
///
/// Each pass leaves the part ε/(σ + ε) of a rate along a direction that rows hold weakly, and next to nothing
/// of all others.  If one smooth direction is left, as that of a long bridge, that part hardly changes from
/// step to step, and the geometric series is summed up in the second pass.
void Rattle::project_momenta(StepReport& report, std::span<double> mu, double h) {
  std::fill(mu.begin(), mu.end(), 0.0);
  twists_and_rates([this, h](int b) {
    if (h != 0) second_kick(b, h);
  });
  for (int pass = 0; pass < kMaxVelocityPasses; ++pass) {
    const double sum = pass > 0 && left_alike_ >= kSteady ? 1 / (1 - left_over_) : 1;
    for (int r = 0; r < system_.row_count(); ++r) delta_[r] = -sum * velocity_rows_[r];
    if (pass == 1) last_rates_ = velocity_rows_;
    system_.solve_shifted(delta_);
    twists_and_rates([this](int b) {
      momenta_[b] = momenta_[b] + system_.rows().wrench_on(b, system_.jacobian(), delta_);
    });
    for (int r = 0; r < system_.row_count(); ++r) mu[r] += delta_[r];
    if (pass == 1) watch_left_over(sum);
    report.velocity_residual = max_abs(velocity_rows_);
    if (report.velocity_residual <= settings_.velocity_tolerance) return;
  }
  prediction_.start_from_zero();
}

/// What the second pass leaves of its rates, or would have left without `sum`, as a part of them.
void Rattle::watch_left_over(double sum) {
  double before = 0, after = 0;
  for (int r = 0; r < system_.row_count(); ++r) {
    before += last_rates_[r] * last_rates_[r];
    after += last_rates_[r] * velocity_rows_[r];
  }
  const double left = before > 0 ? 1 - (1 - after / before) / sum : 0;
  const bool alike = left > 0 && left <= kMostLeftOver && std::abs(left - left_over_) <= kAlike * left;
  left_alike_ = alike ? left_alike_ + 1 : 0;
  left_over_ = left;
}

void Rattle::twists_from_momenta() {
  for (int b = 0; b < world_.body_count(); ++b)
    if (system_.inverse_mass(b).moves()) state_.twists[b] = system_.inverse_mass(b).twist(momenta_[b]);
}

}  // namespace taut
