#include "solvers/integrators/rattle.h"

// Joints that leave within a step, and its books.  (solvers/laws, "Breaking"), (solvers/simulator, "Energy")
namespace taut {

/// What a step of h from the present state leads to: `poses_` at its end while it is tried (h ≠ 0); or, once
/// it is accepted (h = 0), the new state, while `poses_` are still the old ones at which the axes hold.
Configuration Rattle::end_of_step(double h) const {
  if (h == 0) return {state_.poses, state_.time, state_.axes, poses_};
  return {poses_, state_.time + h, state_.axes, state_.poses};
}

/// After a sub-step whose velocities are closed: true if it was taken back because a joint does not bear it.
bool Rattle::break_joints(double h, StepReport& report) {
  for (int r = 0; r < system_.row_count(); ++r) delta_[r] = lambda_[r] + mu_[r];
  if (!breaking_.check(system_, state_, delta_, h)) return false;
  const bool now = breaking_.time_to_break() == 0;
  axes_.forget_impacts(false);
  roll_back(report);
  if (!now) return true;
  release_overloaded();
  if (!iterative()) system_.factorize(report.times);
  return true;
}

/// From the present state on the overloaded joints give no impulse: their rows are masked, so that pattern
/// and analysis stay.
void Rattle::release_overloaded() {
  breaking_.release(state_);
  for (const BreakEvent& event : breaking_.events()) axes_.release(event.joint);
  for (auto* rows : {&lambda_, &mu_, &start_mu_, &force_multipliers_, &asymmetry_, &last_asymmetry_})
    clear_broken_rows(*rows);
  history_ = 0;  // loads jump
  if (bounded()) return;
  broken_states_.assign(system_.row_count(), 0.0);
  for (int r : breaking_.rows()) broken_states_[r] = kMasked;
  system_.set_row_states(broken_states_);
}

Works works_of(const StepReport& r) {
  return {r.constraint_work, r.stiffness_work,   r.driver_work,
          r.force_work,      r.dissipative_work, r.ledger.integration};
}

void set_works(StepReport& report, const Works& works) {
  report.constraint_work = works.constraint;
  report.stiffness_work = works.stiffness;
  report.driver_work = works.driver;
  report.force_work = works.force;
  report.dissipative_work = works.dissipative;
  report.ledger.integration = works.flow;
}

/// Calls `visit(b, ½ (V₀ + V₁))` for the moving bodies in a kick from momenta p₀ to p₁ at the poses of
/// state_. Against these twists the works of impulses that act together add up to the change of kinetic
/// energy exactly.
template <typename Visit>
void Rattle::with_mean_twists(std::span<const Wrench> from, std::span<const Wrench> to, Visit&& visit) const {
  for (int b = 0; b < world_.body_count(); ++b)
    if (system_.inverse_mass(b).moves()) visit(b, mean_twist(b, from[b], to[b]));
}

/// Works in a kick from momenta p₀ to p₁ by forces and the joints' impulses Jᵀ λ.
void Rattle::account(std::span<const Wrench> from, std::span<const Wrench> to,
                     std::span<const double> jacobian, std::span<const double> lambda, double h,
                     StepReport& report) {
  double of_joints = 0, of_forces = 0;
  with_mean_twists(from, to, [&](int b, const Twist& V) {
    const Wrench force = 0.5 * h * forces_[b];
    of_forces += dot(force, V);
    of_joints += dot(to[b] - from[b] - force, V);
  });
  report.constraint_work += of_joints;
  report.force_work += of_forces;
  if (world_.has_dissipative_forces(springs_)) {
    dissipative_.assign(world_.body_count(), Wrench{});
    world_.add_dissipative_forces(state_, dissipative_, springs_);
    with_mean_twists(from, to, [&](int b, const Twist& V) {
      report.dissipative_work += 0.5 * h * dot(dissipative_[b], V);
    });
  }
  if (!has_drivers_) return;
  mean_rates(from, to, jacobian, velocity_rows_);
  for (int r = 0; r < system_.row_count(); ++r)
    if (system_.rows().row(r).store->depends_on_time()) report.driver_work += lambda[r] * velocity_rows_[r];
}

/// Some moving body has three different moments.
bool Rattle::any_split() const {
  for (int b = 0; b < system_.mass().size(); ++b)
    if (!system_.mass()[b].fixed && system_.mass()[b].symmetry_axis < 0) return true;
  return false;
}

/// Σ ½ Lᵀ I_W⁻¹ L of all bodies, or of those with three different moments, whose free flow is split and keeps
/// it to the third order only.
double Rattle::spin_energy(std::span<const Wrench> momenta, std::span<const Pose> poses, Bodies which) const {
  double energy = 0;
  for (int b = 0; b < world_.body_count(); ++b) {
    const MassMatrix::Body& body = system_.mass()[b];
    if (body.fixed || (which == Bodies::kSplit && body.symmetry_axis >= 0)) continue;
    const Quat q = body.principal ? poses[b].q : Quat(poses[b].q * system_.mass().inertia(b).q_BP);
    const Vec3 m = q.conjugate() * momenta[b].torque;
    energy += 0.5 * m.cwiseAbs2().dot(body.inverse_moments);
  }
  return energy;
}

/// The first kick.  What the filter of implicit stiffness takes away is booked apart, as the work of an
/// impulse of its own.
void Rattle::account_for_kick(double h, StepReport& report) {
  if (!implicit_) return account(momenta_, kicked_, kick_jacobian(), lambda_, h, report);
  std::vector<Wrench>& raw = move_;
  for (int b = 0; b < world_.body_count(); ++b)
    raw[b] = momenta_[b] + 0.5 * h * forces_[b] + system_.rows().wrench_on(b, kick_jacobian(), lambda_);
  account(momenta_, raw, kick_jacobian(), lambda_, h, report);
  with_mean_twists(raw, kicked_,
                   [&](int b, const Twist& V) { report.stiffness_work += dot(kicked_[b] - raw[b], V); });
}

}  // namespace taut
