#include "solvers/integrators/rattle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/free_flow.h"

namespace taut {
namespace {

/// Multipliers off their prediction by more than this part are checked against the tension limit before they
/// are accepted.
constexpr double kSurprise = 0.25;
/// Leeway on the limit for such a check: the limit itself has a safety factor of about 3 against instability
/// at ω h = 2.
constexpr double kLeeway = 1.5;
/// With dependent rows positions count as closed only if no body is further than this part of the size of the
/// whole system from where its joints want it: a weakly held direction hides a long way behind a small gap.
constexpr double kFarOpen = 1e-9;
/// Gaps below this may be mended by moving the bodies, without an impulse.
constexpr double kMendable = 1e-6;

/// Part of the position tolerance that many rubbing axes leave alone.
constexpr double kSlack = 0.25;

}  // namespace

Rattle::Rattle(const World& world, ConstraintSystem& system, const Settings& settings)
    : ImpulseScheme(world, system, settings), tension_(system) {
  move_.resize(world.body_count());
  best_poses_.resize(world.body_count());
  start_jacobian_.reserve(system.jacobian().size());
  // Loops that stick cannot be closed, nor axes be moved back, by a little here and there.
  if (stages_.friction_dominated()) slack_ = kSlack * settings.position_tolerance;
  axes_.set_slack(slack_);
  if (iterative()) absorbed_.resize(world.body_count());
}

void Rattle::start(const State& state, StepReport& report) {
  ImpulseScheme::start(state, report);
  size_ = system_size();
}

Rattle::Outcome Rattle::advance(double h, StepReport& report) {
  begin_step(h, report);                                                      // laws and predicted λ
  if (!close_positions(h, report)) return reject(Outcome::kStalled, report);  // kick, drift, φ(q₁) = 0
  if (bounded() && seek_impacts()) {
    time_to_event_ = time_of_impact(h, report);
    return Outcome::kImpact;
  }
  if (exceeds_tension_limit(h)) return reject(Outcome::kUnstable, report);
  accept_positions(h, report);
  if (!contacts_.empty()) find_contacts();
  if (blind()) return take_back(Outcome::kBlind, report);
  factorize_end(report);  // S(q₁)
  if (!close_velocities(h, report))
    return take_back(Outcome::kStalled, report);  // kick, J V = 0 and the laws
  if (!finite()) return Outcome::kNotFinite;
  if (breaking_.possible() && break_joints(h, report)) return Outcome::kOverload;
  finish(h, report);
  return Outcome::kDone;
}

/// The prediction of λ and the laws of the first kick, with geometric stiffness at its end if that is wanted.
void Rattle::begin_step(double h, StepReport& report) {
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
}

/// λ with φ(q₁) = 0 and the laws of the first kick.
bool Rattle::close_positions(double h, StepReport& report) {
  return iterative() ? stabilize_positions(h, report)
         : bounded() ? close_bounded_positions(h, report)
                     : close_joint_positions(h, report);
}

/// Multipliers far from their prediction are looked at before they are accepted.
bool Rattle::exceeds_tension_limit(double h) {
  if (settings_.tension != TensionPolicy::kSubstep || !prediction_missed_) return false;
  for (int r = 0; r < system_.row_count(); ++r) force_multipliers_[r] = 2 / h * lambda_[r];
  update_step_limit();
  return std::abs(h) > kLeeway * limit_.step();
}

/// The end of the drift is the state from now on, with the start in poses_ and start_momenta_.
void Rattle::accept_positions(double h, StepReport& report) {
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
  std::swap(state_.poses, poses_);
  std::swap(momenta_, start_momenta_);
  start_time_ = state_.time;
  state_.time += h;
}

void Rattle::factorize_end(StepReport& report) {
  if (bounded() && !iterative()) stages_.prepare(lambda_);
  if (stages_.factors_on_demand())
    linearize(report);
  else
    linearize_and_factorize(report);
  refactored_ = false;
}

void Rattle::finish(double h, StepReport& report) {
  system_.rows().update_axes(end_of_step(0), state_.axes);
  if (bounded()) finish_laws(report);
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
}

/// A step whose positions were not accepted.
Rattle::Outcome Rattle::reject(Outcome outcome, StepReport& report) {
  forget_impacts(false);
  restore(report);
  return outcome;
}

/// A step whose positions were accepted.
Rattle::Outcome Rattle::take_back(Outcome outcome, StepReport& report) {
  roll_back(report);
  refactored_ = false;
  tension_.end();
  forget_impacts(false);
  return outcome;
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
  for (const Rows::BodyChunk& chunk : rows.chunks()) {
    for (int b = chunk.begin; b < chunk.end; ++b) {
      if (system_.mass()[b].fixed) continue;
      if (!tension_.active()) kick(b);
      if (iterative()) kicked_[b] = kicked_[b] - absorbed_[b];
      poses_[b] = free_flow(system_.mass(), b, state_.poses[b], kicked_[b].torque, kicked_[b].force, h);
    }
    rows.residual(end, phi_, chunk);
  }
}

bool Rattle::close_joint_positions(double h, StepReport& report) {
  double last = std::numeric_limits<double>::infinity(), correction = 0;
  bool polished = false;
  residual_current_ = false;
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
      if (polished) return project_positions(h, report);
      polished = half_solved = true;
    } else {
      const bool slow = iteration > 0 && gap > kSlow * last;
      const bool spent = iteration >= settings_.max_newton_iterations;
      if ((slow || spent) && system_.singular() && gap < kMendable) return project_positions(h, report);
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
  prediction_missed_ = correction > kSurprise * max_abs(lambda_);
  residual_current_ = true;
  return true;
}

/// The true derivative of φ(q₁) is h J(q₁) M⁻¹ J(q₀)ᵀ; S of the mean Jacobian is its symmetric neighbour of
/// least error.
void Rattle::refactor_at_iterate(double h, StepReport& report) {
  start_jacobian_.assign(system_.jacobian().begin(), system_.jacobian().end());
  system_.linearize({poses_, state_.time + h, state_.axes});
  std::span<double> J = system_.change_jacobian();
  for (std::size_t i = 0; i < J.size(); ++i) J[i] = 0.5 * (J[i] + start_jacobian_[i]);
  // Contacts belong to the start.
  std::copy(start_jacobian_.begin() + contact_offset(), start_jacobian_.end(), J.begin() + contact_offset());
  system_.factorize(report.times);
  refactored_ = true;
  ++report.counts.refactorizations;
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

}  // namespace taut
