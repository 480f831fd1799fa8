#include "scenes/program/accuracy_command.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <mutex>
#include <thread>

#include "core/base/check.h"
#include "scenes/accuracy/accuracy_report.h"
#include "scenes/accuracy/contact_report.h"
#include "scenes/accuracy/convergence_study.h"
#include "scenes/accuracy/energy_study.h"
#include "scenes/accuracy/method_study.h"
#include "scenes/program/run_command.h"
#include "scenes/support/file_ending.h"
#include "scenes/support/gnuplot.h"
#include "scenes/support/output_file.h"
#include "scenes/support/program_path.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using reference::CaseResult;

/// tests/references in the folder of the program or one above it.
fs::path default_references() {
  for (fs::path above = program_path().parent_path(); above != above.root_path(); above = above.parent_path())
    if (fs::is_directory(above / "tests" / "references")) return above / "tests" / "references";
  fail("--references", "is needed: there is no tests/references above the program", "");
}

reference::RunPlan plan_of(const AccuracyOptions& options) {
  reference::RunPlan plan;
  if (options.integrator) {
    plan.choose_integrator = false;
    plan.settings.integrator = *options.integrator;
  }
  if (options.factor) plan.settings.factor = *options.factor;
  return plan;
}

/// A run in which a step fails is made again with a tenth of the step, with tolerances for that.
reference::CaseRun run_at(const fs::path& file, reference::RunPlan plan, double fraction) {
  plan.step = fraction;
  reference::CaseRun run = run_case(file, plan);
  if (run.failed.empty()) return run;
  plan.step = 0.1 * fraction;
  reference::CaseRun finer = run_case(file, plan);
  return finer.failed.empty() ? finer : run;
}

CaseResult result_of(const fs::path& file, const reference::RunPlan& plan) {
  CaseResult result{.file = file.filename().string(), .error = {}, .runs = {}};
  try {
    for (double fraction : {1.0, 0.5}) result.runs.push_back(run_at(file, plan, fraction));
  } catch (const std::exception& error) {
    result.error = error.what();
    result.runs.clear();
  }
  return result;
}

/// run(item) of all items on several threads; tell(result) in the order of the items, as they are done.
template <typename Result, typename Item>
std::vector<Result> run_all(const std::vector<Item>& items, int wanted_jobs,
                            const std::function<Result(const Item&)>& run,
                            const std::function<void(const Result&)>& tell) {
  std::vector<Result> results(items.size());
  std::vector<char> done(items.size());
  std::atomic<std::size_t> next{0};
  std::size_t told = 0;
  std::mutex telling;
  const auto work = [&] {
    for (std::size_t i = next++; i < items.size(); i = next++) {
      results[i] = run(items[i]);
      const std::lock_guard lock(telling);
      done[i] = 1;
      for (; told < items.size() && done[told]; ++told) tell(results[told]);
    }
  };
  const int jobs = wanted_jobs > 0 ? wanted_jobs : std::max(1, int(std::thread::hardware_concurrency()));
  std::vector<std::thread> others;
  for (int i = 1; i < jobs; ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  return results;
}

/// @returns false, with a message, if the file cannot be written.
bool write(const std::optional<std::string>& file, const std::string& text) {
  if (!file) return true;
  if (*file == "-") return static_cast<bool>(std::cout << text << std::flush);
  const std::string error = write_output(*file, text);
  if (!error.empty()) std::cerr << "taut accuracy: could not write " << error << '\n';
  return error.empty();
}

/// Mechanisms of the convergence study.
const std::vector<std::string> kStudied = {"pendulum_simple_90", "pendulum_spherical",
                                           "double_pendulum_regular", "heavy_top_geradin_cardona",
                                           "slider_crank_free"};
constexpr double kStudyStep = 1e-3, kStudyTime = 5;
constexpr long kEnergySteps = 1'000'000;

/// What --study asks for.
int study_command(const fs::path& references, const fs::path& folder) {
  require_folder_name("--study", folder.string());
  require_writable_folder("--study", folder.string());
  fs::create_directories(folder);
  const std::vector<ConvergenceRun> convergence = run_convergence(references, kStudied);
  const std::vector<MethodRun> methods = run_methods(kStudyStep, kStudyTime);
  const std::vector<EnergyRun> energy = run_energy(kEnergySteps, kStudyStep);
  const std::string tables =
      "# Convergence\n\nLargest position error [m] against the reference; tension divides no step, but one "
      "that Newton cannot close is. The iterative solvers make RATTLE's steps with 100 sweeps.\n\n" +
      convergence_table(convergence) +
      "\n# Methods\n\nSteps of 1 ms for 5 s; errors of energy relative to what the mechanism can turn "
      "over.\n\n" +
      methods_table(methods) +
      "\n# Energy\n\nDouble pendulum; errors relative to what it can turn over; drift is the slope of the "
      "best line times the time of the run. The picture has range and mean of 500 equal parts of the "
      "run.\n\n" +
      energy_table(energy);
  std::cout << tables << std::flush;
  bool good = write((folder / "study.md").string(), tables);
  good = write((folder / "convergence.csv").string(), convergence_csv(convergence)) && good;
  good = write((folder / "methods.csv").string(), methods_csv(methods)) && good;
  good = write((folder / "energy.csv").string(), energy_csv(energy)) && good;
  if (!good) return kExitFailure;
  draw(convergence_plots(convergence, folder.string()) + methods_plots(methods, folder.string()) +
           energy_plots(energy, folder.string()),
       "taut accuracy");
  return kExitSuccess;
}

/// What can be said of the outputs before anything runs.
void check_outputs(const AccuracyOptions& options) {
  if (options.jobs < 0) fail("--jobs", "must not be negative", options.jobs);
  if (options.json == "-" && options.csv == "-") fail("--json and --csv", "cannot both go to", "-");
  require_distinct({{"--json", options.json.value_or("")}, {"--csv", options.csv.value_or("")}}, {});
  if (options.json && *options.json != "-") {
    require_ending("--json", *options.json, FileKind::kJson);
    require_writable("--json", *options.json);
  }
  if (options.csv && *options.csv != "-") {
    require_ending("--csv", *options.csv, FileKind::kTable);
    require_writable("--csv", *options.csv);
  }
}

/// What --contacts asks for.
int contacts_command(const AccuracyOptions& options) {
  using reference::ContactCase, reference::ContactResult;
  std::vector<ContactCase> cases = reference::contact_cases();
  std::erase_if(cases, [&](const ContactCase& c) { return c.name.find(options.only) == std::string::npos; });
  if (cases.empty()) fail("--only", "is in the name of no case", options.only);
  check_outputs(options);
  const std::vector<ContactResult> results = run_all<ContactResult, ContactCase>(
      cases, options.jobs, reference::run_contact_case, [](const ContactResult&) {});
  if (options.json != "-" && options.csv != "-") std::cout << contact_table(results, options.summary);
  bool good = write(options.json, options.json ? contact_json(results).dump(2) + '\n' : "");
  good = write(options.csv, options.csv ? contact_csv(results) : "") && good;
  for (const ContactResult& result : results) good = good && result.good();
  return good ? kExitSuccess : kExitFailure;
}

std::vector<fs::path> wanted_files(const fs::path& folder, const std::string& only) {
  std::vector<fs::path> files = reference::case_files(folder);
  if (files.empty()) fail("--references", "has no case files", folder.string());
  std::erase_if(files, [&](const fs::path& f) { return f.stem().string().find(only) == std::string::npos; });
  if (files.empty()) fail("--only", "is in the name of no case", only);
  return files;
}

}  // namespace

int accuracy_command(const AccuracyOptions& options) {
  if (options.contacts) return contacts_command(options);
  const fs::path folder = options.references.empty() ? default_references() : fs::path(options.references);
  if (!options.study.empty()) return study_command(folder, options.study);
  const std::vector<fs::path> files = wanted_files(folder, options.only);
  check_outputs(options);
  const bool print = options.json != "-" && options.csv != "-";
  const reference::RunPlan plan = plan_of(options);
  const std::vector<CaseResult> results = run_all<CaseResult, fs::path>(
      files, options.jobs, [&](const fs::path& file) { return result_of(file, plan); },
      [&](const CaseResult& result) {
        if (print) std::cout << accuracy_table(result, options.summary) << std::flush;
      });
  const reference::Totals totals = totals_of(results);
  if (print) std::cout << '\n' << accuracy_totals(totals);
  bool written = write(options.json, options.json ? accuracy_json(results).dump(2) + '\n' : "");
  written = write(options.csv, options.csv ? accuracy_csv(results) : "") && written;
  const bool good = totals.fail == 0 && totals.unreadable == 0 && totals.pass > 0;
  return good && written ? kExitSuccess : kExitFailure;
}

}  // namespace taut
