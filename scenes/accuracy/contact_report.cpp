#include "scenes/accuracy/contact_report.h"

#include <algorithm>
#include <cmath>

#include "scenes/recording/recorder.h"
#include "scenes/support/format.h"

namespace taut::reference {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// null for what is not a number, which JSON does not have.
OrderedJson number(double x) { return std::isfinite(x) ? OrderedJson(x) : OrderedJson(nullptr); }

/// Truths of 0 are errors; others are read digit by digit.
std::string measured_text(const Truth& truth, double measured) {
  if (std::isnan(measured)) return "not measured";
  return format(truth.value == 0 && truth.comparison != Comparison::kConverges ? "%.2g" : "%.9g", measured);
}

std::string truth_text(const Truth& truth) {
  if (truth.comparison == Comparison::kConverges) return truth.source;
  const std::string value =
      format("%s%.9g", truth.comparison == Comparison::kAtMost ? "at most " : "", truth.value);
  return value == truth.source ? value : value + " (" + truth.source + ")";
}

/// what | truth | measured at each step | allowed | order
std::string row_text(const TruthResult& row, const std::vector<double>& steps) {
  const Truth& truth = row.truth;
  std::string text =
      format("  %-4s  ", to_string(row.verdict)) + truth.what + " | " + truth_text(truth) + " | ";
  for (std::size_t i = 0; i < steps.size(); ++i)
    text += (i == 0 ? "" : " / ") + measured_text(truth, row.measured[i]);
  text += format(" | within %.2g", row.allowed.front());
  if (truth.power > 0) text += format(" ... %.2g", row.allowed.back());
  if (row.order > 0 && (truth.power > 0 || truth.order > 0)) text += format(" | order %.2f", row.order);
  if (truth.order > 0) text += format(" (at least %.2g)", truth.order);
  if (!row.note.empty()) text += " | " + row.note;
  return text + '\n';
}

std::string case_heading(const ContactResult& result) {
  std::string text = result.name + ": " + result.what + "; measured at";
  for (std::size_t i = 0; i < result.steps.size(); ++i)
    text += format("%s %g", i == 0 ? "" : " /", 1e3 * result.steps[i]);
  text += format(" ms (%.1f s)\n", result.wall_time);
  for (std::size_t i = 0; i < result.laws.size(); ++i)
    if (!result.laws[i].failed.empty())
      text += format("  FAIL  at %g ms: ", 1e3 * result.steps[i]) + result.laws[i].failed + '\n';
  return text;
}

std::string case_text(const ContactResult& result, bool failed_only) {
  std::string text = case_heading(result);
  for (const TruthResult& row : result.truths)
    if (!failed_only || row.verdict == Verdict::kFail) text += row_text(row, result.steps);
  return text;
}

std::string case_line(const ContactResult& result) {
  const auto passed = std::count_if(result.truths.begin(), result.truths.end(),
                                    [](const TruthResult& row) { return row.verdict == Verdict::kPass; });
  return format("%-4s  %-16s %3d of %d rows pass  %6.1f s  ", result.good() ? "pass" : "FAIL",
                result.name.c_str(), static_cast<int>(passed), static_cast<int>(result.truths.size()),
                result.wall_time) +
         result.what + '\n';
}

OrderedJson row_json(const TruthResult& row, const std::vector<double>& steps) {
  OrderedJson json{{"what", row.truth.what},
                   {"source", row.truth.source},
                   {"truth", row.truth.value},
                   {"verdict", to_string(row.verdict)},
                   {"order", number(row.order)}};
  if (row.truth.comparison == Comparison::kConverges) json["truth"] = nullptr;
  if (row.truth.order > 0) json["order_at_least"] = row.truth.order;
  for (std::size_t i = 0; i < steps.size(); ++i)
    json["results"].push_back({{"dt", steps[i]},
                               {"measured", number(row.measured[i])},
                               {"error", number(row.error[i])},
                               {"allowed", row.allowed[i]}});
  return json;
}

OrderedJson law_json(const LawRecord& law, double dt) {
  const auto worst = [](const WorstStep& step) {
    return OrderedJson{{"work", number(step.work)}, {"time", step.time}};
  };
  OrderedJson json{{"dt", dt},
                   {"steps", law.steps},
                   {"inexact", law.inexact},
                   {"most_from_contacts", worst(law.contacts)},
                   {"most_from_contacts_and_friction", worst(law.with_friction)}};
  if (!law.failed.empty()) json["failed"] = law.failed;
  return json;
}

}  // namespace

TruthTotals totals_of(const std::vector<ContactResult>& results) {
  TruthTotals totals;
  for (const ContactResult& result : results) {
    ++totals.cases;
    for (const TruthResult& row : result.truths) {
      totals.pass += row.verdict == Verdict::kPass;
      totals.fail += row.verdict != Verdict::kPass;
    }
  }
  return totals;
}

std::string contact_table(const std::vector<ContactResult>& results, bool summary) {
  std::string missed, all;
  for (const ContactResult& result : results) {
    if (!result.good()) missed += case_text(result, true);
    all += summary ? case_line(result) : case_text(result, false);
  }
  const TruthTotals totals = totals_of(results);
  std::string text =
      missed.empty() ? "No row misses its truth.\n" : "Rows that miss their truth:\n\n" + missed;
  text += "\nAll cases:\n\n" + all;
  return text + format("\n%d cases: %d rows pass, %d fail\n", totals.cases, totals.pass, totals.fail);
}

OrderedJson contact_json(const std::vector<ContactResult>& results) {
  const TruthTotals t = totals_of(results);
  OrderedJson json{{"schema", "taut-accuracy-contacts/1"}, {"taut_version", TAUT_VERSION}};
  json["summary"] = {{"cases", t.cases}, {"pass", t.pass}, {"fail", t.fail}};
  json["cases"] = OrderedJson::array();
  for (const ContactResult& result : results) {
    OrderedJson item{{"name", result.name}, {"what", result.what}, {"wall_time_s", result.wall_time}};
    for (const TruthResult& row : result.truths) item["rows"].push_back(row_json(row, result.steps));
    for (std::size_t i = 0; i < result.laws.size(); ++i)
      item["runs"].push_back(law_json(result.laws[i], result.steps[i]));
    json["cases"].push_back(std::move(item));
  }
  return json;
}

std::string contact_csv(const std::vector<ContactResult>& results) {
  std::string text = "case,what,dt,truth,measured,error,allowed,order,verdict\n";
  for (const ContactResult& result : results)
    for (const TruthResult& row : result.truths)
      for (std::size_t i = 0; i < result.steps.size(); ++i)
        text += result.name + ',' + csv_field(row.truth.what) +
                format(",%g,%.17g,%.17g,%.9g,%.9g,%.4g,%s\n", result.steps[i], row.truth.value,
                       row.measured[i], row.error[i], row.allowed[i], row.order, to_string(row.verdict));
  return text;
}

}  // namespace taut::reference
