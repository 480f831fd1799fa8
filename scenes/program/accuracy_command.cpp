#include "scenes/program/accuracy_command.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <thread>

#include "core/base/check.h"
#include "scenes/accuracy/accuracy_report.h"
#include "scenes/accuracy/convergence_study.h"
#include "scenes/accuracy/energy_study.h"
#include "scenes/accuracy/method_study.h"
#include "scenes/program/run_command.h"
#include "scenes/support/gnuplot.h"
#include "scenes/support/output_file.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using reference::CaseResult;

/// tests/references in the folder of the program or one above it.
fs::path default_references() {
  for (fs::path above = fs::read_symlink("/proc/self/exe").parent_path(); above != above.root_path();
       above = above.parent_path())
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

/// All files on several threads; prints tables in the order of the files.
std::vector<CaseResult> run_all(const std::vector<fs::path>& files, const AccuracyOptions& options,
                                bool print) {
  std::vector<CaseResult> results(files.size());
  std::vector<char> done(files.size());
  std::atomic<std::size_t> next{0};
  std::size_t printed = 0;
  std::mutex printing;
  const reference::RunPlan plan = plan_of(options);
  const auto work = [&] {
    for (std::size_t i = next++; i < files.size(); i = next++) {
      results[i] = result_of(files[i], plan);
      const std::lock_guard lock(printing);
      done[i] = 1;
      for (; printed < files.size() && done[printed]; ++printed)
        if (print) std::cout << accuracy_table(results[printed], options.summary) << std::flush;
    }
  };
  const int jobs = options.jobs > 0 ? options.jobs : std::max(1, int(std::thread::hardware_concurrency()));
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

}  // namespace

int accuracy_command(const AccuracyOptions& options) {
  const fs::path folder = options.references.empty() ? default_references() : fs::path(options.references);
  if (!options.study.empty()) return study_command(folder, options.study);
  if (options.jobs < 0) fail("--jobs", "must not be negative", options.jobs);
  std::vector<fs::path> files = reference::case_files(folder);
  if (files.empty()) fail("--references", "has no case files", folder.string());
  std::erase_if(files,
                [&](const fs::path& f) { return f.stem().string().find(options.only) == std::string::npos; });
  if (files.empty()) fail("--only", "is in the name of no case", options.only);
  if (options.json == "-" && options.csv == "-") fail("--json and --csv", "cannot both go to", "-");
  require_distinct({{"--json", options.json.value_or("")}, {"--csv", options.csv.value_or("")}}, {});
  if (options.json && *options.json != "-") require_writable("--json", *options.json);
  if (options.csv && *options.csv != "-") require_writable("--csv", *options.csv);
  const bool print = options.json != "-" && options.csv != "-";
  const std::vector<CaseResult> results = run_all(files, options, print);
  const reference::Totals totals = totals_of(results);
  if (print) std::cout << '\n' << accuracy_totals(totals);
  bool written = write(options.json, options.json ? accuracy_json(results).dump(2) + '\n' : "");
  written = write(options.csv, options.csv ? accuracy_csv(results) : "") && written;
  const bool good = totals.fail == 0 && totals.unreadable == 0 && totals.pass > 0;
  return good && written ? kExitSuccess : kExitFailure;
}

}  // namespace taut
