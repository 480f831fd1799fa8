#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>

#include "scenes/files/scene_file.h"
#include "solvers/common/setting_checks.h"
#include "solvers/simulator/simulator.h"
#include "tests/fuzz/mechanism.h"
#include "tests/fuzz/seed_guard.h"

// Random mechanisms by seed, judged from outside:
//   mechanisms --from 0 --count 1000 [--threads 2] [--limit 10] [--seconds S] [--keep FOLDER] [--open
//   ORACLE]... mechanisms --write SEED            its scene file mechanisms --check FILE...         scene
//   files that were written so
// Each is run twice, on one thread, and on --threads and from a checkpoint on halfway, which must give the
// same bits.  Seeds run in a process of their own, a hundred each, so that one that crashes or hangs (a step
// of more than --limit seconds) is a line of the output and not its end.  The exit status is 1 if anything
// was found.

namespace taut::fuzz {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

struct Options {
  SeedRange seeds;
  int threads = 2, limit = 10;
  std::string keep;
  std::set<std::string> open;  ///< oracles whose finds are told, but known and not mended yet
};

/// Shared with the process that runs the seeds.
struct Shared {
  long runs = 0, steps = 0, refused = 0, found = 0, open = 0;
  std::array<std::array<long, 7>, 8> status{};  ///< how the last step ended, by what was asked for
  double longest = 0;                           ///< step [s]
};
Shared* shared = nullptr;

constexpr const char* kAsked[] = {"rattle",    "rattle4, 6, 8",    "force level",      "moreau-jean",
                                  "iterative", "implicit tension", "merged or asleep", "contacts"};

int asked(const Scene& scene) {
  const Settings& s = scene.settings;
  if (s.integrator == Integrator::kMoreauJean) return 3;
  if (is_force_level(s.integrator)) return 2;
  if (s.integrator != Integrator::kRattle) return 1;
  if (s.solver != Solver::kDirect) return 4;
  if (s.tension == TensionPolicy::kImplicit) return 5;
  if (s.merge_fixed_joints || s.sleep) return 6;
  return scene.world.shape_count() > 0 ? 7 : 0;
}

bool same_bits(const State& a, const State& b) {
  if (std::memcmp(&a.time, &b.time, sizeof a.time) != 0 || a.poses.size() != b.poses.size()) return false;
  const auto same = [](const auto& x, const auto& y) {
    return std::memcmp(x.data(), y.data(), sizeof(double) * static_cast<std::size_t>(x.size())) == 0;
  };
  for (std::size_t i = 0; i < a.poses.size(); ++i)
    if (!same(a.poses[i].p, b.poses[i].p) || !same(a.poses[i].q.coeffs(), b.poses[i].q.coeffs()) ||
        !same(a.twists[i].v, b.twists[i].v) || !same(a.twists[i].w, b.twists[i].w))
      return false;
  return true;
}

/// How a run went.
struct Run {
  State end;
  Status status = Status::kSuccess;
  int steps = 0;
  std::optional<Violation> violation;
};

/// One step under the eyes of all.  False if it was the last.
bool step(Run& run, Simulator& simulator, const World& world, double dt, Judge* judge, int limit) {
  const State before = world.state();
  alarm(static_cast<unsigned>(limit));
  const auto start = Clock::now();
  const StepReport& report = simulator.step(dt);
  shared->longest = std::max(shared->longest, std::chrono::duration<double>(Clock::now() - start).count());
  alarm(0);
  run.status = report.status;
  ++run.steps;
  if (report.ok()) {
    if (judge) run.violation = judge->judge(world, report, dt);
    return !run.violation;
  }
  if (!same_bits(before, world.state())) run.violation = {"state", "a step that failed has moved the world"};
  if (report.message.empty()) run.violation = {"message", "a step failed without a word"};
  return false;
}

/// All steps of the scene; before step `resume_at` another world and another simulator go on from a
/// checkpoint's bytes.
Run run(const Scene& original, int threads, Judge* judge, int limit, int resume_at) {
  Run run;
  auto scene = std::make_unique<Scene>(original);
  scene->settings.threads = threads;
  const int steps = static_cast<int>(std::lround(scene->duration / scene->dt));
  try {
    auto simulator = std::make_unique<Simulator>(scene->world, scene->settings);
    if (judge) judge->start(scene->world);
    for (int i = 0; i < steps; ++i) {
      if (i == resume_at) {
        const std::string bytes = simulator->checkpoint().bytes();
        simulator.reset();
        scene = std::make_unique<Scene>(original);
        scene->settings.threads = threads;
        simulator = std::make_unique<Simulator>(scene->world, scene->settings);
        simulator->restore(Checkpoint::from_bytes(bytes));
      }
      if (!step(run, *simulator, scene->world, scene->dt, judge, limit)) break;
    }
  } catch (const std::exception& error) {  // its settings fit the scene: nothing is there to refuse
    alarm(0);
    run.violation = {"exception", error.what()};
  }
  run.end = scene->world.state();
  return run;
}

bool same(const Run& a, const Run& b) {
  return a.status == b.status && a.steps == b.steps && same_bits(a.end, b.end);
}

std::optional<Violation> examine(const Json& json, const std::string& name, const Options& options) {
  std::optional<Scene> scene;
  try {
    scene = parse_scene(json.dump(), name);
  } catch (const SceneFileError& error) {  // a joint that cannot be made where it was drawn
    ++shared->refused;
    if (std::getenv("MECHANISMS_VERBOSE")) std::printf("%s\n", error.what());
    return {};
  }
  Judge judge(json);
  constexpr int kNever = -1;
  const Run first = run(*scene, 1, &judge, options.limit, kNever);
  ++shared->runs, shared->steps += first.steps;
  ++shared->status[asked(*scene)][static_cast<int>(first.status)];
  if (first.violation) return first.violation;
  const Run second = run(*scene, options.threads, nullptr, options.limit, first.steps / 2);
  if (second.violation)
    return Violation{second.violation->oracle, "gone on from a checkpoint: " + second.violation->figures};
  if (same(first, second)) return {};
  const Run straight = run(*scene, options.threads, nullptr, options.limit, kNever);
  if (!same(first, straight))
    return Violation{"bits", "another run on " + std::to_string(options.threads) + " threads ends elsewhere"};
  return Violation{"checkpoint", "gone on from it before step " + std::to_string(first.steps / 2 + 1) +
                                     " of " + std::to_string(first.steps) + ", the run ends elsewhere"};
}

void keep(const Json& json, const std::string& name, const Options& options) {
  if (options.keep.empty()) return;
  std::filesystem::create_directories(options.keep);
  std::ofstream(options.keep + "/" + name + ".json") << json.dump(1) << '\n';
}

void run_seed(std::uint64_t seed, const Options& options) {
  const Json json = make_mechanism(seed);
  std::optional<Violation> bad;
  try {
    bad = examine(json, "seed " + std::to_string(seed), options);
  } catch (const std::exception& error) {
    bad = Violation{"exception", error.what()};
  }
  if (!bad) return;
  const bool known = options.open.contains(bad->oracle);
  ++(known ? shared->open : shared->found);
  std::printf("%s seed %llu: %s: %s\n", known ? "OPEN" : "FOUND", static_cast<unsigned long long>(seed),
              bad->oracle.c_str(), bad->figures.c_str());
  std::fflush(stdout);
  if (!known) keep(json, "seed_" + std::to_string(seed), options);
}

long run_all(Options& options) {
  return run_guarded(options.seeds, {[&](std::uint64_t seed) { run_seed(seed, options); },
                                     [&](std::uint64_t seed, const std::string& how) {
                                       std::printf("FOUND seed %llu: %s\n",
                                                   static_cast<unsigned long long>(seed), how.c_str());
                                       keep(make_mechanism(seed), "seed_" + std::to_string(seed), options);
                                     }});
}

void print_table(const Options& options, double seconds, long crashes) {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  std::printf("\n%-18s %9s %9s %9s %9s %9s %9s\n", "asked for", "success", "inexact", "not conv.", "contrad.",
              "not fin.", "crowded");
  for (std::size_t i = 0; i < std::size(kAsked); ++i)
    std::printf("%-18s %9ld %9ld %9ld %9ld %9ld %9ld\n", kAsked[i], shared->status[i][0],
                shared->status[i][1], shared->status[i][2], shared->status[i][3], shared->status[i][4],
                shared->status[i][6]);
  std::printf(
      "seeds %llu to %llu: %ld mechanisms run, %ld refused, %ld steps, longest %.2g s, %.1f ms a mechanism, "
      "peak memory %ld MB\nfound: %ld violations, %ld crashes and hangs; %ld of what is open\n",
      static_cast<unsigned long long>(options.seeds.from),
      static_cast<unsigned long long>(options.seeds.from + options.seeds.count - 1), shared->runs,
      shared->refused, shared->steps, shared->longest,
      1e3 * seconds / static_cast<double>(options.seeds.count), usage.ru_maxrss / 1024, shared->found,
      crashes, shared->open);
}

int check_files(const std::vector<std::string>& files, const Options& options) {
  int found = 0;
  for (const std::string& file : files) {
    std::ifstream in(file);
    const Json json = Json::parse(in);
    const auto bad = examine(json, file, options);
    std::printf("%s: %s\n", file.c_str(),
                bad ? (bad->oracle + ": " + bad->figures).c_str() : "nothing found");
    if (bad) ++found;
  }
  return found > 0;
}

}  // namespace
}  // namespace taut::fuzz

int main(int argc, char** argv) {
  using namespace taut::fuzz;
  Options options;
  std::vector<std::string> files;
  bool check = false;
  for (int i = 1; i < argc; ++i) {
    const std::string key = argv[i];
    const auto value = [&]() -> std::string { return i + 1 < argc ? argv[++i] : ""; };
    if (options.seeds.takes(key, value)) continue;
    if (key == "--threads")
      options.threads = std::atoi(value().c_str());
    else if (key == "--limit")
      options.limit = std::atoi(value().c_str());
    else if (key == "--open")
      options.open.insert(value());
    else if (key == "--keep")
      options.keep = value();
    else if (key == "--write")
      return std::printf("%s\n", make_mechanism(std::strtoull(value().c_str(), nullptr, 10)).dump(1).c_str()),
             0;
    else if (key == "--check")
      check = true;
    else if (check)
      files.push_back(key);
    else
      return std::fprintf(stderr, "unknown option %s\n", argv[i]), 2;
  }
  shared = new (shared_memory(sizeof(Shared))) Shared;
  if (check) return check_files(files, options);
  const auto start = Clock::now();
  const long crashes = run_all(options);
  print_table(options, std::chrono::duration<double>(Clock::now() - start).count(), crashes);
  return shared->found > 0 || crashes > 0;
}
