#include "scenes/accuracy/accuracy_report.h"

#include <algorithm>

#include "scenes/recording/recorder.h"
#include "scenes/support/format.h"
#include "solvers/common/setting_names.h"

namespace taut::reference {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// The verdict over both steps: failed if one failed, else measured if one was.
Verdict overall(const CaseResult& result, std::size_t quantity) {
  Verdict verdict = Verdict::kNotMeasured;
  for (const CaseRun& run : result.runs) {
    const Verdict here = run.quantities.at(quantity).verdict;
    if (here == Verdict::kFail) return here;
    if (here != Verdict::kNotMeasured) verdict = here;
  }
  return verdict;
}

std::string label(const Measurement& m) { return m.time ? m.name + format(" @ %g s", *m.time) : m.name; }

/// "2.1e-07 / 4.0e-06 pass", or why there is no such thing.
std::string cell(const Measurement& m) {
  if (m.measured.empty())
    return std::string(to_string(m.verdict)) + (m.reason.empty() ? "" : ": " + m.reason);
  return format("%8.1e / %-8.1e %s", m.error, m.allowed, to_string(m.verdict));
}

/// Largest error of a run as a part of what is allowed, among the binding quantities.
double worst_ratio(const CaseRun& run) {
  double worst = 0;
  for (const Measurement& m : run.quantities)
    if (!m.measured.empty() && m.verdict != Verdict::kOrientation)
      worst = std::max(worst, m.error / m.allowed);
  return worst;
}

std::string heading(const CaseResult& result) {
  const CaseRun& run = result.runs.front();
  std::string text = format("%-30s %-10s %-8s", run.id.c_str(), run.level.c_str(),
                            name_of(run.integrator, kIntegratorNames));
  for (const CaseRun& r : result.runs)
    text += format("  dt %-8.3g %4d pass %3d fail, worst %-7.2g", r.dt, r.count(Verdict::kPass),
                   r.count(Verdict::kFail), worst_ratio(r));
  const int left = run.count(Verdict::kNotMeasured);
  if (left > 0) text += format("  %d not measured", left);
  return text + '\n';
}

OrderedJson measurement_json(const Measurement& m, const CaseRun& run) {
  OrderedJson json{{"dt", run.dt}, {"verdict", to_string(m.verdict)}};
  if (!m.measured.empty()) {
    json["measured"] = m.measured;
    json["error"] = m.error;
    json["allowed"] = m.allowed;
  }
  if (!m.reason.empty()) json["reason"] = m.reason;
  return json;
}

OrderedJson run_json(const CaseRun& run) {
  OrderedJson json{{"dt", run.dt},
                   {"fraction_of_tol_dt", run.fraction},
                   {"integrator", name_of(run.integrator, kIntegratorNames)},
                   {"steps", run.steps},
                   {"wall_time_s", run.wall_time},
                   {"max_joint_error", run.max_gap}};
  if (!run.failed.empty()) json["failed"] = run.failed;
  return json;
}

OrderedJson case_json(const CaseResult& result) {
  OrderedJson json{{"file", result.file}};
  if (!result.error.empty()) {
    json["error"] = result.error;
    return json;
  }
  const CaseRun& first = result.runs.front();
  json["id"] = first.id;
  json["level"] = first.level;
  for (const CaseRun& run : result.runs) json["runs"].push_back(run_json(run));
  json["quantities"] = OrderedJson::array();
  for (std::size_t i = 0; i < first.quantities.size(); ++i) {
    const Measurement& m = first.quantities[i];
    OrderedJson quantity{{"name", m.name}, {"time", nullptr}, {"reference", m.reference}};
    if (m.time) quantity["time"] = *m.time;
    quantity["verdict"] = to_string(overall(result, i));
    for (const CaseRun& run : result.runs)
      quantity["results"].push_back(measurement_json(run.quantities[i], run));
    json["quantities"].push_back(std::move(quantity));
  }
  return json;
}

}  // namespace

Totals totals_of(const std::vector<CaseResult>& results) {
  Totals totals;
  for (const CaseResult& result : results) {
    ++totals.cases;
    if (!result.error.empty()) {
      ++totals.unreadable;
      continue;
    }
    for (std::size_t i = 0; i < result.runs.front().quantities.size(); ++i) {
      const Verdict verdict = overall(result, i);
      totals.pass += verdict == Verdict::kPass;
      totals.fail += verdict == Verdict::kFail;
      totals.not_measured += verdict == Verdict::kNotMeasured;
      totals.orientation += verdict == Verdict::kOrientation;
    }
  }
  return totals;
}

OrderedJson accuracy_json(const std::vector<CaseResult>& results) {
  const Totals t = totals_of(results);
  OrderedJson json{{"schema", "taut-accuracy/1"}, {"taut_version", TAUT_VERSION}};
  json["summary"] = {
      {"cases", t.cases}, {"unreadable", t.unreadable},     {"pass", t.pass},
      {"fail", t.fail},   {"not_measured", t.not_measured}, {"for_orientation", t.orientation}};
  json["cases"] = OrderedJson::array();
  for (const CaseResult& result : results) json["cases"].push_back(case_json(result));
  return json;
}

std::string accuracy_csv(const std::vector<CaseResult>& results) {
  std::string text = "case,level,quantity,time,dt,integrator,error,allowed,verdict,reason\n";
  for (const CaseResult& result : results) {
    if (!result.error.empty())
      text += csv_field(result.file) + ",,,,,,,,unreadable," + csv_field(result.error) + '\n';
    for (const CaseRun& run : result.runs)
      for (const Measurement& m : run.quantities) {
        const bool seen = !m.measured.empty();
        text += csv_field(run.id) + ',' + run.level + ',' + csv_field(m.name) + ',' +
                (m.time ? shortest(*m.time) : "") + ',' + shortest(run.dt) + ',' +
                name_of(run.integrator, kIntegratorNames) + ',' + (seen ? shortest(m.error) : "") + ',' +
                (seen ? shortest(m.allowed) : "") + ',' + to_string(m.verdict) + ',' + csv_field(m.reason) +
                '\n';
      }
  }
  return text;
}

std::string accuracy_table(const CaseResult& result, bool summary) {
  if (!result.error.empty()) return result.file + ": cannot be read: " + result.error + '\n';
  std::string text = heading(result);
  for (const CaseRun& run : result.runs)
    if (!run.failed.empty()) text += format("  at dt %g: ", run.dt) + run.failed + '\n';
  const std::vector<Measurement>& first = result.runs.front().quantities;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (summary && overall(result, i) != Verdict::kFail) continue;
    text += format("  %-44s", label(first[i]).c_str());
    if (first[i].measured.empty() && overall(result, i) == Verdict::kNotMeasured) {
      text += "  " + cell(first[i]) + '\n';
      continue;
    }
    for (const CaseRun& run : result.runs) text += "  " + cell(run.quantities[i]);
    text += '\n';
  }
  return text;
}

std::string accuracy_totals(const Totals& t) {
  return format("%d cases: %d quantities pass, %d fail, %d not measured, %d for orientation only", t.cases,
                t.pass, t.fail, t.not_measured, t.orientation) +
         (t.unreadable > 0 ? format("; %d files cannot be read", t.unreadable) : "") + '\n';
}

}  // namespace taut::reference
