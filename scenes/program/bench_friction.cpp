#include "scenes/program/bench_friction.h"

#include <cmath>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <vector>

#include "core/base/check.h"
#include "scenes/bench/friction_report.h"
#include "scenes/recording/recorder.h"
#include "scenes/support/child_process.h"
#include "scenes/support/gnuplot.h"
#include "scenes/support/output_file.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

/// Random stages among the problems; with --quick.
constexpr const char *kStages = "80", *kFewStages = "8";
/// Processor time of a run [s]; with --quick.  Wall time that it gets beyond, as a factor and in all.
constexpr double kFrictionLimit = 20, kQuickFrictionLimit = 1, kWallFactor = 4, kWallStart = 30;

std::vector<std::string> problems_of(const BenchOptions& options, const fs::path& peers) {
  const ChildResult listed =
      run_child(peers / "peer_friction_taut", {"--list", options.quick ? kFewStages : kStages}, true);
  if (!listed.good()) fail("--friction", "needs peer_friction_taut, which said", listed.message());
  std::vector<std::string> names, chosen;
  std::istringstream lines(listed.output);
  for (std::string name; std::getline(lines, name);) names.push_back(name);
  names.insert(names.end(), options.arguments.begin(), options.arguments.end());
  for (const std::string& name : names)
    if (name.find(options.only) != std::string::npos) chosen.push_back(name);
  if (chosen.empty()) fail("--only", "is in the name of no problem", options.only);
  return chosen;
}

/// The last line that the run has printed: whoever was ended at the limit has left those before.
OrderedJson measure_friction(const fs::path& program, const FrictionRun& run, const std::string& problem,
                             double limit) {
  const ChildResult child = run_child(
      program,
      {"--problem", problem, "--method", run.method, "--start", run.start, "--limit", shortest(limit)}, true,
      kWallStart + kWallFactor * limit);
  OrderedJson last{{"problem", problem},
                   {"solver", run.peer},
                   {"method", run.method},
                   {"start", run.start},
                   {"status", "time limit"}};
  if (child.end == ChildResult::End::kExited && child.code != 0) last["status"] = "died";
  std::istringstream lines(child.output);
  for (std::string line; std::getline(lines, line);)
    if (const OrderedJson json = OrderedJson::parse(line, nullptr, false); json.is_object()) last = json;
  if (!child.good()) last["message"] = child.message();
  return last;
}

void write_friction(const BenchResults& results, const fs::path& out, const std::string& command) {
  fs::create_directories(out / "friction");
  for (const auto& [name, text] : {std::pair{"friction.json", results.dump(1) + '\n'},
                                   std::pair{"friction.md", friction_page(results, command)}})
    if (const std::string error = write_output((out / name).string(), text); !error.empty())
      fail("--results", "cannot write the file", error);
}

}  // namespace

int bench_friction(const BenchOptions& options, const fs::path& peers, const fs::path& out,
                   const std::string& command) {
  if (!options.compare.empty()) fail("--compare", "is not for --friction", options.compare);
  const std::vector<std::string> problems = problems_of(options, peers);
  const double limit = options.limit > 0 ? options.limit
                       : options.quick   ? kQuickFrictionLimit
                                         : kFrictionLimit;
  BenchResults results{{"schema", "taut-bench-friction/1"},
                       {"machine", machine_description()},
                       {"limit_s", limit},
                       {"runs", OrderedJson::array()}};
  int unsolved = 0;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    for (const FrictionRun& run : friction_plan()) {
      const fs::path program = peers / ("peer_friction_" + run.peer);
      if (!fs::exists(program)) continue;
      OrderedJson json = measure_friction(program, run, problems[i], limit);
      const std::string status = json.value("status", "");
      std::fprintf(stderr, "[%3zu/%zu] %-40s %-14s %-11s %9.3g ms\n", i + 1, problems.size(),
                   fs::path(problems[i]).filename().c_str(), run.label().c_str(), status.c_str(),
                   1e3 * json.value("seconds", NAN));
      unsolved += run.peer == "taut" && run.start == "cold" && status != "solved" && status != "no solution";
      json["problem"] = fs::path(problems[i]).filename().string();
      results["runs"].push_back(std::move(json));
    }
    write_friction(results, out, command);
  }
  draw(friction_plots(results, (out / "friction").string()), "taut bench");
  std::cout << friction_losses(results);
  std::cerr << "taut bench: " << (out / "friction.md").string() << '\n';
  return unsolved;
}

}  // namespace taut
