#include "solvers/integrators/moreau_jean.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "solvers/common/setting_names.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/close_joints.h"
#include "solvers/integrators/free_flow.h"
#include "solvers/integrators/restitution_search.h"

namespace taut {

MoreauJean::MoreauJean(const World& world, ConstraintSystem& system, const Settings& settings)
    : ImpulseScheme(world, system, settings) {
  first_twists_.resize(world.body_count());
}

Scheme::Outcome MoreauJean::advance(double h, SubstepReport& report) {
  std::vector<double>& impulses = values_.mu;  // Λ
  report.tension_number = limit_.omega() * h;
  stages_.begin_advance();
  force_iteration_.begin();
  predict(h, impulses);
  go_to_middle(h, report);
  if (blind()) {
    roll_back(report);
    return Outcome::kBlind;
  }
  begin_laws(h, impulses, report);
  if (const Outcome outcome = find_impulses(h, impulses, report); outcome != Outcome::kDone) {
    if (outcome == Outcome::kStalled) roll_back(report);
    return outcome;
  }
  if (!phase_.finite()) return Outcome::kNotFinite;
  add_works(h, impulses, report);
  if (!go_to_end(h, report)) {
    phase_.state.axes = first_axes_;
    roll_back(report);
    return Outcome::kStalled;
  }
  if (!phase_.finite()) return Outcome::kNotFinite;
  if (settings_.report_energy)
    report.works.flow += works_.spin_energy(phase_.momenta, phase_.state.poses, KickWorks::Bodies::kAll);
  keep_impulses(h, impulses);
  report.substeps = 1;
  stages_.report_residuals(report);
  const Stopwatch watch(report.times.velocities);
  update_step_limit();
  return Outcome::kDone;
}

/// The impulses of the step before, as a guess; of dependent rows behind contacts none, since what they have
/// in the null space would be carried from step to step.
void MoreauJean::predict(double h, std::span<double> impulses) {
  std::fill(values_.lambda.begin(), values_.lambda.end(), 0.0);
  const bool dependent = system_.singular() && !contacts_.empty();
  const int first = dependent ? system_.rows().first_contact_row() : 0;
  std::fill_n(impulses.begin(), first, 0.0);
  for (int r = first; r < system_.row_count(); ++r)
    impulses[r] =
        prediction_.has_history() ? prediction_.scale(h) * impulses[r] : h * values_.force_multipliers[r];
}

/// q_M, its contacts, and J there.  phase_.start_poses and phase_.start_momenta stay those of the start.
void MoreauJean::go_to_middle(double h, SubstepReport& report) {
  if (bounded()) {
    stages_.residual().begin_velocities(phase_.state.twists);
    system_.rows().residual(phase_.state, values_.phi);
    for (const Rows::AxisRow& axis : system_.rows().axis_rows())
      values_.start_theta[axis.row] = values_.phi[axis.row];
    contacts_.begin_single_kick(h);
  }
  phase_.start_momenta = phase_.kicked = phase_.momenta;
  phase_.start_poses = phase_.state.poses;
  phase_.start_time = phase_.state.time;
  phase_.state.time += 0.5 * h;
  {
    const Stopwatch watch(report.times.positions);
    for (int b = 0; b < world_.body_count(); ++b)
      if (system_.inverse_mass(b).moves()) phase_.state.poses[b] = moved(b, 0.5 * h);
  }
  if (!contacts_.empty()) find_contacts();
  linearize(report);
}

/// A body after h with the momenta of the start.
Pose MoreauJean::moved(int b, double h) const {
  return free_flow(system_.mass(), b, phase_.start_poses[b], phase_.start_momenta[b].torque,
                   phase_.start_momenta[b].force, h);
}

/// V₀ and what the laws take from it, and the factor for these laws.
void MoreauJean::begin_laws(double h, std::span<double> impulses, SubstepReport& report) {
  phase_.twists_from(phase_.momenta);
  first_twists_ = phase_.state.twists;
  blended_ = phase_.state;
  theta_ = settings_.theta;
  if (bounded()) {
    system_.rates_of(phase_.state, values_.rates);
    stages_.renew_effective_masses();
    axes_.begin(phase_.start_time, h, values_.start_theta, values_.rates, stages_.effective_mass(),
                phase_.state.axes);
    theta_ = axes_.find_unresolved(system_, true) ? 1 : settings_.theta;
    axes_.begin_single_kick(theta_);
    contacts_.begin_impulses(values_.rates, stages_.effective_mass());
    if (contacts_.soft()) {
      roll_back(report);
      fail("settings integrator", R"(must be "rattle" where compliant materials touch)",
           name_of(settings_.integrator, kIntegratorNames));
    }
    contacts_.clear_idle(impulses);
    system_.rows().residual(phase_.accepted_end(), values_.phi);
    stages_.set_equalities();
    renew_laws();
    stages_.prepare(values_.rates, impulses);
  }
  if (!stages_.factors_on_demand()) system_.factorize(report.times);
  if (bounded())
    axes_.find_effective_masses(system_, stages_.effective_mass());  // for the laws of solve_stage()
}

/// (q_ϑ, V_ϑ) of the momenta of now.
void MoreauJean::blend(double h) {
  const double theta = theta_, last = theta * theta * h;
  blended_.time = phase_.start_time + theta * h;
  for (int b = 0; b < world_.body_count(); ++b) {
    if (!system_.inverse_mass(b).moves()) continue;
    const Twist &V0 = first_twists_[b], &V1 = phase_.state.twists[b];
    blended_.twists[b] = {(1 - theta) * V0.w + theta * V1.w, (1 - theta) * V0.v + theta * V1.v};
    blended_.poses[b] = free_flow(system_.mass(), b, moved(b, theta * h - last), phase_.momenta[b].torque,
                                  phase_.momenta[b].force, last);
  }
}

/// Λ, with the forces at the state that it leads to: a fixed point.
Scheme::Outcome MoreauJean::find_impulses(double h, std::span<double> impulses, SubstepReport& report) {
  using Fixed = ForceIteration::Fixed;
  blend(h);
  phase_.find_forces(blended_);
  for (;;) {
    for (int b = 0; b < world_.body_count(); ++b)
      if (system_.inverse_mass(b).moves()) phase_.momenta[b] = phase_.start_momenta[b] + h * phase_.forces[b];
    if (!phase_.finite() || !axes_.finite()) return Outcome::kNotFinite;
    if (!solve_stage(impulses, report)) return Outcome::kStalled;
    const Stopwatch watch(report.times.forces);
    blend(h);
    const Fixed fixed = renew_kick_forces(blended_);
    if (fixed == Fixed::kYes) std::swap(phase_.forces, last_forces_);  // those that p₁ has
    if (fixed != Fixed::kNotYet) return fixed == Fixed::kYes ? Outcome::kDone : Outcome::kStalled;
  }
}

/// Joints and laws on J V₁, from the momenta without impulses.
bool MoreauJean::solve_stage(std::span<double> impulses, SubstepReport& report) {
  const Stopwatch watch(report.times.velocities);
  if (!bounded()) {
    project_momenta(0, report);
    return std::isfinite(report.velocity_residual);
  }
  free_momenta_ = phase_.momenta;
  phase_.twists_from(phase_.momenta);
  free_rates_.resize(system_.row_count());
  system_.rates_of(phase_.state, free_rates_);
  if (!meet_laws(1, impulses, report)) return false;
  const double restitution = contacts_.restitution();
  if (restitution == 0 || !(given_by_contacts(impulses) > 0)) return true;
  const RestitutionSearch search{restitution, [&](double part) { return meet_laws(part, impulses, report); },
                                 [&] { return given_by_contacts(impulses); }};
  return search.run();
}

/// With this part of restitution.
bool MoreauJean::meet_laws(double part, std::span<double> impulses, SubstepReport& report) {
  contacts_.weaken_restitution(part);
  phase_.momenta = free_momenta_;
  values_.rates = free_rates_;
  renew_laws();
  values_.add_rates_of(impulses, system_);
  stages_.accuracy().begin_pass();  // replaces the one before
  stages_.residual().note_round_off();
  const StageSolver::Renew renew = [this] { renew_laws(); };
  if (!stages_.solve_velocities({impulses, values_.rates, renew}, report)) return false;
  phase_.add_impulses(impulses);
  note_velocities(impulses, report);
  return projection_.accepts(report.velocity_residual);
}

/// What contacts have given against the motion without impulses [J].
double MoreauJean::given_by_contacts(std::span<const double> impulses) {
  mean_rates_.resize(free_rates_.size());
  for (std::size_t r = 0; r < mean_rates_.size(); ++r)
    mean_rates_[r] = 0.5 * (free_rates_[r] + values_.rates[r]);
  const double given = contacts_.works().of_rigid(impulses, mean_rates_);
  return works_.if_seen(given, phase_.momenta);
}

/// The one kick of the step, at q_M where it acts.
void MoreauJean::add_works(double h, std::span<const double> impulses, SubstepReport& report) {
  if (bounded()) finish_laws(impulses);
  if (!settings_.report_energy) return;
  // Forces that are not conservative were taken at the weighted state.
  works_.add({blended_, phase_.start_momenta, phase_.momenta, system_.jacobian(), impulses}, phase_.forces,
             2 * h, report.works);
  // What the ways to q_M and from there to q₁ change of the kinetic energy, up to its end.
  report.works.flow += works_.spin_energy(phase_.start_momenta, phase_.state.poses, KickWorks::Bodies::kAll) -
                       works_.spin_energy(phase_.start_momenta, phase_.start_poses, KickWorks::Bodies::kAll) -
                       works_.spin_energy(phase_.momenta, phase_.state.poses, KickWorks::Bodies::kAll);
}

/// q₁, and joints closed there if that is wanted.
bool MoreauJean::go_to_end(double h, SubstepReport& report) {
  {
    const Stopwatch watch(report.times.positions);
    const double last = theta_ * h;
    for (int b = 0; b < world_.body_count(); ++b)
      if (system_.inverse_mass(b).moves())
        phase_.state.poses[b] = free_flow(system_.mass(), b, moved(b, h - last), phase_.momenta[b].torque,
                                          phase_.momenta[b].force, last);
  }
  phase_.state.time = phase_.start_time + h;
  first_axes_ = phase_.state.axes;
  system_.rows().update_axes(phase_.accepted_end(), phase_.state.axes);
  if (settings_.drift_cure == DriftCure::kPositionPush && !push_positions(report)) return false;
  axes_.give_ropes(system_.rows(), phase_.state);
  system_.set_mass(phase_.state.poses);
  phase_.twists_from(phase_.momenta);
  return true;
}

/// Joints and rigid limits closed.
bool MoreauJean::push_positions(SubstepReport& report) {
  axes_.rigid_limits(limits_);
  if (close_joints(system_, phase_.state, settings_.position_tolerance, report, limits_)) return true;
  system_.rows().residual(phase_.state, values_.phi);  // for the diagnosis
  note_passed_limit();
  return false;
}

/// The limit that is passed furthest, for the diagnosis.
void MoreauJean::note_passed_limit() {
  std::vector<Culprit> culprits;
  double furthest = settings_.position_tolerance;
  for (const AxisForces::Bound& limit : limits_) {
    const double excess = std::abs(limit.excess(values_.phi[limit.row]));
    if (!(excess > furthest)) continue;
    furthest = excess;
    culprits = {{.kind = Culprit::Kind::kAxis, .axis = limit.axis, .share = excess}};
  }
  stages_.culprits().set(std::move(culprits));
}

/// For reactions and the next guess.  The impulse of an impact is no force.
void MoreauJean::keep_impulses(double h, std::span<const double> impulses) {
  for (int r = 0; r < system_.row_count(); ++r) {
    values_.impulses[r] += impulses[r];
    if (!struck()) values_.force_multipliers[r] = impulses[r] / h;
  }
  prediction_.keep_step(h);
}

}  // namespace taut
