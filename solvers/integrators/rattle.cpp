#include "solvers/integrators/rattle.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/base/shared_loop.h"
#include "core/constraints/row_products.h"
#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/free_flow.h"
#include "solvers/integrators/rattle_tuning.h"

namespace taut {

Rattle::Rattle(const World& world, ConstraintSystem& system, const Settings& settings)
    : ImpulseScheme(world, system, settings),
      tension_(system),
      start_jacobian_(system),
      weak_directions_(system, settings, start_jacobian_, phase_, values_),
      impacts_(axes_.impacts(), contacts_.impacts()),
      raw_kick_(world.body_count()) {
  // Loops that stick cannot be closed, nor axes be moved back, by a little here and there.
  if (stages_.friction_dominated()) slack_ = RattleTuning::kSlack * settings.position_tolerance;
  axes_.set_slack(slack_);
  if (stages_.iterative()) absorbed_.resize(world.body_count());
}

/// Its own velocities are tangent, too, but for what round-off has left since.
void Rattle::start(const State& state, Velocities /*velocities*/, SubstepReport& report) {
  ImpulseScheme::start(state, Velocities::kGiven, report);
  size_ = system_size(phase_.state.poses);
}

Scheme::Outcome Rattle::advance(double h, SubstepReport& report) {
  std::vector<double>& lambda = values_.lambda;  // of the first kick
  std::vector<double>& mu = values_.mu;          // of the second
  std::vector<Pose>& q1 = phase_.trial_poses;    // at the end of the drift
  begin_step(h, lambda, report);                 // laws, and λ as it is predicted
  const bool closed = stages_.iterative() ? stabilize_positions(h, lambda, q1, report)
                      : bounded()         ? close_bounded_positions(h, lambda, q1, report)
                                          : close_joint_positions(h, lambda, q1, report);
  if (!closed) return reject(Outcome::kStalled, report);  // kick, drift, φ(q₁) = 0 and the laws
  if (bounded() && impacts_.begin(lambda, values_.rates)) {
    time_to_event_ = time_of_impact(h, lambda, q1, report);
    return Outcome::kImpact;
  }
  if (exceeds_tension_limit(h, lambda)) return reject(Outcome::kUnstable, report);
  accept_positions(h, lambda, q1, report);
  if (!contacts_.empty()) find_contacts();
  if (blind()) return take_back(Outcome::kBlind, report);
  factorize_end(lambda, report);                 // S(q₁)
  if (!close_velocities(h, lambda, mu, report))  // kick, J V = 0 and the laws
    return take_back(Outcome::kStalled, report);
  if (!phase_.finite()) return Outcome::kNotFinite;
  if (impact_stage_.due() && !strike(h, mu, report)) return take_back(Outcome::kStalled, report);
  if (breaking_.possible() && break_joints(h, lambda, mu, report)) return Outcome::kOverload;
  finish(h, lambda, mu, report);
  return Outcome::kDone;
}

/// The prediction of λ and the laws of the first kick, with geometric stiffness at its end if that is wanted.
void Rattle::begin_step(double h, std::span<double> lambda, SubstepReport& report) {
  stages_.begin_advance();
  impact_stage_.begin();
  force_iteration_.begin();
  tension_.end();
  if (settings_.tension == TensionPolicy::kImplicit &&
      limit_.omega() * std::abs(h) > settings_.max_tension_number) {
    tension_.begin(h, phase_.state.poses, limit_.stiffness(), breaking_, contacts_);
    system_.factorize(report.times);
  }
  {
    const Stopwatch watch(report.times.positions);
    predict_multipliers(h, lambda);
  }
  if (bounded()) begin_bounds(h);
}

/// Multipliers far from their prediction are looked at before they are accepted.
bool Rattle::exceeds_tension_limit(double h, std::span<const double> lambda) {
  if (settings_.tension != TensionPolicy::kSubstep || !prediction_missed_) return false;
  for (int r = 0; r < system_.row_count(); ++r) values_.force_multipliers[r] = 2 / h * lambda[r];
  update_step_limit();
  return std::abs(h) > RattleTuning::kLeeway * limit_.step();
}

/// The end of the drift is the state from now on; its works are those of the kick before it.
void Rattle::accept_positions(double h, std::span<const double> lambda, std::span<const Pose> q1,
                              SubstepReport& report) {
  report.tension_number = limit_.omega() * std::abs(h);
  if (settings_.report_energy) {
    account_for_kick(h, lambda, report.works);
    report.works.flow = works_.split_flow(phase_.kicked, phase_.state.poses, q1);
  }
  if (bounded()) keep_first_kick(lambda);
  phase_.accept(h);
}

/// The first kick.  What the filter of implicit stiffness takes away is counted apart, as the work of an
/// impulse of its own.
void Rattle::account_for_kick(double h, std::span<const double> lambda, StepWorks& works) {
  const auto add = [&](std::span<const Wrench> to) {
    works_.add({phase_.state, phase_.momenta, to, start_jacobian_.get(), lambda}, phase_.forces, h, works);
  };
  if (!tension_.active()) return add(phase_.kicked);
  for (int b = 0; b < world_.body_count(); ++b)
    raw_kick_[b] = phase_.momenta[b] + 0.5 * h * phase_.forces[b] +
                   detail::wrench_on(system_.rows(), b, start_jacobian_.get(), lambda);
  add(raw_kick_);
  works_.add_between(raw_kick_, phase_.kicked, works.stiffness);
}

void Rattle::factorize_end(std::span<const double> lambda, SubstepReport& report) {
  if (bounded() && !stages_.iterative()) stages_.prepare(lambda);
  if (stages_.factors_on_demand())
    linearize(report);
  else
    linearize_and_factorize(report);
  start_jacobian_.end();
}

void Rattle::finish(double h, std::span<const double> lambda, std::span<const double> mu,
                    SubstepReport& report) {
  system_.rows().update_axes(phase_.accepted_end(), phase_.state.axes);
  if (bounded()) finish_laws(mu);
  axes_.give_ropes(system_.rows(), phase_.state);
  if (settings_.report_energy) impact_stage_.add_works(h, report.works);
  keep_multipliers(h, lambda, mu);
  if (breaking_.any_due() && breaking_.due(phase_.state.time)) {
    release_overloaded();
    if (!stages_.iterative()) system_.factorize(report.times);
  }
  report.substeps = 1;
  stages_.report_residuals(report);
  const Stopwatch watch(report.times.velocities);
  update_step_limit();
}

/// A step whose positions were not accepted.
Scheme::Outcome Rattle::reject(Outcome outcome, SubstepReport& report) {
  impacts_.end();
  restore(report);
  if (outcome == Outcome::kStalled) flattened_ = true;
  return outcome;
}

/// A step whose positions were accepted.
Scheme::Outcome Rattle::take_back(Outcome outcome, SubstepReport& report) {
  roll_back(report);
  start_jacobian_.end();
  tension_.end();
  impacts_.end();
  return outcome;
}

/// Impulses for reactions, forces at the end of the step, and what the next prediction starts from.
void Rattle::keep_multipliers(double h, std::span<const double> lambda, std::span<const double> mu) {
  const double per_h = 1 / h;
  for (int r = 0; r < system_.row_count(); ++r) {
    values_.impulses[r] += lambda[r] + mu[r];
    if (!struck()) values_.force_multipliers[r] = 2 * per_h * mu[r];  // the impulse of an impact is no force
  }
  prediction_.keep(h, lambda, mu, struck());
}

void Rattle::restore(SubstepReport& report) {
  axes_.roll_back();
  contacts_.roll_back(false);
  if (!start_jacobian_.restore() && !tension_.active()) return;
  system_.set_mass(phase_.state.poses);
  system_.factorize(report.times);
  tension_.end();
}

/// With dependent rows it is the μ of before alone.  Contacts that press and the joints between them go on
/// with the division of the load that they have: of many that their laws allow, another one each step would
/// let some contact slip each time.  Those of contacts are held within their cones.
void Rattle::predict_multipliers(double h, std::span<double> lambda) {
  const int rows = system_.row_count();
  if (stages_.iterative()) {
    prediction_.repeat(h, rows, lambda);
  } else if (system_.singular() && (contacts_.empty() || struck())) {
    // Newton's method and interior points through the bodies leave a null space as they find it.
    const bool good_guess = !bounded() || (contacts_.empty() && stages_.factors_on_demand());
    const int joint_rows = system_.rows().first_contact_row();
    if (prediction_.takes_from_dependent_rows() && good_guess)
      prediction_.repeat(h, joint_rows, lambda);
    else
      std::fill_n(lambda.begin(), joint_rows, 0.0);
  } else if (system_.singular() || !prediction_.has_history()) {
    for (int r = 0; r < rows; ++r) lambda[r] = 0.5 * h * values_.force_multipliers[r];
  } else {
    prediction_.extrapolate(h, lambda);
  }
}

/// q₁, the poses after h with the impulses λ, and φ at the end, which is there.
void Rattle::kick_and_drift(double h, std::span<const double> lambda, std::span<Pose> q1,
                            const Configuration& end, std::span<double> phi) {
  const Rows& rows = system_.rows();
  const std::span<const double> J = start_jacobian_.get();
  const auto kick = [this, &rows, J, lambda, h](int b) {
    phase_.kicked[b] = phase_.momenta[b] + 0.5 * h * phase_.forces[b] + detail::wrench_on(rows, b, J, lambda);
  };
  if (tension_.active()) {
    for (int b = 0; b < world_.body_count(); ++b)
      if (!system_.mass()[b].fixed) kick(b);
    tension_.filter(phase_.state.poses, phase_.kicked);
  }
  const auto drift = [this, kick, q1, h](int first, int last) {
    for (int b = first; b < last; ++b) {
      if (system_.mass()[b].fixed) continue;
      if (!tension_.active()) kick(b);
      if (stages_.iterative()) phase_.kicked[b] = phase_.kicked[b] - absorbed_[b];
      q1[b] = free_flow(system_.mass(), b, phase_.state.poses[b], phase_.kicked[b].torque,
                        phase_.kicked[b].force, h);
    }
  };
  const std::vector<Rows::BodyChunk>& chunks = rows.chunks();
  // Motions of users are asked by the caller's thread alone.
  const detail::LoopThreads& threads = system_.loop_threads();
  if (threads && !rows.depends_on_time()) {
    detail::for_ranges(threads, world_.body_count(), drift);
    detail::for_ranges(threads, static_cast<int>(chunks.size()), [&](int first, int last) {
      for (int k = first; k < last; ++k) rows.residual(end, phi, chunks[k]);
    });
    return;
  }
  for (const Rows::BodyChunk& chunk : chunks) {
    drift(chunk.begin, chunk.end);
    rows.residual(end, phi, chunk);
  }
}

/// λ with φ(q₁) = 0: simplified Newton.  With dependent rows positions count as closed only if the bodies are
/// near to closure, too.
bool Rattle::close_joint_positions(double h, std::span<double> lambda, std::span<Pose> q1,
                                   SubstepReport& report) {
  double last = std::numeric_limits<double>::infinity(), correction = 0;
  bool polished = false;
  values_.residual_is_current = false;
  for (int iteration = 0;; ++iteration) {
    {
      const Stopwatch watch(report.times.positions);
      kick_and_drift(h, lambda, q1, {q1, phase_.state.time + h, phase_.state.axes}, values_.phi);
    }
    breaking_.clear_rows(values_.phi);
    const double gap = max_abs(values_.phi);
    if (!std::isfinite(gap)) return false;
    const bool closed = gap <= settings_.position_tolerance;
    const bool spent = iteration >= settings_.max_newton_iterations;
    const bool weak = system_.singular();
    if (closed && (!weak || weak_directions_.distance_to_closure(values_.correction, report) <=
                                RattleTuning::kFarOpen * size_))
      break;
    const bool in_vain =
        closed ? polished
               : (spent || gap > RattleTuning::kSlowNewton * last) && weak && gap < RattleTuning::kMendable;
    if (in_vain) {
      prediction_missed_ = false;
      const auto drift = [&] {
        kick_and_drift(h, lambda, q1, phase_.trial_end(h), values_.phi);
        breaking_.clear_rows(values_.phi);
      };
      return weak_directions_.close(h, RattleTuning::kFarOpen * size_, std::cref(drift), report);
    }
    if (!closed && (spent || !keep_pace(gap, last, h, q1, report))) return false;
    polished = polished || closed;
    last = gap;
    const Stopwatch watch(report.times.positions);
    correction += correct_multipliers(h, closed, lambda);
    ++report.newton_iterations;
  }
  prediction_missed_ = correction > RattleTuning::kSurprise * max_abs(lambda);
  values_.residual_is_current = true;
  return true;
}

/// λ ← λ − S⁻¹ φ/h; `from_closure`: the correction is S_ε⁻¹ φ already.
/// @returns the largest change.
double Rattle::correct_multipliers(double h, bool from_closure, std::span<double> lambda) {
  std::vector<double>& correction = values_.correction;
  if (from_closure) {
    for (double& c : correction) c *= -1 / h;
    system_.project(correction);
  } else {
    for (int r = 0; r < system_.row_count(); ++r) correction[r] = -1 / h * values_.phi[r];
    system_.solve(correction);
  }
  for (int r = 0; r < system_.row_count(); ++r) lambda[r] += correction[r];
  return max_abs(correction);
}

/// Newton that hardly comes closer gets a fresh factor, once.  The true derivative of φ(q₁) is
/// h J(q₁) M⁻¹ J(q₀)ᵀ; S of the mean Jacobian is its symmetric neighbour of least error.
/// @returns whether it is worth going on.
bool Rattle::keep_pace(double error, double last, double h, std::span<const Pose> q1, SubstepReport& report) {
  if (!(error > RattleTuning::kSlowNewton * last)) return true;
  if (error > RattleTuning::kDiverging * last || !start_jacobian_.keep()) return false;
  system_.linearize({q1, phase_.state.time + h, phase_.state.axes});
  start_jacobian_.mix_into_system();
  system_.factorize(report.times);
  ++report.counts.refactorizations;
  return true;
}

bool Rattle::close_velocities(double h, std::span<const double> lambda, std::span<double> mu,
                              SubstepReport& report) {
  using Fixed = ForceIteration::Fixed;
  {
    const Stopwatch watch(report.times.forces);
    // Velocity-dependent laws see the velocities at the middle of the step first.
    if (phase_.forces_depend_on_velocity()) {
      phase_.twists_from(phase_.kicked);
    }
    phase_.find_forces();
  }
  const Stopwatch watch(report.times.velocities);
  for (;;) {
    if (!bounded()) {
      project_momenta(h, report);
    } else {
      if (!give_second_kick(h, lambda, false, mu, report)) return false;
      if (second_kick_gives(mu)) {
        const bool met = give_second_kick(h, lambda, true, mu, report);
        contacts_.end_impacts();
        if (!met) return false;
      }
    }
    if (!phase_.forces_depend_on_velocity()) return true;
    // f(q₁, V₁) with the V₁ that it leads to: a fixed point, which keeps the scheme symmetric.
    const Fixed fixed = renew_kick_forces(phase_.state);
    if (fixed != Fixed::kNotYet) return fixed == Fixed::kYes;
  }
}

}  // namespace taut
