#include "scenes/program/run_report.h"

#include <span>
#include <utility>

#include "scenes/support/format.h"
#include "solvers/common/report_names.h"

namespace taut {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// Phases by name, in the order of a step.
std::vector<std::pair<const char*, double>> phases(const StageTimes& times) {
  return {{"forces", times.forces},
          {"positions", times.positions},
          {"assembly", times.assembly},
          {"factorization", times.factorization},
          {"velocities", times.velocities},
          {"analysis", times.analysis},
          {"total", times.total}};
}

OrderedJson probes_json(const World& world, const Recorder& recorder, std::span<const double> values) {
  OrderedJson probes = OrderedJson::array();
  std::size_t column = 0;
  for (const Probe& probe : recorder.probes()) {
    OrderedJson value = OrderedJson::object();
    for (const std::string& component : components(probe.quantity)) {
      value[component] = values.empty() ? OrderedJson() : OrderedJson(values[column]);
      ++column;
    }
    probes.push_back({{"name", probe.name},
                      {"quantity", to_string(probe.quantity)},
                      {"units", units(world, probe)},
                      {"final", std::move(value)}});
  }
  return probes;
}

OrderedJson ledger_json(const EnergyLedger& ledger) {
  OrderedJson json;
  for (const LedgerTerm& term : kLedgerTerms) json[term.name] = ledger.*term.amount;
  return json;
}

OrderedJson breaks_json(const std::vector<RunRecord::Break>& breaks) {
  OrderedJson list = OrderedJson::array();
  for (const RunRecord::Break& event : breaks)
    list.push_back({{"joint", event.joint},
                    {"time_s", event.time},
                    {"force_N", event.force},
                    {"torque_Nm", event.torque},
                    {"with", event.with.empty() ? OrderedJson() : OrderedJson(event.with)}});
  return list;
}

OrderedJson events_json(const std::vector<EventRecord>& events) {
  OrderedJson list = OrderedJson::array();
  for (const EventRecord& event : events)
    list.push_back({{"name", event.name},
                    {"time_s", event.time},
                    {"value", event.value ? OrderedJson(*event.value) : OrderedJson()},
                    {"what", event.what}});
  return list;
}

/// Those that were at a limit, or whose motor gave all it has.
OrderedJson axis_events_json(const std::vector<RunRecord::AxisEvents>& axes) {
  OrderedJson list = OrderedJson::array();
  for (const RunRecord::AxisEvents& axis : axes)
    if (axis.limit_steps + axis.saturated_steps > 0)
      list.push_back({{"axis", axis.label},
                      {"steps_at_limit", axis.limit_steps},
                      {"at_limit", axis.at_limit},
                      {"steps_saturated", axis.saturated_steps},
                      {"saturated", axis.saturated}});
  return list;
}

OrderedJson held_json(const std::vector<RunRecord::Held>& rows) {
  OrderedJson list = OrderedJson::array();
  for (const RunRecord::Held& row : rows) list.push_back({{"row", row.row}, {"held_by", row.by}});
  return list;
}

/// "hanger_3 at 1.2 s, …"
std::string breaks_text(const std::vector<RunRecord::Break>& breaks) {
  constexpr std::size_t kShown = 6;
  return first_of(breaks, kShown,
                  [](const RunRecord::Break& b) { return b.joint + format(" at %.4g s", b.time); });
}

std::string duration(double seconds) {
  if (seconds < 1e-3) return format("%.1f µs", seconds * 1e6);
  if (seconds < 1) return format("%.3f ms", seconds * 1e3);
  return format("%.2f s", seconds);
}

std::string per_step(std::int64_t count, std::int64_t steps) {
  return format("%.2f per step", steps > 0 ? static_cast<double>(count) / static_cast<double>(steps) : 0.0);
}

std::string share_of_phases(const StageTimes& times) {
  std::string text;
  for (const auto& [name, seconds] : phases(times))
    if (times.total > 0 && seconds < times.total)
      text += format("%s%s %.0f %%", text.empty() ? "" : ", ", name, 100 * seconds / times.total);
  return text;
}

}  // namespace

OrderedJson run_report(const RunRecord& r, const Recorder& recorder, const std::vector<double>& values,
                       const World& world) {
  const State& final_state = world.state();
  OrderedJson report;
  report["scene"] = r.scene;
  report["parameters"] = r.parameters;
  report["status"] = r.status;
  report["message"] = r.message;
  report["contradiction"] = r.contradiction.empty() ? OrderedJson()
                                                    : OrderedJson{{"members", r.contradiction},
                                                                  {"residual", r.contradiction_residual}};
  report["warnings"] = r.warnings;
  report["taut_version"] = TAUT_VERSION;
  report["integrator"] = r.integrator;
  report["solver"] = r.solver;
  report["bodies"] = r.bodies;
  report["joints"] = r.joints;
  report["constraint_rows"] = r.constraint_rows;
  report["dt"] = r.dt;
  report["steps"] = r.steps;
  report["steps_asked"] = r.steps_asked;
  report["simulated_time_s"] = r.simulated_time;
  report["wall_time_s"] = r.wall_time;
  report["time_per_step_s"] = {{"median", r.median_step_time()},
                               {"p95", r.step_time_quantile(0.95)},
                               {"max", r.step_time_quantile(1)},
                               {"warm_up_steps", r.warm_up_steps()}};
  for (const auto& [name, seconds] : phases(r.phases)) report["phases"][name] = seconds;
  report["analyses"] = r.analyses;
  report["factorizations"] = r.factorizations;
  report["refactorizations"] = r.refactorizations;
  report["backsolves"] = r.backsolves;
  report["newton_iterations"] = r.newton_iterations;
  report["substeps"] = r.substeps;
  report["max_substeps_per_step"] = r.max_substeps;
  report["max_joint_error_m"] = r.max_gap.metres;
  report["max_joint_angle_error_rad"] = r.max_gap.radians;
  report["max_joint_velocity_error"] = r.max_velocity_residual;
  report["max_rank_deficiency"] = r.max_rank_deficiency;
  report["max_condition_estimate"] = r.max_condition_estimate;
  report["max_tension_number"] = r.max_tension_number;
  report["max_contacts"] = r.max_contacts;
  report["max_penetration_m"] = r.max_penetration;
  report["final_penetration_m"] = r.final_penetration;
  report["max_complementarity_residual"] = r.max_complementarity_residual;
  report["max_natural_residual"] = r.max_natural_residual;
  report["inexact_steps"] = r.inexact_steps;
  report["asleep"] = r.asleep;
  report["missing_threads"] = r.missing_threads;
  report["max_unsupported_pairs"] = r.max_unsupported_pairs;
  report["pivots"] = r.pivots;
  report["contact_iterations"] = r.contact_iterations;
  report["energy"] = {{"initial", r.initial_energy},
                      {"final", r.final_energy},
                      {"scale", r.energy_scale},
                      {"max_drift", r.max_energy_drift},
                      {"max_drift_rel", r.relative_energy_drift()},
                      {"works_known", r.has_works},
                      {"max_unexplained", r.max_unexplained},
                      {"max_unexplained_rel", r.relative_unexplained()},
                      {"stiffness_work", r.stiffness_work},
                      {"ledger", ledger_json(r.ledger)},
                      {"max_ledger_error", r.max_ledger_error}};
  report["breaks"] = breaks_json(r.breaks);
  report["events"] = events_json(r.events);
  report["ended_by"] = r.ended_by.empty() ? OrderedJson() : OrderedJson(r.ended_by);
  report["axes"] = axis_events_json(r.axes);
  report["worst_step"] = r.inexact_steps == 0 ? OrderedJson()
                                              : OrderedJson{{"time_s", r.worst.time},
                                                            {"residual", r.worst.residual},
                                                            {"culprits", r.worst.culprits}};
  report["redundant_rows"] = r.redundant_rows;
  report["rows_already_held"] = held_json(r.rows_already_held);
  report["reactions_not_unique"] = r.reactions_not_unique;
  report["probes"] = probes_json(world, recorder, values);
  report["final_time_s"] = final_state.time;
  const auto hexadecimal = [](std::uint64_t hash) {
    return format("%016llx", static_cast<unsigned long long>(hash));
  };
  report["final_state_fingerprint"] = hexadecimal(fingerprint(final_state));
  report["reactions_fingerprint"] = hexadecimal(r.reactions);
  report["axis_forces_fingerprint"] = hexadecimal(r.axis_forces);
  return report;
}

std::string run_details(const RunRecord& r) {
  std::vector<std::pair<const char*, std::string>> lines{
      {"bodies", format("%d", r.bodies)},
      {"joints", format("%d (%d rows)", r.joints, r.constraint_rows)},
      {"integrator", r.integrator},
      {"solver", r.solver},
      {"steps", format("%lld of %lld, dt %.6g s", static_cast<long long>(r.steps),
                       static_cast<long long>(r.steps_asked), r.dt)},
      {"simulated time", format("%.6g s in %.3g s", r.simulated_time, r.wall_time)},
      {"time per step",
       "median " + duration(r.median_step_time()) + ", p95 " + duration(r.step_time_quantile(0.95))},
      {"phases", share_of_phases(r.phases)},
      {"max joint velocity error", format("%.2e", r.max_velocity_residual)},
      {"factorisations",
       per_step(r.factorizations, r.steps) + format(", %lld analyses", static_cast<long long>(r.analyses))},
      {"back-solves", per_step(r.backsolves, r.steps) + ", Newton " + per_step(r.newton_iterations, r.steps)},
      {"sub-steps", per_step(r.substeps, r.steps) + format(", at most %d", r.max_substeps)},
      {"redundant rows", format("at most %d", r.max_rank_deficiency)},
  };
  if (!r.breaks.empty()) lines.emplace_back("broken joints", breaks_text(r.breaks));
  if (r.max_contacts > 0 || r.pivots > 0 || r.contact_iterations > 0)
    lines.emplace_back("complementarity", format("residual %.2e, ", r.max_natural_residual) + "pivots " +
                                              per_step(r.pivots, r.steps) + ", Newton iterations " +
                                              per_step(r.contact_iterations, r.steps));
  std::string table;
  for (const auto& [name, value] : lines) table += format("%-26s", name) + value + "\n";
  return table;
}

}  // namespace taut
