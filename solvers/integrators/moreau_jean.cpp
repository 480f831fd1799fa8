#include "solvers/integrators/moreau_jean.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/check.h"
#include "solvers/common/setting_names.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/close_joints.h"
#include "solvers/integrators/free_flow.h"

namespace taut {

MoreauJean::MoreauJean(const World& world, ConstraintSystem& system, const Settings& settings)
    : ImpulseScheme(world, system, settings) {
  first_twists_.resize(world.body_count());
}

ImpulseScheme::Outcome MoreauJean::advance(double h, StepReport& report) {
  report.tension_number = std::max(report.tension_number, limit_.omega() * h);
  works_before_ = works_of(report);
  stages_.begin_advance();
  unsettled_ = 0;
  predict(h);
  go_to_middle(h, report);
  if (blind()) {
    roll_back(report);
    return Outcome::kBlind;
  }
  begin_laws(h, report);
  if (const Outcome outcome = find_impulses(h, report); outcome != Outcome::kDone) {
    if (outcome == Outcome::kStalled) roll_back(report);
    return outcome;
  }
  if (!finite()) return Outcome::kNotFinite;
  add_works(h, report);
  if (!go_to_end(h, report)) {
    state_.axes = first_axes_;
    roll_back(report);
    return Outcome::kStalled;
  }
  if (!finite()) return Outcome::kNotFinite;
  if (settings_.report_energy)
    report.ledger.integration += works_.spin_energy(momenta_, state_.poses, KickWorks::Bodies::kAll);
  keep_impulses(h);
  ++report.substeps;
  stages_.report_residuals(report);
  const Stopwatch watch(report.times.velocities);
  update_step_limit();
  return Outcome::kDone;
}

/// The impulses of the step before, as a guess; of dependent rows behind contacts none, since what they have
/// in the null space would be carried from step to step.
void MoreauJean::predict(double h) {
  std::fill(lambda_.begin(), lambda_.end(), 0.0);
  const bool dependent = system_.singular() && !contacts_.empty();
  const int first = dependent ? system_.rows().first_contact_row() : 0;
  std::fill_n(mu_.begin(), first, 0.0);
  for (int r = first; r < system_.row_count(); ++r)
    mu_[r] = prediction_.has_history() ? prediction_.scale(h) * mu_[r] : h * force_multipliers_[r];
}

/// q_M, its contacts, and J there.  poses_ and start_momenta_ stay those of the start.
void MoreauJean::go_to_middle(double h, StepReport& report) {
  if (bounded()) {
    stages_.residual().begin_velocities(state_.twists);
    system_.rows().residual(state_, phi_);
    for (const Rows::AxisRow& axis : system_.rows().axis_rows()) start_theta_[axis.row] = phi_[axis.row];
    contacts_.begin_single_kick(h);
  }
  start_momenta_ = kicked_ = momenta_;
  poses_ = state_.poses;
  start_time_ = state_.time;
  state_.time += 0.5 * h;
  {
    const Stopwatch watch(report.times.positions);
    for (int b = 0; b < world_.body_count(); ++b)
      if (system_.inverse_mass(b).moves()) state_.poses[b] = moved(b, 0.5 * h);
  }
  if (!contacts_.empty()) find_contacts();
  linearize(report);
}

/// A body after h with the momenta of the start.
Pose MoreauJean::moved(int b, double h) const {
  return free_flow(system_.mass(), b, poses_[b], start_momenta_[b].torque, start_momenta_[b].force, h);
}

/// V₀ and what the laws take from it, and the factor for these laws.
void MoreauJean::begin_laws(double h, StepReport& report) {
  twists_from_momenta();
  first_twists_ = state_.twists;
  weighted_ = state_;
  theta_ = settings_.theta;
  if (bounded()) {
    system_.rows().apply(system_.jacobian(), state_.twists, rates_);
    system_.rows().add_rate(state_, rates_);
    stages_.renew_effective_masses();
    axes_.begin(start_time_, h, start_theta_, rates_, stages_.effective_mass());
    theta_ = axes_.find_unresolved(system_, true) ? 1 : settings_.theta;
    contacts_.begin_impulses(rates_, stages_.effective_mass());
    if (contacts_.soft()) {
      roll_back(report);
      fail("settings integrator", R"(must be "rattle" where compliant materials touch)",
           name_of(settings_.integrator, kIntegratorNames));
    }
    contacts_.clear_idle(mu_);
    system_.rows().residual(end_of_step(0), phi_);
    renew_laws();
    stages_.prepare(rates_, mu_);
  }
  if (!stages_.factors_on_demand()) system_.factorize(report.times);
}

void MoreauJean::renew_laws() {
  std::vector<RowLaw>& laws = stages_.laws();
  axes_.impulse_laws(theta_, phi_, laws);
  contacts_.velocity_laws(laws);
  for (int r = 0; r < system_.rows().first_contact_row(); ++r)
    if (system_.rows().is_equality(r)) laws[r] = RowLaw::equality();
}

/// (q_ϑ, V_ϑ) of the momenta of now.
void MoreauJean::weigh(double h) {
  const double theta = theta_, last = theta * theta * h;
  weighted_.time = start_time_ + theta * h;
  for (int b = 0; b < world_.body_count(); ++b) {
    if (!system_.inverse_mass(b).moves()) continue;
    const Twist &V0 = first_twists_[b], &V1 = state_.twists[b];
    weighted_.twists[b] = {(1 - theta) * V0.w + theta * V1.w, (1 - theta) * V0.v + theta * V1.v};
    weighted_.poses[b] =
        free_flow(system_.mass(), b, moved(b, theta * h - last), momenta_[b].torque, momenta_[b].force, last);
  }
}

/// Λ, with the forces at the state that it leads to: a fixed point.
ImpulseScheme::Outcome MoreauJean::find_impulses(double h, StepReport& report) {
  double last_change = std::numeric_limits<double>::infinity();
  weigh(h);
  world_.forces(weighted_, forces_, springs_);
  for (int pass = 0;; ++pass) {
    for (int b = 0; b < world_.body_count(); ++b)
      if (system_.inverse_mass(b).moves()) momenta_[b] = start_momenta_[b] + h * forces_[b];
    if (!finite() || !axes_.finite()) return Outcome::kNotFinite;
    if (!solve_stage(report)) return Outcome::kStalled;
    const Stopwatch watch(report.times.forces);
    weigh(h);
    std::swap(forces_, last_forces_);
    world_.forces(weighted_, forces_, springs_);
    const Fixed fixed = fixed_point(pass, last_change);
    if (fixed == Fixed::kYes) std::swap(forces_, last_forces_);  // those that p₁ has
    if (fixed != Fixed::kNotYet) return fixed == Fixed::kYes ? Outcome::kDone : Outcome::kStalled;
  }
}

/// Joints and laws on J V₁, from the momenta without impulses.
bool MoreauJean::solve_stage(StepReport& report) {
  const Stopwatch watch(report.times.velocities);
  if (!bounded()) {
    project_momenta(report, mu_);
    return std::isfinite(report.velocity_residual);
  }
  twists_from_momenta();
  system_.rows().apply(system_.jacobian(), state_.twists, rates_);
  system_.rows().add_rate(state_, rates_);
  renew_laws();
  system_.multiply(mu_, delta_);
  for (int r = 0; r < system_.row_count(); ++r) rates_[r] += delta_[r];
  stages_.accuracy().begin_pass();  // replaces the one before
  stages_.residual().note_round_off();
  const StageSolver::Renew renew = [this] { renew_laws(); };
  if (!stages_.solve_velocities({mu_, rates_, renew}, report)) return false;
  take_impulses();
  note_velocities(report);
  stages_.note_residual(mu_, rates_);
  return report.velocity_residual <= settings_.velocity_tolerance;
}

/// The one kick of the step, at q_M where it acts.
void MoreauJean::add_works(double h, StepReport& report) {
  if (bounded()) finish_laws(report);
  if (!settings_.report_energy) return;
  // Forces that are not conservative were taken at the weighted state.
  works_.add({weighted_, start_momenta_, momenta_, system_.jacobian(), mu_}, forces_, 2 * h, report);
  // What the ways to q_M and from there to q₁ change of the kinetic energy, up to its end.
  report.ledger.integration += works_.spin_energy(start_momenta_, state_.poses, KickWorks::Bodies::kAll) -
                               works_.spin_energy(start_momenta_, poses_, KickWorks::Bodies::kAll) -
                               works_.spin_energy(momenta_, state_.poses, KickWorks::Bodies::kAll);
}

/// q₁, and joints closed there if that is wanted.
bool MoreauJean::go_to_end(double h, StepReport& report) {
  {
    const Stopwatch watch(report.times.positions);
    const double last = theta_ * h;
    for (int b = 0; b < world_.body_count(); ++b)
      if (system_.inverse_mass(b).moves())
        state_.poses[b] =
            free_flow(system_.mass(), b, moved(b, h - last), momenta_[b].torque, momenta_[b].force, last);
  }
  state_.time = start_time_ + h;
  first_axes_ = state_.axes;
  system_.rows().update_axes(end_of_step(0), state_.axes);
  if (settings_.drift_cure == DriftCure::kPositionPush && !push_positions(report)) return false;
  system_.set_mass(state_.poses);
  twists_from_momenta();
  return true;
}

/// Joints and rigid limits closed.
bool MoreauJean::push_positions(StepReport& report) {
  axes_.rigid_limits(limits_);
  if (close_joints(system_, state_, settings_.position_tolerance, report, limits_)) return true;
  system_.rows().residual(state_, phi_);  // for the diagnosis
  note_passed_limit();
  return false;
}

/// The limit that is passed furthest, for the diagnosis.
void MoreauJean::note_passed_limit() {
  std::vector<Culprit> culprits;
  double furthest = settings_.position_tolerance;
  for (const AxisForces::Bound& limit : limits_) {
    const double excess = std::abs(limit.excess(phi_[limit.row]));
    if (!(excess > furthest)) continue;
    furthest = excess;
    culprits = {{.kind = Culprit::Kind::kAxis, .axis = limit.axis, .share = excess}};
  }
  stages_.culprits().set(std::move(culprits));
}

/// For reactions and the next guess.  The impulse of an impact is no force.
void MoreauJean::keep_impulses(double h) {
  for (int r = 0; r < system_.row_count(); ++r) {
    impulses_[r] += mu_[r];
    if (!struck()) force_multipliers_[r] = mu_[r] / h;
  }
  prediction_.keep_step(h);
}

}  // namespace taut
