#include "scenes/program/run_record.h"

#include <algorithm>
#include <cmath>

#include "core/base/fnv1a.h"
#include "scenes/support/format.h"
#include "solvers/common/setting_checks.h"
#include "solvers/simulator/simulator.h"

namespace taut {
namespace {

/// Of all that moves, if it fell freely for one step from rest [J]: less than this is no energy to measure
/// errors by, as where nothing moves but for round-off.
double energy_after_one_step(const World& world, double dt) {
  double mass = 0;
  for (int b = 1; b < world.body_count(); ++b)
    if (!world.is_fixed(BodyId{b})) mass += world.mass_properties(BodyId{b}).mass();
  return mass * world.gravity().squaredNorm() * dt * dt / 2;
}

}  // namespace

void RunRecord::start(const Scene& source, int rows, double energy) {
  scene = source.name;
  parameters = source.parameters;
  bodies = source.world.moving_body_count();
  joints = source.world.joint_count();
  constraint_rows = rows;
  dt = source.dt;
  start_time = source.world.time();
  initial_energy = final_energy = energy;
  energy_scale = source.energy_scale;
  if (energy_scale <= 0) {
    const State& state = source.world.state();
    energy_scale = kinetic_energy(source.world, state) + std::abs(source.world.potential_energy(state));
    has_scale = energy_scale > 0;
    energy_scale = std::max(energy_scale, energy_after_one_step(source.world, dt));
  }
  has_works = source.settings.report_energy && !is_force_level(source.settings.integrator);
  for (int j = 0; j < joints; ++j)
    for (int k = 0; k < source.world.axis_count({j}); ++k) {
      const AxisId axis{{j}, k};
      const AxisProperties& its = source.world.axis_properties(axis);
      if (its.limits || its.motor) axes.push_back({.axis = axis, .label = source.world.axis_label(axis)});
    }
}

void RunRecord::add(const StepReport& report, double seconds, const Gap& gap, double energy) {
  if (!has_scale) energy_scale = std::max(energy_scale, std::abs(report.kinetic_energy));
  phases += report.times;
  analyses += report.counts.analyses;
  factorizations += report.counts.factorizations;
  refactorizations += report.counts.refactorizations;
  backsolves += report.counts.backsolves;
  newton_iterations += report.newton_iterations;
  substeps += report.substeps;
  max_substeps = std::max(max_substeps, report.substeps);
  max_condition_estimate = std::max(max_condition_estimate, report.condition_estimate);
  max_tension_number = std::max(max_tension_number, report.tension_number);
  pivots += report.counts.pivots;
  contact_iterations += report.counts.contact_iterations;
  if (!report.ok()) return;  // the world has not moved: no step, and nothing below is of its state

  ++steps;
  inexact_steps += !report.exact();
  asleep = report.asleep;
  step_times.push_back(seconds);
  simulated_time = report.time - start_time;
  max_rank_deficiency = std::max(max_rank_deficiency, report.rank_deficiency);
  max_gap.metres = std::max(max_gap.metres, gap.metres);
  max_gap.radians = std::max(max_gap.radians, gap.radians);
  max_velocity_residual = std::max(max_velocity_residual, report.velocity_residual);
  max_contacts = std::max(max_contacts, report.contacts);
  max_penetration = std::max(max_penetration, report.penetration);
  final_penetration = report.penetration;
  max_complementarity_residual = std::max(max_complementarity_residual, report.complementarity_residual);
  max_natural_residual = std::max(max_natural_residual, report.natural_residual);
  add_ledger(report);
  stiffness_work += report.works.stiffness;
  final_energy = energy;
  max_energy_drift = std::max(max_energy_drift, std::abs(energy - initial_energy));
}

std::vector<std::string> RunRecord::note_detection(const StepReport& report, const World& world) {
  constexpr std::size_t kMost = 8;
  std::vector<std::string> found;
  if (report.missing_threads > 0 && missing_threads == 0)
    found.push_back(
        format("%d of the threads could not be started, for a limit of processes or memory: the "
               "others do their work",
               report.missing_threads));
  missing_threads = std::max(missing_threads, report.missing_threads);
  max_unsupported_pairs = std::max(max_unsupported_pairs, report.unsupported_pairs);
  for (const auto& pair : report.unsupported) {
    if (named_pairs.size() >= kMost || !named_pairs.insert(pair).second) continue;
    found.push_back(name_of(pair, world) + format(" meet at t = %.6g s and have no contact: ", world.time()) +
                    "they pass through each other" +
                    (named_pairs.size() == kMost ? "; further pairs are not named" : ""));
  }
  warnings.insert(warnings.end(), found.begin(), found.end());
  return found;
}

void RunRecord::add_ledger(const StepReport& report) {
  if (steps == 1) ledger.start = report.ledger.start;
  ledger += report.ledger;
  const double error = report.ledger.start + report.ledger.total() - report.energy();
  max_ledger_error = std::max(max_ledger_error, std::abs(error));
  max_unexplained = std::max(max_unexplained, std::abs(ledger.unexplained()));
  max_kinetic_energy = std::max(max_kinetic_energy, report.kinetic_energy);
}

void RunRecord::note_inexact(const StepReport& report, const World& world) {
  if (!report.ok() || report.exact() || report.complementarity_residual < worst.residual) return;
  worst = {report.time, report.complementarity_residual, {}};
  for (const Culprit& culprit : report.culprits) worst.culprits.push_back(name_of(culprit, world));
}

void RunRecord::note_axes(const Simulator& simulator) {
  for (AxisEvents& axis : axes) {
    const AxisReport report = simulator.axis_report(axis.axis);
    axis.at_limit = report.at_limit, axis.saturated = report.saturated;
    axis.limit_steps += report.at_limit || report.impact_time, axis.saturated_steps += report.saturated;
  }
}

double RunRecord::balance_scale() const {
  double scale = std::max(energy_scale, max_kinetic_energy);
  for (const LedgerTerm& term : kLedgerTerms)
    if (!term.stored) scale = std::max(scale, std::abs(ledger.*term.amount));
  return scale;
}

double RunRecord::relative_unexplained() const {
  const double scale = balance_scale();
  return scale > 0 ? max_unexplained / scale : 0;
}

void RunRecord::note_breaks(const StepReport& report, const World& world) {
  for (const BreakEvent& event : report.breaks)
    breaks.push_back({world.name(event.joint), event.with.index >= 0 ? world.name(event.with) : "",
                      event.time, event.force, event.torque});
}

bool RunRecord::note_events(const StepReport& report) {
  for (const EventRecord& event : report.events) {
    events.push_back(event);
    if (event.ends_run) ended_by = event.name;
  }
  return !ended_by.empty();
}

void RunRecord::note_rank(const RankReport& rank, const World& world) {
  for (const RedundantRow& row : rank.redundant) {
    Held& held = rows_already_held.emplace_back();
    held.row = std::string(world.joint(row.joint).type()) + " " + world.name(row.joint) + ": " + row.name;
    for (const JointId joint : row.held_by) held.by.push_back(world.name(joint));
  }
  for (const JointId joint : rank.not_unique) reactions_not_unique.push_back(world.name(joint));
}

std::size_t RunRecord::warm_up_steps() const { return std::min<std::size_t>(10, step_times.size() / 3); }

double RunRecord::step_time_quantile(double p) const {
  std::vector<double> times(step_times.begin() + static_cast<std::ptrdiff_t>(warm_up_steps()),
                            step_times.end());
  if (times.empty()) return 0;
  std::sort(times.begin(), times.end());
  const double place = p * static_cast<double>(times.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, times.size() - 1);
  return std::lerp(times[below], times[above], place - static_cast<double>(below));
}

namespace {

void add(Fnv1a& hash, const Vec3& v) {
  for (int i = 0; i < 3; ++i) hash.add(v[i]);
}

}  // namespace

std::uint64_t fingerprint(const State& state) {
  Fnv1a hash;
  hash.add(state.time);
  for (const Pose& pose : state.poses) {
    add(hash, pose.p);
    for (int i = 0; i < 4; ++i) hash.add(pose.q.coeffs()[i]);
  }
  for (const Twist& twist : state.twists)
    for (int i = 0; i < 3; ++i) hash.add(twist.w[i]), hash.add(twist.v[i]);
  return hash.value();
}

std::uint64_t reactions_fingerprint(const Simulator& simulator) {
  Fnv1a hash;
  for (int j = 0; j < simulator.world().joint_count(); ++j) {
    const Reaction reaction = simulator.mean_reaction(JointId{j});
    add(hash, reaction.force), add(hash, reaction.torque);
  }
  for (const ContactReport& contact : simulator.contacts())
    add(hash, contact.force), add(hash, contact.torque);
  return hash.value();
}

std::uint64_t axis_forces_fingerprint(const Simulator& simulator) {
  Fnv1a hash;
  for (int j = 0; j < simulator.world().joint_count(); ++j)
    for (int k = 0; k < simulator.world().axis_count(JointId{j}); ++k) {
      const AxisImpulse force = simulator.axis_report({JointId{j}, k}).force;
      for (const AxisPart& part : kAxisParts) hash.add(force.*part.part);
    }
  return hash.value();
}

}  // namespace taut
