#include "solvers/integrators/impulse_scheme.h"

#include <cmath>

#include "core/state/reach.h"
#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/force_level.h"

namespace taut {
namespace {

constexpr int kMaxVelocityPasses = 6;
/// A part of the rates that each pass leaves is summed up if it is no more than this, and has been the same
/// to that part of itself in so many sub-steps in a row.
constexpr double kMostLeftOver = 0.2, kAlike = 0.05;
constexpr int kSteady = 20;
/// Passes of the fixed point for velocity-dependent forces; a pass that takes away less than half of the
/// change stalls it.
constexpr int kMaxForcePasses = 60;
constexpr double kForceTolerance = 1e-12;

}  // namespace

ImpulseScheme::ImpulseScheme(const World& world, ConstraintSystem& system, const Settings& settings)
    : world_(world),
      system_(system),
      settings_(settings),
      springs_(system.rows().spring_count() > 0 ? Springs::kLeftOut : Springs::kIncluded),
      axes_(world, system.rows()),
      contacts_(world, settings),
      breaking_(world, system.rows()),
      stages_(world, system, axes_, contacts_, settings),
      limit_(world, system, settings, axes_, breaking_, stages_),
      works_(world, system, springs_),
      prediction_(system.row_count()) {
  const int bodies = world.body_count(), rows = system.row_count();
  for (auto* wrenches : {&momenta_, &start_momenta_, &forces_, &last_forces_, &kicked_})
    wrenches->resize(bodies);
  for (auto* values :
       {&lambda_, &mu_, &delta_, &phi_, &velocity_rows_, &last_rates_, &impulses_, &force_multipliers_})
    values->assign(rows, 0.0);
  for (auto* values : {&start_theta_, &rates_, &kick_rates_}) values->assign(bounded() ? rows : 0, 0.0);
}

void ImpulseScheme::clear_impulses() {
  std::fill(impulses_.begin(), impulses_.end(), 0.0);
  axes_.clear_reports();
  contacts_.clear_reports();
}

void ImpulseScheme::start(const State& state, StepReport& report) {
  state_ = state;
  residual_current_ = false;
  poses_ = state.poses;
  if (!contacts_.empty()) start_contacts();
  system_.release_bounded_rows();
  std::fill(lambda_.begin(), lambda_.end(), 0.0);
  prediction_.start();
  for (int b = 0; b < world_.body_count(); ++b)
    momenta_[b] = system_.mass().momentum(b, state_.poses[b], state_.twists[b]);
  linearize_and_factorize(report);
  if (iterative()) return start_iterative();
  const Stopwatch watch(report.times.velocities);
  project_momenta(report, mu_);
  find_forces();

  // Multipliers of the acceleration equation S λ = −(γ + J M⁻¹ (f − ω × Iω)): the first prediction.
  system_.rows().bias(state_, state_.twists, force_multipliers_);
  std::vector<Twist> accelerations(world_.body_count());
  world_.forces(state_, last_forces_);
  free_accelerations(system_.mass(), state_, last_forces_, accelerations);
  system_.rows().apply(system_.jacobian(), accelerations, delta_);
  for (int r = 0; r < system_.row_count(); ++r) force_multipliers_[r] = -(force_multipliers_[r] + delta_[r]);
  clear_loose_rows(force_multipliers_);
  system_.solve(force_multipliers_);
  update_step_limit();
  if (!bounded()) return;
  system_.rows().residual(state_, phi_);
  system_.rows().apply(system_.jacobian(), state_.twists, rates_);
  axes_.start(phi_, rates_);
  stages_.forget_segments();
}

void ImpulseScheme::start_iterative() {
  find_forces();
  twists_from_momenta();
  std::fill(mu_.begin(), mu_.end(), 0.0);
  std::fill(force_multipliers_.begin(), force_multipliers_.end(), 0.0);
  update_step_limit();
  system_.rows().residual(state_, phi_);
  system_.rows().apply(system_.jacobian(), state_.twists, rates_);
  axes_.start(phi_, rates_);
}

void ImpulseScheme::linearize(StepReport& report) {
  const Stopwatch watch(report.times.assembly);
  system_.linearize(state_);
  system_.set_mass(state_.poses);
}

void ImpulseScheme::linearize_and_factorize(StepReport& report) {
  if (iterative()) return linearize(report);
  {
    const Stopwatch watch(report.times.assembly);
    system_.linearize_and_assemble(state_);
  }
  system_.factorize(report.times);
}

/// What a step of h from the present state leads to: `poses_` at its end while it is tried (h ≠ 0); or, once
/// it is accepted (h = 0), the new state, while `poses_` are still the old ones at which the axes hold.
Configuration ImpulseScheme::end_of_step(double h) const {
  if (h == 0) return {state_.poses, state_.time, state_.axes, poses_};
  return {poses_, state_.time + h, state_.axes, state_.poses};
}

/// Zero in rows that hold nothing by themselves: of axes, soft joints, contacts, and joints that broke.
void ImpulseScheme::clear_loose_rows(std::span<double> rows) const {
  clear_broken_rows(rows);
  system_.clear_bounded_rows(rows);
}

ImpulseScheme::Fixed ImpulseScheme::fixed_point(int pass, double& last_change) {
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
void ImpulseScheme::twists_and_rates(Change change) {
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
void ImpulseScheme::project_momenta(StepReport& report, std::span<double> mu, double h) {
  std::fill(mu.begin(), mu.end(), 0.0);
  twists_and_rates([this, h](int b) {
    if (h != 0) second_kick(b, h);
  });
  for (int pass = 0; pass < kMaxVelocityPasses; ++pass) {
    const double sum = pass > 0 && steady_count_ >= kSteady ? 1 / (1 - contraction_) : 1;
    for (int r = 0; r < system_.row_count(); ++r) delta_[r] = -sum * velocity_rows_[r];
    if (pass == 1) last_rates_ = velocity_rows_;
    system_.solve_shifted(delta_);
    twists_and_rates([this](int b) {
      momenta_[b] = momenta_[b] + system_.rows().wrench_on(b, system_.jacobian(), delta_);
    });
    for (int r = 0; r < system_.row_count(); ++r) mu[r] += delta_[r];
    if (pass == 1) watch_contraction(sum);
    report.velocity_residual = max_abs(velocity_rows_);
    if (report.velocity_residual <= settings_.velocity_tolerance) return;
  }
  prediction_.start_from_zero();
}

/// What the second pass leaves of its rates, or would have left without `sum`, as a part of them.
void ImpulseScheme::watch_contraction(double sum) {
  double before = 0, after = 0;
  for (int r = 0; r < system_.row_count(); ++r) {
    before += last_rates_[r] * last_rates_[r];
    after += last_rates_[r] * velocity_rows_[r];
  }
  const double left = before > 0 ? 1 - (1 - after / before) / sum : 0;
  const bool alike = left > 0 && left <= kMostLeftOver && std::abs(left - contraction_) <= kAlike * left;
  steady_count_ = alike ? steady_count_ + 1 : 0;
  contraction_ = left;
}

void ImpulseScheme::twists_from_momenta() {
  for (int b = 0; b < world_.body_count(); ++b)
    if (system_.inverse_mass(b).moves()) state_.twists[b] = system_.inverse_mass(b).twist(momenta_[b]);
}

/// The momenta that μ leads to.
void ImpulseScheme::take_impulses() {
  for (int b = 0; b < world_.body_count(); ++b)
    if (system_.inverse_mass(b).moves())
      momenta_[b] = momenta_[b] + system_.rows().wrench_on(b, system_.jacobian(), mu_);
}

/// What is left of the rates that they had to have.
void ImpulseScheme::note_velocities(StepReport& report) {
  twists_from_momenta();
  system_.rows().apply(system_.jacobian(), state_.twists, velocity_rows_);
  system_.rows().add_rate(state_, velocity_rows_);
  std::copy(velocity_rows_.begin(), velocity_rows_.end(), rates_.begin());
  stages_.note_inexact(mu_, rates_);
  clear_loose_rows(velocity_rows_);
  report.velocity_residual = max_abs(velocity_rows_);
}

/// After a step: who is held now, and the books of both kicks.
void ImpulseScheme::finish_laws(StepReport& report) {
  system_.rows().residual(state_, phi_);  // axes are up to date here
  works_.mean_rates(kicked_, momenta_, system_.jacobian(), kick_rates_);
  axes_.accumulate_work(mu_, rates_, kick_rates_);
  axes_.finish_velocities(phi_, rates_, state_.time);
  contacts_.finish(mu_, kick_rates_, state_.time);
  report.works.axes = {};
  for (const AxisReport& axis : axes_.reports()) report.works.axes += axis.work;
  report.works.contacts = contacts_.work();
}

/// Momenta, and a state that a World takes.  A sum is finite if and, short of overflow, only if all its terms
/// are.
bool ImpulseScheme::finite() const {
  double sum = 0;
  bool near = true;
  for (int b = 0; b < world_.body_count(); ++b) {
    sum += std::abs(momenta_[b].torque.sum()) + std::abs(momenta_[b].force.sum()) +
           std::abs(state_.poses[b].q.coeffs().sum());
    near = near && within_reach(state_.poses[b], state_.twists[b]);
  }
  return near && std::isfinite(sum);
}

/// Back to the start of a step whose positions were already accepted.
void ImpulseScheme::roll_back(StepReport& report) {
  set_works(report, works_before_);
  residual_current_ = false;
  std::swap(state_.poses, poses_);
  std::swap(momenta_, start_momenta_);
  state_.time = start_time_;
  axes_.roll_back();
  contacts_.roll_back(true);
  contacts_.give_points(system_);
  linearize_and_factorize(report);
  twists_from_momenta();
  find_forces();
}

}  // namespace taut
