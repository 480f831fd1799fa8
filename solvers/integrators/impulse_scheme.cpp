#include "solvers/integrators/impulse_scheme.h"

#include <algorithm>
#include <utility>

#include "solvers/common/max_abs.h"
#include "solvers/common/stopwatch.h"
#include "solvers/integrators/acceleration_equation.h"
#include "solvers/integrators/body_moves.h"

namespace taut {
namespace {

struct ImpulseSchemeTuning {
  /// Forces that change by more than this part of the largest between steps ask for a new start.  Chosen.
  static constexpr double kJump = 0.25;
};

/// Springs that have rows are no force laws.
Springs springs_among_forces(const ConstraintSystem& system) {
  return system.rows().spring_count() > 0 ? Springs::kLeftOut : Springs::kIncluded;
}

}  // namespace

ImpulseScheme::ImpulseScheme(const World& world, ConstraintSystem& system, const Settings& settings)
    : Scheme(world, system.rows(), settings),
      world_(world),
      system_(system),
      settings_(settings),
      phase_(world, system, springs_among_forces(system)),
      stages_(world, system, axes_, contacts_, settings),
      values_(system.row_count(), stages_.bounded()),
      limit_(world, system, settings, axes_, breaking_, stages_),
      works_(world, system, springs_among_forces(system)),
      prediction_(system.row_count()),
      projection_(system, settings, breaking_, phase_, values_),
      contact_pattern_(world, system, contacts_, stages_, values_, prediction_),
      impact_stage_(system, axes_, contacts_, phase_, values_, works_),
      last_forces_(world.body_count()) {}

void ImpulseScheme::start(const State& state, Velocities velocities, SubstepReport& report) {
  phase_.state = state;
  values_.residual_is_current = false;
  phase_.trial_poses = phase_.start_poses = state.poses;
  if (!contacts_.empty()) contact_pattern_.start(phase_.state);
  system_.release_bounded_rows();
  std::fill(values_.lambda.begin(), values_.lambda.end(), 0.0);
  prediction_.start();
  for (int b = 0; b < world_.body_count(); ++b)
    phase_.momenta[b] = system_.mass().momentum(b, state.poses[b], state.twists[b]);
  linearize_and_factorize(report);
  if (stages_.iterative()) {
    phase_.find_forces();
    phase_.twists_from(phase_.momenta);
    std::fill(values_.mu.begin(), values_.mu.end(), 0.0);
    std::fill(values_.force_multipliers.begin(), values_.force_multipliers.end(), 0.0);
    update_step_limit();
    return start_axes();
  }
  const Stopwatch watch(report.times.velocities);
  if (velocities == Velocities::kGiven)
    project_momenta(0, report);
  else
    phase_.twists_from(phase_.momenta);
  phase_.find_forces();
  predict_forces();
  update_step_limit();
  if (!bounded()) return;
  start_axes();
  stages_.forget_segments();
}

/// Multipliers of the acceleration equation S λ = −(γ + J M⁻¹ (f − ω × Iω)): the first prediction.
void ImpulseScheme::predict_forces() {
  const State& state = phase_.state;
  std::vector<double>& multipliers = values_.force_multipliers;
  std::vector<Twist> accelerations(world_.body_count());
  std::vector<double> rates(multipliers.size());
  world_.forces(state, last_forces_);
  acceleration_right_side(system_, state, last_forces_, accelerations, rates, multipliers);
  projection_.clear_loose_rows(multipliers);
  system_.solve(multipliers);
}

void ImpulseScheme::start_axes() {
  system_.rows().residual(phase_.state, values_.phi);
  system_.rows().apply(system_.jacobian(), phase_.state.twists, values_.rates);
  axes_.start(values_.phi, values_.rates);
}

void ImpulseScheme::restart(const State& state, Velocities velocities, SubstepReport& report) {
  if (!bounded()) return start(state, velocities, report);
  AxisForces::Memory axes = axes_.memory();
  const MultiplierGuess before(system_.rows(), values_);
  contacts_.keep_memory();
  start(state, velocities, report);
  axes_.inherit(std::move(axes));
  take(before);
}

void ImpulseScheme::go_back(const State& state, std::span<const double> impulses, SubstepReport& report) {
  start(state, Velocities::kLeft, report);
  values_.impulses.assign(impulses.begin(), impulses.end());
}

void ImpulseScheme::prepare(double horizon, std::vector<ContactStretch> stretches, Scheme* old) {
  contact_pattern_.set_horizon(horizon);
  contact_pattern_.recall(std::move(stretches));
  if (old) contact_pattern_.inherit(static_cast<ImpulseScheme*>(old)->contact_pattern_);
}

void ImpulseScheme::inherit(const Scheme& old) {
  const auto& from = static_cast<const ImpulseScheme&>(old);
  axes_.inherit(from.axes_.memory());
  if (bounded()) take({from.system_.rows(), from.values_});
}

/// Multipliers of start() know of no contacts, but of loads that are new: the step limit is that of both.
void ImpulseScheme::take(const MultiplierGuess& guess) {
  guess.give(system_.rows(), contacts_, values_);
  contacts_.end_inheritance();
  const double limit = limit_.step(), omega = limit_.omega();
  update_step_limit();
  limit_.tighten(limit, omega);
}

void ImpulseScheme::forget(std::span<const char> moved) {
  axes_.forget(moved);
  contacts_.forget(moved);
}

void ImpulseScheme::begin(double dt) {
  contact_pattern_.set_horizon(dt);
  std::fill(values_.impulses.begin(), values_.impulses.end(), 0.0);
  axes_.clear_reports();
  contacts_.clear_reports();
  flattened_ = false;
}

bool ImpulseScheme::drop_guess() {
  if (stages_.active_set_outcome().ok() || contacts_.empty()) return false;
  contact_pattern_.forget_impulses();
  return true;
}

bool ImpulseScheme::renew_forces() {
  last_forces_ = phase_.forces;
  phase_.find_forces();
  double change = 0, size = 0;
  for (int b = 0; b < world_.body_count(); ++b) {
    if (!system_.inverse_mass(b).moves()) continue;
    change = std::max({change, (phase_.forces[b].force - last_forces_[b].force).norm(),
                       (phase_.forces[b].torque - last_forces_[b].torque).norm()});
    size = std::max({size, last_forces_[b].force.norm(), last_forces_[b].torque.norm()});
  }
  return change <= ImpulseSchemeTuning::kJump * size;
}

std::span<const double> ImpulseScheme::known_residual() const {
  return values_.residual_is_current ? std::span<const double>(values_.phi) : std::span<const double>();
}

/// Where rows have laws other than springs, those of the end of the last step.
std::span<const double> ImpulseScheme::forces_of_laws() const {
  if (axes_.only_springs() && contacts_.empty()) return {};
  return values_.force_multipliers;
}

/// Contacts at the end of the drift, with its velocities.
void ImpulseScheme::find_contacts() {
  phase_.twists_from(phase_.kicked);
  contact_pattern_.move_on(phase_.state);
}

void ImpulseScheme::linearize(SubstepReport& report) {
  const Stopwatch watch(report.times.assembly);
  system_.linearize(phase_.state);
  system_.set_mass(phase_.state.poses);
}

void ImpulseScheme::linearize_and_factorize(SubstepReport& report) {
  if (stages_.iterative()) return linearize(report);
  {
    const Stopwatch watch(report.times.assembly);
    system_.linearize_and_assemble(phase_.state);
  }
  system_.factorize(report.times);
}

/// Of the present stage, at its coordinates and rates; those of equalities it has from its beginning.
void ImpulseScheme::renew_laws() {
  std::vector<RowLaw>& laws = stages_.laws();
  axes_.set_laws(values_.phi, values_.rates, laws);
  contacts_.set_laws(laws);
  for (int r : breaking_.rows()) laws[r] = RowLaw::none();
}

/// Where rates stay, the next prediction does not lean on μ.
void ImpulseScheme::project_momenta(double h, SubstepReport& report) {
  if (!projection_.project(h, report)) prediction_.start_from_zero();
}

/// What is left of the rates that they had to have.
void ImpulseScheme::note_velocities(std::span<const double> mu, SubstepReport& report) {
  phase_.twists_from(phase_.momenta);
  system_.rates_of(phase_.state, values_.rates);
  std::copy(values_.rates.begin(), values_.rates.end(), values_.joint_rates.begin());
  stages_.note_inexact(mu, values_.rates);
  projection_.clear_loose_rows(values_.joint_rates);
  report.velocity_residual = max_abs(values_.joint_rates);
  stages_.note_residual(mu, values_.rates);
}

/// A pass of the fixed point for forces: those at a state that the ones before have led to.
ForceIteration::Fixed ImpulseScheme::renew_kick_forces(const State& at) {
  std::swap(phase_.forces, last_forces_);
  phase_.find_forces(at);
  return force_iteration_.look(phase_.forces, last_forces_);
}

/// After a step: who is held now, and the records of both kicks.
void ImpulseScheme::finish_laws(std::span<const double> mu) {
  system_.rows().residual(phase_.state, values_.phi);  // axes are up to date here
  impact_stage_.record(mu);
  axes_.finish_velocities(values_.phi, values_.rates, phase_.state.time);
  contacts_.finish(mu, phase_.state.time);
}

/// Back to the start of a step whose positions were already accepted.
void ImpulseScheme::roll_back(SubstepReport& report) {
  values_.residual_is_current = false;
  phase_.take_back();
  axes_.roll_back();
  contacts_.roll_back(true);
  contacts_.give_points(system_);
  linearize_and_factorize(report);
  phase_.twists_from(phase_.momenta);
  phase_.find_forces();
}

}  // namespace taut
