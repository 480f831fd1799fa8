#include "scenes/program/bench_command.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>

#include "core/base/check.h"
#include "scenes/bench/bench_plan.h"
#include "scenes/bench/bench_report.h"
#include "scenes/bench/work_report.h"
#include "scenes/files/scene_file.h"
#include "scenes/program/bench_friction.h"
#include "scenes/program/run_command.h"
#include "scenes/recording/recorder.h"
#include "scenes/support/child_process.h"
#include "scenes/support/file_ending.h"
#include "scenes/support/gnuplot.h"
#include "scenes/support/output_file.h"
#include "scenes/support/program_path.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

/// Wall time that a run gets beyond its processor time before it is killed, as a factor and in all [s].
constexpr double kPatience = 4, kStartUp = 30;

const std::vector<std::string> kEngines = {"taut", "ode", "bullet", "mujoco", "simbody", "dart", "siconos"};

std::vector<fs::path> benchmarks_in(const fs::path& folder, const std::string& only) {
  std::vector<fs::path> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with("_benchmark") && name.find(only) != std::string::npos) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// One run in its own process, as JSON whatever becomes of it.
OrderedJson measure(const fs::path& folder, const BenchRun& run) {
  std::vector<std::string> arguments = {"--scene",  run.scene,           "--n",    std::to_string(run.n),
                                        "--method", run.method,          "--rate", shortest(run.rate),
                                        "--limit",  shortest(run.limit), "--time", shortest(run.time)};
  if (!run.with.empty()) arguments.insert(arguments.end(), {"--with", run.with});
  const ChildResult child =
      run_child(folder / ("peer_" + run.engine), arguments, true, kStartUp + kPatience * run.limit);
  // Some engines print while they build.
  const std::size_t line = child.output.rfind("\n{");
  OrderedJson json = OrderedJson::parse(line == std::string::npos ? child.output : child.output.substr(line),
                                        nullptr, false);
  if (!child.good() || json.is_discarded()) {
    json = {{"engine", run.engine}, {"method", run.method},      {"scene", run.scene},
            {"n", run.n},           {"with", run.with},          {"rate_hz", run.rate},
            {"status", "died"},     {"message", child.message()}};
    if (child.good()) json["message"] = "wrote nothing that can be read";
  }
  json["engine"] = run.engine;
  json["quality"] = name_of(run.quality);
  return json;
}

std::optional<Vec3> probe_of(const OrderedJson& run) {
  if (!run.contains("probe") || !run.at("probe").is_array()) return std::nullopt;
  const OrderedJson& p = run.at("probe");
  return Vec3(p.at(0).get<double>(), p.at(1).get<double>(), p.at(2).get<double>());
}

/// Distances from the converged probes, one run of which is made for each scene.
class References {
 public:
  explicit References(fs::path folder) : folder_(std::move(folder)) {}
  void add_distance(const BenchRun& run, OrderedJson& json) {
    const std::optional<Vec3> probe = probe_of(json);
    if (!probe || run.quality != BenchQuality::kJoints) return;
    const auto [found, fresh] = probes_.try_emplace(run.scene_label());
    if (fresh) {
      const OrderedJson reference = measure(folder_, reference_of(run));
      if (reference.value("status", "") == "success") found->second = probe_of(reference);
    }
    if (found->second) json["probe_distance_m"] = (*probe - *found->second).norm();
  }

 private:
  fs::path folder_;
  std::map<std::string, std::optional<Vec3>> probes_;
};

void show(const BenchRun& run, const OrderedJson& json, std::size_t index, std::size_t count) {
  char numbers[100] = "";
  if (json.contains("cpu_per_simulated_s") && json.contains("max_joint_error_m"))
    std::snprintf(numbers, sizeof numbers, "%9.3g s/s, joint %.0e, drift %.0e",
                  json.at("cpu_per_simulated_s").get<double>(), json.at("max_joint_error_m").get<double>(),
                  json.at("energy_drift_rel").get<double>());
  std::fprintf(stderr, "[%3zu/%zu] %-24s %-36s %s %s\n", index, count, run.scene_label().c_str(),
               run.engine_label().c_str(), json.value("status", "").c_str(), numbers);
}

/// What work_profile prints, or `otherwise` with why it printed nothing.
OrderedJson ask(const fs::path& program, const std::vector<std::string>& arguments, OrderedJson otherwise) {
  constexpr double kLongest = 300;  // [s]
  const ChildResult child = run_child(program, arguments, true, kLongest);
  OrderedJson json = OrderedJson::parse(child.output, nullptr, false);
  if (child.good() && json.is_object()) return json;
  otherwise["failed"] = "no result: " + child.message();
  return otherwise;
}

/// What work_profile says of one scene.
OrderedJson profile(const fs::path& program, const WorkRun& run, const BenchOptions& options) {
  std::vector<std::string> arguments{"--scene", run.scene, "--n", std::to_string(run.n)};
  if (!run.with.empty()) arguments.insert(arguments.end(), {"--with", run.with});
  if (options.quick) arguments.insert(arguments.end(), {"--time", "0.05", "--limit", "1"});
  if (options.limit > 0) arguments.insert(arguments.end(), {"--limit", shortest(options.limit)});
  return ask(program, arguments, {{"scene", run.scene}, {"n", run.n}, {"with", run.with}});
}

/// A step by each method, of chains of more and more links.
void add_methods(const fs::path& program, const BenchOptions& options, BenchResults& results) {
  results["methods"] = OrderedJson::array();
  for (const int n : method_sizes(options.quick))
    results["methods"].push_back(ask(
        program,
        {"--methods", "--scene", "chain", "--n", std::to_string(n), "--limit", options.quick ? "0.1" : "1"},
        {{"scene", "chain"}, {"n", n}}));
}

/// @param keep is called with the results so far
template <typename Keep>
void add_profiles(const fs::path& program, const std::vector<WorkRun>& plan, const BenchOptions& options,
                  BenchResults& results, Keep keep) {
  results["profiles"] = OrderedJson::array();
  for (std::size_t i = 0; i < plan.size(); ++i) {
    results["profiles"].push_back(profile(program, plan[i], options));
    const OrderedJson& last = results["profiles"].back();
    std::fprintf(stderr, "[%2zu/%zu] %-24s %s\n", i + 1, plan.size(), plan[i].label().c_str(),
                 last.contains("failed") ? last.at("failed").get<std::string>().c_str() : "done");
    keep();
  }
}

void write(const fs::path& file, const std::string& text) {
  if (const std::string error = write_output(file.string(), text); !error.empty())
    fail("--results", "cannot write the file", error);
}

std::string command_of(const BenchOptions& options) {
  return std::string("taut bench") + (options.quick ? " --quick" : "") + (options.work ? " --work" : "") +
         (options.contact ? " --contact" : "") + (options.friction ? " --friction" : "") +
         (options.only.empty() ? "" : " --only '" + options.only + "'") +
         (options.limit > 0 ? " --limit " + shortest(options.limit) : "");
}

std::string name_of(const BenchOptions& options) {
  const std::string what = options.work ? "work" : options.contact ? "contact" : "";
  if (what.empty()) return options.quick ? "quick" : "engines";
  return (options.quick ? "quick-" : "") + what;
}

void write_results(const BenchResults& results, const BenchOptions& options, const fs::path& folder) {
  const std::string name = name_of(options);
  fs::create_directories(folder);
  write(folder / (name + ".json"), results.dump(1) + '\n');
  write(folder / (name + ".md"), bench_page(results, command_of(options)));
}

/// Pictures, if gnuplot is there.
void draw_results(const BenchResults& results, const BenchOptions& options, const fs::path& folder) {
  const std::string name = name_of(options);
  fs::create_directories(folder / name);
  draw(bench_plots(results, (folder / name).string()), "taut bench");
  std::cerr << "taut bench: " << (folder / (name + ".md")).string() << '\n';
}

/// Runs that look worse than those of `then` are made again, and of each the fastest counts: a busy machine
/// can double a time, a slower program stays slow.  @returns whether there were any.
bool repeat_worse(const fs::path& peers, const std::vector<BenchRun>& plan, const BenchResults& then,
                  double factor, References& references, BenchResults& results) {
  constexpr int kRepeats = 5;
  bool any = false;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const std::vector<std::size_t> worse = compare_bench(results, then, factor).worse;
    if (worse.empty()) break;
    any = true;
    std::fprintf(stderr, "taut bench: %zu runs look worse and are made again\n", worse.size());
    for (const std::size_t i : worse) {
      OrderedJson again = measure(peers, plan[i]);
      references.add_distance(plan[i], again);
      show(plan[i], again, i + 1, plan.size());
      if (is_better_measurement(again, results["runs"][i])) results["runs"][i] = std::move(again);
    }
  }
  return any;
}

/// What the options leave of the plan.
std::vector<BenchRun> wanted_runs(const BenchOptions& options, const std::vector<std::string>& engines) {
  std::vector<BenchRun> plan = bench_plan(options.quick, engines);
  std::erase_if(plan, [&](const BenchRun& r) {
    return r.scene_label().find(options.only) == std::string::npos ||
           (options.contact && r.quality == BenchQuality::kJoints);
  });
  if (plan.empty()) fail("--only", "is in the name of no scene or program", options.only);
  if (options.limit > 0)
    for (BenchRun& run : plan) run.limit = options.limit;
  return plan;
}

/// Results are written after each scene, so that a run that is stopped leaves what it has.
BenchResults run_plan(const fs::path& folder, const BenchOptions& options, const fs::path& out,
                      const std::optional<BenchResults>& then) {
  BenchResults results{
      {"schema", kBenchSchema}, {"machine", machine_description()}, {"quick", options.quick}};
  std::vector<std::string> built;
  for (const std::string& engine : kEngines) {
    const bool there = fs::exists(folder / "peers" / ("peer_" + engine));
    results["engines"][engine] = there;
    if (there) built.push_back(engine);
  }
  const std::vector<BenchRun> plan = wanted_runs(options, built);
  results["planned_runs"] = plan.size();
  std::fprintf(stderr, "taut bench: %zu runs, %.0f minutes at most; engines:", plan.size(),
               longest_time(plan) / 60);
  for (const std::string& engine : built) std::fprintf(stderr, " %s", engine.c_str());
  std::fprintf(stderr, "\n");
  References references(folder / "peers");
  results["runs"] = OrderedJson::array();
  results["profiles"] = OrderedJson::array();
  if (options.only.empty() && !options.contact)
    add_profiles(folder / "work_profile", work_plan(options.quick ? WorkSizes::kTwo : WorkSizes::kSome),
                 options, results, [] {});
  for (std::size_t i = 0; i < plan.size(); ++i) {
    OrderedJson json = measure(folder / "peers", plan[i]);
    references.add_distance(plan[i], json);
    show(plan[i], json, i + 1, plan.size());
    results["runs"].push_back(std::move(json));
    if (i + 1 == plan.size() || plan[i + 1].scene_label() != plan[i].scene_label())
      write_results(results, options, out);
  }
  if (then && repeat_worse(folder / "peers", plan, *then, options.factor, references, results))
    write_results(results, options, out);
  return results;
}

/// An earlier result to compare with; nothing if none is asked for.
std::optional<BenchResults> earlier_results(const std::string& file) {
  if (file.empty()) return std::nullopt;
  BenchResults then = BenchResults::parse(read_text_file(file), nullptr, false);
  if (!then.is_object() || then.value("schema", "") != kBenchSchema || !then.contains("runs") ||
      !then.at("runs").is_array())
    fail("--compare", std::string("is no result of taut bench, ") + kBenchSchema, file);
  return then;
}

fs::path results_folder(const BenchOptions& options, const fs::path& build) {
  return options.results.empty() ? build / "bench" : fs::path(options.results);
}

/// taut alone.  @returns how many scenes failed.
int run_work(const fs::path& folder, const fs::path& build, const BenchOptions& options) {
  if (!options.compare.empty()) fail("--compare", "is not for --work", options.compare);
  if (!options.arguments.empty()) fail("--work", "takes no arguments of programs", options.arguments.front());
  const fs::path program = folder / "work_profile";
  if (!fs::exists(program)) {
    std::cerr << "taut bench: no work_profile in " << folder.string() << "; `./taut bench` builds it\n";
    return 1;
  }
  std::vector<WorkRun> plan = work_plan(options.quick ? WorkSizes::kTwo : WorkSizes::kAll);
  std::erase_if(plan, [&](const WorkRun& r) { return r.label().find(options.only) == std::string::npos; });
  if (plan.empty()) fail("--only", "is in the name of no scene", options.only);
  BenchResults results{
      {"schema", kBenchSchema}, {"machine", machine_description()}, {"quick", options.quick}};
  results["engines"] = {{"taut", true}};
  results["planned_runs"] = 0;
  results["runs"] = OrderedJson::array();
  const fs::path out = results_folder(options, build);
  fs::create_directories(out);
  add_profiles(program, plan, options, results, [&] { write_results(results, options, out); });
  if (options.only.empty()) {
    add_methods(program, options, results);
    write_results(results, options, out);
  }
  std::cout << work_tables(results);
  int bad = 0;
  for (const char* kind : {"profiles", "methods"})
    for (const OrderedJson& p : results.value(kind, OrderedJson::array())) bad += p.contains("failed");
  return bad;
}

/// @returns how many runs of taut failed or became slower.
int run_engines(const fs::path& folder, const fs::path& build, const BenchOptions& options,
                const std::optional<BenchResults>& then) {
  const fs::path out = results_folder(options, build);
  const BenchResults results = run_plan(folder, options, out, then);
  draw_results(results, options, out);
  int bad = 0;
  for (const OrderedJson& run : results.at("runs")) {
    const std::string status = run.value("status", "");
    bad += run.at("engine") == "taut" && status != "success" && status != "time limit";
  }
  if (!then) return bad;
  const BenchComparison comparison = compare_bench(results, *then, options.factor);
  std::cout << comparison.text;
  return bad + static_cast<int>(comparison.worse.size()) + (comparison.compared == 0);
}

/// @returns how many failed.
int run_programs(const std::vector<fs::path>& programs, const std::vector<std::string>& arguments) {
  int failed = 0;
  for (const fs::path& program : programs) {
    std::cerr << "== " << program.filename().string() << '\n';
    if (run_child(program, arguments).good()) continue;
    std::cerr << "taut bench: " << program.filename().string() << " failed\n";
    ++failed;
  }
  return failed;
}

/// @returns how many failed or became slower; 1 if nothing is there that could be run.
int run_scenes_and_programs(const fs::path& folder, const fs::path& build, const BenchOptions& options,
                            const std::optional<BenchResults>& then) {
  const bool engines_only = options.quick || options.contact || !options.compare.empty();
  const std::vector<fs::path> programs =
      engines_only ? std::vector<fs::path>{} : benchmarks_in(folder, options.only);
  if (engines_only && !options.arguments.empty())
    fail("--quick, --contact and --compare", "run no programs that take", options.arguments.front());
  // A name of a program asks for no scenes.
  const bool scenes = options.arguments.empty() && (options.only.empty() || programs.empty());
  if (programs.empty() && !fs::exists(folder / "peers" / "peer_taut")) {
    std::cerr << "taut bench: no benchmark" << (options.only.empty() ? "" : " named like " + options.only)
              << " in " << folder.string() << "; `./taut bench` builds them\n";
    return 1;
  }
  const int bad = scenes ? run_engines(folder, build, options, then) : 0;
  return bad + run_programs(programs, options.arguments);
}

void check_bench_options(const BenchOptions& options) {
  if (!(options.factor > 0)) fail("--factor", "must be positive", options.factor);
  if (!(options.limit >= 0)) fail("--limit", "must not be negative", options.limit);
  require_folder_name("--results", options.results);
  require_writable_folder("--results", options.results);
  if (options.work && options.contact) fail("--work", "is of joints alone, so not for", "--contact");
  if (options.friction && (options.work || options.contact))
    fail("--friction", "is of problems without scenes, so not for", options.work ? "--work" : "--contact");
}

}  // namespace

int bench_command(const BenchOptions& options) {
  check_bench_options(options);
  const std::optional<BenchResults> then = earlier_results(options.compare);
  const fs::path build =
      options.build_dir.empty() ? program_path().parent_path() : fs::path(options.build_dir);
  const fs::path folder = build / "benchmarks";
  int bad = 0;
  if (options.friction)
    bad = bench_friction(options, folder / "peers", results_folder(options, build), command_of(options));
  else if (options.work)
    bad = run_work(folder, build, options);
  else
    bad = run_scenes_and_programs(folder, build, options, then);
  return bad == 0 ? kExitSuccess : kExitFailure;
}

}  // namespace taut
