#include "solvers/integrators/force_level.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/state/reach.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/acceleration_equation.h"
#include "solvers/integrators/gauss_newton.h"

namespace taut {
ForceLevel::ForceLevel(const World& world, ConstraintSystem& system, const Settings& settings)
    : Scheme(world, system.rows(), settings),
      world_(world),
      system_(system),
      settings_(settings),
      runge_kutta_(world.body_count()) {
  for (auto* wrenches : {&forces_, &joint_wrenches_, &momenta_}) wrenches->resize(world.body_count());
  acceleration_.resize(world.body_count());
  for (auto* values : {&lambda_, &impulses_, &phi_, &rates_, &delta_, &penalty_inertia_})
    values->assign(system.row_count(), 0.0);
}

Scheme::Outcome ForceLevel::advance(double h, SubstepReport& report) {
  backup_ = state_;
  if (settings_.integrator == Integrator::kForceEuler)
    euler(h, report);
  else
    runge_kutta(h, report);
  state_.time += h;
  if (settings_.drift_cure == DriftCure::kPositionPush) cure_positions(report);
  if (settings_.drift_cure == DriftCure::kVelocityImpulse || settings_.drift_cure == DriftCure::kPositionPush)
    cure_velocities(h, report);
  report.substeps = 1;
  system_.rows().update_axes(state_, state_.axes);
  for (int b = 0; b < world_.body_count(); ++b) {
    if (within_reach(state_.poses[b], state_.twists[b]) && state_.poses[b].q.coeffs().allFinite()) continue;
    not_finite_ = b;
    state_ = backup_;
    return Outcome::kNotFinite;
  }
  return Outcome::kDone;
}

void ForceLevel::accelerate(const State& state, double h, SubstepReport& report,
                            std::vector<Twist>& acceleration) {
  {
    const Stopwatch watch(report.times.forces);
    world_.forces(state, forces_);
  }
  {
    const Stopwatch watch(report.times.assembly);
    system_.linearize(state);
    system_.set_mass(state.poses);
  }
  if (settings_.drift_cure == DriftCure::kPenalty) {
    add_penalty_forces(state, forces_);
    free_accelerations(system_.mass(), state, forces_, acceleration);
    return;
  }
  const bool baumgarte = settings_.drift_cure == DriftCure::kBaumgarte;
  system_.set_compliance(baumgarte ? settings_.cfm : 0);
  system_.factorize(report.times);

  const Stopwatch watch(report.times.velocities);
  acceleration_right_side(system_, state, forces_, acceleration, rates_, lambda_);
  if (baumgarte) {
    // φ̈ = −φ̇/h − erp φ/h²: takes the joint velocity to −erp φ/h within the step [Baumgarte1972].
    system_.rows().residual(state, phi_);
    system_.rates_of(state, rates_);
    for (int r = 0; r < system_.row_count(); ++r)
      lambda_[r] -= rates_[r] / h + settings_.erp / (h * h) * phi_[r];
  }
  system_.solve(lambda_);
  system_.rows().apply_transpose(system_.jacobian(), lambda_, joint_wrenches_);
  for (int b = 0; b < world_.body_count(); ++b) {
    if (system_.mass()[b].fixed) continue;
    acceleration[b].w += system_.mass().angular_velocity(b, state.poses[b], joint_wrenches_[b].torque);
    acceleration[b].v += system_.mass()[b].inverse_mass * joint_wrenches_[b].force;
  }
}

std::span<const Wrench> ForceLevel::momenta() const {
  for (int b = 0; b < world_.body_count(); ++b)
    momenta_[b] = system_.mass().momentum(b, state_.poses[b], state_.twists[b]);
  return momenta_;
}

/// V₁ = V₀ + h V̇(q₀, V₀), then q₁ = q₀ ⊕ h V₁.
void ForceLevel::euler(double h, SubstepReport& report) {
  accelerate(state_, h, report, acceleration_);
  for (int r = 0; r < system_.row_count(); ++r) impulses_[r] = h * lambda_[r];
  add_twists(state_.twists, h, acceleration_, state_.twists);
  move_poses(system_.mass(), state_.poses, state_.twists, h, state_.poses);
}

/// Joint forces of the first stage are those at the start.
void ForceLevel::runge_kutta(double h, SubstepReport& report) {
  bool first = true;
  runge_kutta_.advance(system_.mass(), state_, h,
                       [&](const State& stage, double /*weight*/, std::vector<Twist>& acceleration) {
                         accelerate(stage, h, report, acceleration);
                         if (first)
                           for (int r = 0; r < system_.row_count(); ++r) impulses_[r] = h * lambda_[r];
                         first = false;
                       });
}

/// V += M⁻¹ Jᵀ S⁺ (target − J V − φ_t).
void ForceLevel::project_velocities(std::span<const double> target, SubstepReport& report) {
  system_.set_compliance(0);
  system_.factorize(report.times);
  system_.rates_of(state_, rates_);
  for (int r = 0; r < system_.row_count(); ++r) delta_[r] = target[r] - rates_[r];
  system_.solve(delta_);
  system_.rows().apply_transpose(system_.jacobian(), delta_, joint_wrenches_);
  for (int b = 0; b < world_.body_count(); ++b) {
    if (system_.mass()[b].fixed) continue;
    state_.twists[b].w += system_.mass().angular_velocity(b, state_.poses[b], joint_wrenches_[b].torque);
    state_.twists[b].v += system_.mass()[b].inverse_mass * joint_wrenches_[b].force;
  }
}

/// Velocity impulse: J V = −erp φ/h, so that the next step takes out that part of the gap.  After a position
/// push: J V = 0.
void ForceLevel::cure_velocities(double h, SubstepReport& report) {
  system_.linearize(state_);
  system_.set_mass(state_.poses);
  system_.rows().residual(state_, phi_);
  const double rate = settings_.drift_cure == DriftCure::kVelocityImpulse ? -settings_.erp / h : 0;
  for (double& p : phi_) p *= rate;
  project_velocities(phi_, report);
}

/// Position push: one step of Gauss–Newton that closes this part of each gap.
void ForceLevel::cure_positions(SubstepReport& report) {
  bool done = false;
  const auto ask = [&](std::span<double> delta) {
    if (std::exchange(done, true)) return false;
    system_.rows().residual(state_, phi_);
    for (int r = 0; r < system_.row_count(); ++r) delta[r] = -settings_.erp * phi_[r];
    return true;
  };
  const auto factorize = [&] {
    system_.set_compliance(0);
    system_.factorize(report.times);
    return true;
  };
  gauss_newton(system_, state_, state_.poses, INFINITY, delta_, joint_wrenches_, ask, factorize,
               [&](std::span<double> delta) { system_.solve(delta); });
}

/// Penalty: each row a spring and damper of the set frequency on the row's own inertia 1 / S_rr.  λ = −(k φ +
/// c φ̇).
void ForceLevel::add_penalty_forces(const State& state, std::vector<Wrench>& wrenches) {
  system_.rows().residual(state, phi_);
  system_.rates_of(state, rates_);
  system_.effective_masses(penalty_inertia_);
  const double omega = 2 * std::numbers::pi * settings_.penalty_frequency;
  for (int r = 0; r < system_.row_count(); ++r)
    lambda_[r] = -penalty_inertia_[r] *
                 (omega * omega * phi_[r] + 2 * settings_.penalty_damping_ratio * omega * rates_[r]);
  system_.rows().apply_transpose(system_.jacobian(), lambda_, joint_wrenches_);
  for (int b = 0; b < world_.body_count(); ++b) {
    wrenches[b].torque += joint_wrenches_[b].torque;
    wrenches[b].force += joint_wrenches_[b].force;
  }
}

}  // namespace taut
