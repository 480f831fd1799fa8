#include "scenes/bench/bench_report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "scenes/bench/bench_plan.h"
#include "scenes/bench/work_report.h"
#include "scenes/support/format.h"
#include "scenes/support/printable.h"

namespace taut {
namespace {

using OrderedJson = nlohmann::ordered_json;

// What counts as a simulation in the comparison: energy within a tenth, for at least this long.
constexpr double kMaxDrift = 0.1, kMinTime = 0.2;
// With contact: half of the time that is asked for; what stands has fallen where a body has gone so far [m],
// and bodies have passed through each other where they were in each other by so much [m].
constexpr double kMinShare = 0.5, kFallen = 0.05, kPassed = 0.1;

std::string label_of(const OrderedJson& run) {
  return WorkRun{run.at("scene"), run.at("n"), run.value("with", "")}.label();
}
std::string method_of(const OrderedJson& run) {
  return run.at("engine").get<std::string>() + ' ' + run.at("method").get<std::string>() +
         format(", %g Hz", run.at("rate_hz").get<double>());
}
std::string status_of(const OrderedJson& run) { return run.value("status", ""); }
bool is_taut(const OrderedJson& run) { return run.at("engine") == "taut"; }
double cost(const OrderedJson& run) { return run.at("cpu_per_simulated_s"); }
double joint_error(const OrderedJson& run) {
  return std::max(run.at("max_joint_error_m").get<double>(),
                  run.at("max_joint_angle_error_rad").get<double>());
}
bool moved(const OrderedJson& run) {
  return run.contains("cpu_per_simulated_s") && run.contains("max_joint_error_m");
}

std::string quality_of(const OrderedJson& run) {
  return run.value("quality", name_of(BenchQuality::kJoints));
}
bool is(const OrderedJson& run, BenchQuality quality) { return quality_of(run) == name_of(quality); }
bool has_contact(const OrderedJson& run) { return !is(run, BenchQuality::kJoints); }
double number(const OrderedJson& run, const char* key) { return run.at(key).get<double>(); }

/// The largest of what must not be (BenchQuality).
double error_of(const OrderedJson& run) {
  double error = joint_error(run);
  if (is(run, BenchQuality::kRests) || is(run, BenchQuality::kStands))
    error = std::max(error, number(run, "final_penetration_m"));
  return is(run, BenchQuality::kStands) ? std::max(error, number(run, "creep_m")) : error;
}

/// Whether nothing fell that stands, or passed through anything, and enough was seen of it; contact takes
/// energy, but must not give any.
bool is_sound_contact(const OrderedJson& run) {
  return !(is(run, BenchQuality::kStands) && number(run, "max_motion_m") > kFallen) &&
         number(run, "max_penetration_m") <= kPassed && number(run, "max_energy_gain_rel") <= kMaxDrift &&
         number(run, "simulated_time_s") >= kMinShare * number(run, "duration_s");
}

/// Whether it is a simulation with that error at most.
bool holds(const OrderedJson& run, double error) {
  const std::string status = status_of(run);
  if (!moved(run) || (status != "success" && status != "time limit") || !(error_of(run) <= error))
    return false;
  if (has_contact(run)) return is_sound_contact(run);
  return run.at("energy_drift_rel") <= kMaxDrift &&
         run.at("simulated_time_s") >= std::min(kMinTime, 0.99 * run.at("duration_s").get<double>());
}

template <typename Accept>
const OrderedJson* fastest(const std::vector<const OrderedJson*>& runs, Accept&& accept) {
  const OrderedJson* best = nullptr;
  for (const OrderedJson* run : runs)
    if (accept(*run) && (!best || cost(*run) < cost(*best))) best = run;
  return best;
}

std::string cell(const OrderedJson* run) {
  if (!run) return "none";
  std::string text = method_of(*run) + format(": %.3g s/s, ", cost(*run));
  if (!has_contact(*run))
    text += format("joint %.0e, drift %.0e", joint_error(*run), number(*run, "energy_drift_rel"));
  else
    text += format("error %.0e", error_of(*run));
  if (status_of(*run) == "time limit")
    text += format(" (first %.2g s)", run->at("simulated_time_s").get<double>());
  return text;
}

/// What runs are compared by: of scenes with contact, or of those without.
struct Kind {
  bool contact;
  const char* error;          ///< its name
  double taut, fine, coarse;  ///< bounds of error_of()
};
constexpr Kind kJoints{false, "joints", 1e-9, 1e-6, 1e-3}, kContacts{true, "error", 1e-5, 1e-5, 1e-3};

using Runs = std::vector<const OrderedJson*>;

/// Runs by scene, in the order of the results.
std::vector<std::pair<std::string, Runs>> by_scene(const BenchResults& results) {
  std::vector<std::pair<std::string, Runs>> scenes;
  for (const OrderedJson& run : results.at("runs")) {
    if (scenes.empty() || scenes.back().first != label_of(run)) scenes.push_back({label_of(run), {}});
    scenes.back().second.push_back(&run);
  }
  return scenes;
}
std::vector<std::pair<std::string, Runs>> by_scene(const BenchResults& results, const Kind& kind) {
  auto scenes = by_scene(results);
  std::erase_if(scenes,
                [&](const auto& scene) { return has_contact(*scene.second.front()) != kind.contact; });
  return scenes;
}

struct Best {
  const OrderedJson *taut, *peer_fine, *peer_coarse;
};
Best best_of(const Runs& runs, const Kind& kind) {
  return {fastest(runs,
                  [&](const OrderedJson& r) {
                    return is_taut(r) && holds(r, kind.taut) && joint_error(r) <= 1e-9;
                  }),
          fastest(runs, [&](const OrderedJson& r) { return !is_taut(r) && holds(r, kind.fine); }),
          fastest(runs, [&](const OrderedJson& r) { return !is_taut(r) && holds(r, kind.coarse); })};
}

std::string best_table(const BenchResults& results, const Kind& kind) {
  std::string text =
      format("| scene | taut, %s ≤ %.0e | best peer, %s ≤ %.0e | best peer, %s ≤ %.0e |\n|---|---|---|---|\n",
             kind.error, kind.taut, kind.error, kind.fine, kind.error, kind.coarse);
  for (const auto& [scene, runs] : by_scene(results, kind)) {
    const Best best = best_of(runs, kind);
    text += "| " + scene + " | " + cell(best.taut) + " | " + cell(best.peer_fine) + " | " +
            cell(best.peer_coarse) + " |\n";
  }
  return text;
}

std::string ahead_list(const BenchResults& results, const Kind& kind) {
  std::string text;
  for (const auto& [scene, runs] : by_scene(results, kind)) {
    const Best best = best_of(runs, kind);
    if (!best.taut) {
      text += "- " + scene + ": taut has no run that counts.\n";
      continue;
    }
    for (const auto& [peer, error] :
         {std::pair(best.peer_fine, kind.fine), std::pair(best.peer_coarse, kind.coarse)})
      if (peer && cost(*peer) < cost(*best.taut))
        text += "- " + scene + format(", %s ≤ %.0e: ", kind.error, error) + method_of(*peer) +
                format(" takes %.2g of taut's time (%.3g against %.3g s/s).\n",
                       cost(*peer) / cost(*best.taut), cost(*peer), cost(*best.taut));
  }
  return text.empty() ? "Nowhere in these runs.\n" : text;
}

/// Time per step by family of scenes and method, in order of rows.
std::map<std::pair<std::string, std::string>, std::vector<std::pair<double, double>>> growth(
    const BenchResults& results) {
  std::map<std::pair<std::string, std::string>, std::vector<std::pair<double, double>>> curves;
  for (const OrderedJson& run : results.at("runs")) {
    if (!moved(run) || has_contact(run) || !run.value("with", "").empty() || run.at("cpu_per_step_s") <= 0)
      continue;
    curves[{run.at("scene"), method_of(run)}].emplace_back(run.at("rows"), run.at("cpu_per_step_s"));
  }
  for (auto& [key, points] : curves) std::sort(points.begin(), points.end());
  return curves;
}

std::string growth_table(const BenchResults& results) {
  std::string text = "| scenes | method | rows | median time per step | exponent |\n|---|---|---|---|---|\n";
  for (const auto& [key, points] : growth(results)) {
    const auto power = growth_exponent(points);
    if (!power || points.front().first == points.back().first) continue;
    std::string rows, times;
    for (const auto& [x, y] : points) {
      rows += format("%s%g", rows.empty() ? "" : ", ", x);
      times += format("%s%.3g", times.empty() ? "" : ", ", 1e3 * y);
    }
    text += "| " + key.first + " | " + key.second + " | " + rows + " | " + times + " ms | " +
            format("%.2f", *power) + " |\n";
  }
  return text;
}

std::string run_table(const BenchResults& results) {
  std::string text =
      "| scene | method | status | simulated [s] | wall s/s | CPU s/s | joint error | drift | probe [m] | "
      "memory "
      "[MB] |\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (const OrderedJson& run : results.at("runs")) {
    if (has_contact(run)) continue;
    text += "| " + label_of(run) + " | " + method_of(run) + " | " + status_of(run);
    if (run.contains("message")) text += ": " + run.at("message").get<std::string>().substr(0, 60);
    if (!moved(run)) {
      text += " | | | | | | | |\n";
      continue;
    }
    const double probe = run.contains("probe_distance_m") ? run.at("probe_distance_m").get<double>() : NAN;
    text += format(" | %.3g | %.3g | %.3g | %.1e | %.1e | ", run.at("simulated_time_s").get<double>(),
                   run.at("wall_per_simulated_s").get<double>(), cost(run), joint_error(run),
                   run.at("energy_drift_rel").get<double>()) +
            (std::isnan(probe) ? "–" : format("%.1e", probe)) +
            format(" | %.0f |\n", run.value("peak_memory_mb", 0.0));
  }
  return text;
}

std::string contact_run_table(const BenchResults& results) {
  std::string text =
      "| scene | method | status | simulated [s] | CPU s/s | joint error | moved by [m] | creep [m] | "
      "penetration, most [m] | at the end | energy won |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const OrderedJson& run : results.at("runs")) {
    if (!has_contact(run)) continue;
    text += "| " + label_of(run) + " | " + method_of(run) + " | " + status_of(run);
    if (run.contains("message")) text += ": " + run.at("message").get<std::string>().substr(0, 60);
    text += !moved(run) ? " | | | | | | | | |\n"
                        : format(" | %.3g | %.3g | %.1e | %.1e | %.1e | %.1e | %.1e | %.1e |\n",
                                 number(run, "simulated_time_s"), cost(run), joint_error(run),
                                 number(run, "max_motion_m"), number(run, "creep_m"),
                                 number(run, "max_penetration_m"), number(run, "final_penetration_m"),
                                 number(run, "max_energy_gain_rel"));
  }
  return text;
}

/// What the tables of scenes with contact say.
std::string contact_section(const BenchResults& results) {
  if (by_scene(results, kContacts).empty()) return "";
  return R"(## Contact

Error: of joints; where bodies come to rest (pile) or stand (stack, wall, card-house, chain-over-cylinder) also how deep
they are in each other at the end, and of what stands how far the centre of one went in the second half of the run
(creep).  Runs do not count that cover less than half of the time, win a tenth of the energy that the scene can turn
over, let what stands move by more than 0.05 m from its start, or bodies be in each other by more than 0.1 m.  All
lengths are measured from the poses, in one way for all engines.  Only taut is given the compliance of materials; Bullet
is given no friction of rolling and spinning.  In a wall one end brick of every row but the lowest balances on an edge, so
that the least error throws it off.

)" + best_table(results, kContacts) +
         "\n### Where a peer is ahead\n\n" + ahead_list(results, kContacts) +
         "\n### All runs with contact\n\n" + contact_run_table(results) + '\n';
}

/// What the tables of scenes of joints say.
std::string joint_section(const BenchResults& results) {
  if (by_scene(results, kJoints).empty()) return "";
  return "## Best of each\n\n" + best_table(results, kJoints) + "\n## Where a peer is ahead\n\n" +
         ahead_list(results, kJoints) + "\n## Growth with size\n\n" + growth_table(results) + '\n';
}

/// Whether a run breaks what an earlier one kept; one that loses the promise of closed joints is worth no
/// time at all.
bool holds_less(const OrderedJson& run, const OrderedJson& before) {
  const bool opened = moved(run) && joint_error(before) <= 1e-9 && joint_error(run) > 1e-9;
  const double bound = has_contact(run) ? kContacts.taut : kJoints.taut;
  return opened || (holds(before, bound) && !holds(run, bound));
}

}  // namespace

std::string bench_page(const BenchResults& results, const std::string& command) {
  const OrderedJson& machine = results.at("machine");
  std::string text = "# Results of `" + command + "`\n\n";
  for (const auto& [key, value] : machine.items())
    text += "- " + key + ": " + (value.is_string() ? value.get<std::string>() : value.dump()) + '\n';
  if (results.at("runs").empty()) return text + "\n" + work_tables(results);
  text += format("- runs: %zu of %d\n- engines: ", results.at("runs").size(),
                 results.at("planned_runs").get<int>());
  for (const auto& [engine, there] : results.at("engines").items())
    text += engine + (there.get<bool>() ? "; " : " (not installed); ");
  text +=
      "\n\nEach run is a process of its own.  s/s is processor time per simulated second, of the calls that "
      "step; on a "
      "machine without other\nwork it is the wall time.  Joint error: largest over all joints and steps, "
      "from the "
      "poses, in m or rad.  Drift: relative to the\nenergy that the scene can turn over.  Probe: distance of "
      "one "
      "body at 0.5 s from a converged run.  Runs that cover less than "
      "0.2 s, or\nwith a drift above 10 %, do not count as best.  \"time limit\": the run was cut "
      "there.\n\n" +
      joint_section(results) + contact_section(results);
  if (!results.at("profiles").empty()) text += work_tables(results);
  if (!by_scene(results, kJoints).empty()) text += "\n## All runs\n\n" + run_table(results);
  return text;
}

std::string bench_plots(const BenchResults& results, const std::string& folder) {
  std::string script =
      "set terminal svg size 720,480 dynamic background rgb 'white'\nset logscale xy\nset grid\nset key "
      "outside\n"
      "set format '%.0e'\n";
  for (const auto& [scene, runs] : by_scene(results)) {
    std::map<std::string, std::string> series;
    for (const OrderedJson* run : runs)
      if (moved(*run) && status_of(*run) != "diverged")
        series[run->at("engine")] += format("%.9g %.9g\n", cost(*run), std::max(error_of(*run), 1e-16));
    if (series.empty()) continue;
    std::string file = scene, blocks, plot;
    std::replace(file.begin(), file.end(), ' ', '-');
    int index = 0;
    for (const auto& [engine, points] : series) {
      blocks += format("$D%d << EOD\n", index) + points + "EOD\n";
      plot +=
          (plot.empty() ? "plot " : ", ") + format("$D%d with points pt 7 title '%s'", index, engine.c_str());
      ++index;
    }
    script +=
        blocks + "set output " + gnuplot_quoted(folder + "/pareto-" + file + ".svg") + "\nset title " +
        gnuplot_quoted(scene) +
        "\nset xlabel 'processor time per simulated second [s]'\nset ylabel 'largest error [m or rad]'\n" +
        plot + '\n';
  }
  std::map<std::string, std::string> plots;
  int index = 0;
  for (const auto& [key, points] : growth(results)) {
    if (points.size() < 2) continue;
    script += format("$G%d << EOD\n", index);
    for (const auto& [x, y] : points) script += format("%.9g %.9g\n", x, y);
    script += "EOD\n";
    std::string& plot = plots[key.first];
    plot += (plot.empty() ? "plot " : ", ") +
            format("$G%d with linespoints title '%s'", index++, key.second.c_str());
  }
  for (const auto& [scene, plot] : plots)
    script += "set output " + gnuplot_quoted(folder + "/size-" + scene + ".svg") + "\nset title " +
              gnuplot_quoted(scene) + "\nset xlabel 'constraint rows'\nset ylabel 'time per step [s]'\n" +
              plot + '\n';
  return script;
}

BenchComparison compare_bench(const BenchResults& now, const BenchResults& then, double factor) {
  BenchComparison result;
  std::map<std::string, const OrderedJson*> before;
  for (const OrderedJson& run : then.at("runs"))
    if (moved(run)) before[label_of(run) + ", " + method_of(run)] = &run;
  for (std::size_t i = 0; i < now.at("runs").size(); ++i) {
    const OrderedJson& run = now.at("runs")[i];
    const std::string key = label_of(run) + ", " + method_of(run);
    const auto old = before.find(key);
    if (!is_taut(run) || old == before.end()) continue;
    ++result.compared;
    const double ratio = moved(run) ? cost(run) / cost(*old->second) : INFINITY;
    const bool worse = ratio > factor || holds_less(run, *old->second);
    if (worse) result.worse.push_back(i);
    result.text += format("%-60s %8.3g -> %8.3g s/s  x %.2f%s\n", key.c_str(), cost(*old->second),
                          moved(run) ? cost(run) : NAN, ratio, worse ? "  WORSE" : "");
  }
  result.text += format("%d runs of taut compared, %zu worse than x %.2g\n", result.compared,
                        result.worse.size(), factor);
  return result;
}

bool is_better_measurement(const OrderedJson& run, const OrderedJson& other) {
  return moved(run) && moved(other) && cost(run) < cost(other);
}

}  // namespace taut
