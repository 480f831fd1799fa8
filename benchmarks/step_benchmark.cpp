// A whole step of the simulator against the bare numeric factorisation of the matrix that it factors, and how
// the step grows with the scene.  Step and factorisations take turns within one benchmark, so that a busy
// machine slows each of them alike.  In its turn each is done twice and the second counts, since the first
// has to fetch its data from where the others have driven it out of the caches, as no simulation or
// factorisation in a loop of its own has.  Times are medians of thread CPU time unless a counter says wall.
// Everything runs on one thread.  (benchmarks/README)
#include <benchmark/benchmark.h>
#include <omp.h>
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "benchmarks/block_problem.h"
#include "benchmarks/timing.h"
#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"
#include "solvers/system/constraint_system.h"

namespace {

using namespace taut;
using namespace taut::benchmarks;

constexpr double kStep = 1e-3;  ///< [s]
constexpr int kWarmUp = 4;

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

template <typename Function>
double wall_seconds_of(Function&& function) {
  const double start = wall_seconds();
  function();
  return wall_seconds() - start;
}

/// CPU time of the second of two calls.
template <typename Function>
double second_time(Function&& function) {
  function();
  return cpu_seconds_of(function);
}

/// A scene after a few steps from its start, and the reports of the steps taken since.
class Run {
 public:
  Run(const std::string& scene, int n, FactorChoice factor)
      : scene_(build_scene(scene, {{"n", n}})), simulator_(scene_.world, with(factor)) {
    for (int i = 0; i < kWarmUp && ok_; ++i) ok_ = simulator_.step(kStep).exact();
  }

  void pass_by() { ok_ = simulator_.step(kStep).exact() && ok_; }  ///< a step that does not count
  void step() {
    times_.push_back(cpu_seconds_of([&] { ok_ = simulator_.step(kStep).exact() && ok_; }));
    const StepReport& report = simulator_.report();
    const StageTimes& t = report.times;
    substeps_ += report.substeps;
    substep_times_.push_back(times_.back() / std::max(1, report.substeps));
    factorizations_ += report.counts.factorizations;
    backsolves_ += report.counts.backsolves;
    forces_ += t.forces, positions_ += t.positions, assembly_ += t.assembly;
    factorization_ += t.factorization, velocities_ += t.velocities, total_ += t.total;
  }

  bool ok() const { return ok_; }
  double last() const { return times_.back(); }
  double substeps() const { return static_cast<double>(substeps_) / count(); }
  /// Median time of one sub-step [s].
  double substep_time() const { return median(substep_times_); }
  int bodies() const { return scene_.world.moving_body_count(); }
  const World& world() const { return scene_.world; }

  void count_work(benchmark::State& state) const {
    state.counters["substeps"] = substeps();
    state.counters["factorizations"] = static_cast<double>(factorizations_) / count();
    state.counters["backsolves"] = static_cast<double>(backsolves_) / count();
  }
  /// Shares of the stages in the wall time of all steps; what is left over is the proof of quality.
  void count_stages(benchmark::State& state) const {
    const std::pair<const char*, double> stages[] = {{"forces", forces_},
                                                     {"positions", positions_},
                                                     {"assembly", assembly_},
                                                     {"factorization", factorization_},
                                                     {"velocities", velocities_}};
    double rest = total_;
    for (const auto& [name, seconds] : stages) {
      state.counters[std::string("share_") + name] = seconds / total_;
      rest -= seconds;
    }
    state.counters["share_rest"] = rest / total_;
  }

 private:
  Settings with(FactorChoice factor) const {
    Settings settings = scene_.settings;
    settings.factor = factor;
    return settings;
  }
  double count() const { return static_cast<double>(times_.size()); }

  Scene scene_;
  Simulator simulator_;
  bool ok_ = true;
  std::vector<double> times_, substep_times_;
  int substeps_ = 0, factorizations_ = 0, backsolves_ = 0;
  double forces_ = 0, positions_ = 0, assembly_ = 0, factorization_ = 0, velocities_ = 0, total_ = 0;
};

/// The matrix that a step of this world factors, in the order of elimination, lower triangle.
ConstraintSystem factored_system(const World& world) {
  ConstraintSystem system(world, FactorChoice::kSupernodal);
  system.linearize(world.state().poses);
  system.set_mass(world.state().poses);
  StageTimes times;
  system.factorize(times);
  return system;
}

void whole_step(benchmark::State& state, const std::string& scene, int n, FactorChoice factor, double limit) {
  Run run(scene, n, factor);
  const ConstraintSystem system = factored_system(run.world());
  BareCholmod supernodal(system.matrix(), true), simplicial(system.matrix(), false);
  omp_set_max_active_levels(0);  // the better of CHOLMOD's two faces, see OpenMpTrap
  std::vector<double> super, simple;
  for (auto _ : state) {
    run.pass_by();
    run.step();
    state.SetIterationTime(run.last());
    super.push_back(second_time([&] { supernodal.factorize(); }));
    simple.push_back(second_time([&] { simplicial.factorize(); }));
  }
  if (!run.ok()) return state.SkipWithError("a step failed");
  const bool net = scene.starts_with("net");
  const double bare = net ? std::min(median(super), median(simple)) : median(simple);
  state.counters["rows"] = system.row_count();
  state.counters["step_ms"] = 1e3 * run.substep_time();
  state.counters["bare_supernodal_ms"] = 1e3 * median(super);
  state.counters["bare_simplicial_ms"] = 1e3 * median(simple);
  state.counters["bare_ms"] = 1e3 * bare;
  state.counters["ratio"] = run.substep_time() / bare;
  state.counters["limit"] = limit;
  run.count_work(state);
  run.count_stages(state);
}

/// Time per body and sub-step.  Long chains need so many steps: at first Newton's method takes one more, and
/// after 11 ms the tension at the pin of 100,000 links, which grows with the mass that it pulls, asks for two
/// sub-steps.  300,000 tell whether what grows from 10,000 to 100,000, which no longer fit the caches, grows
/// on.
void linear(benchmark::State& state) {
  Run run("chain", static_cast<int>(state.range(0)), FactorChoice::kAuto);
  for (auto _ : state) {
    run.step();
    state.SetIterationTime(run.last());
  }
  if (!run.ok()) return state.SkipWithError("a step failed");
  state.counters["step_ms"] = 1e3 * run.substep_time();
  state.counters["us_per_body"] = 1e6 * run.substep_time() / run.bodies();
  run.count_work(state);
}

/// CHOLMOD as it comes, and with nested parallel regions shut off as CholmodFactor does it.  Wall time, since
/// the threads of a region are what is measured.
void openmp_trap(benchmark::State& state) {
  const Run run("net-corners", static_cast<int>(state.range(0)), FactorChoice::kSupernodal);
  ConstraintSystem system = factored_system(run.world());
  BareCholmod cholmod(system.matrix(), true);
  std::vector<double> as_it_comes, without_threads, own;
  for (auto _ : state) {
    omp_set_max_active_levels(1);
    as_it_comes.push_back(wall_seconds_of([&] { cholmod.factorize(); }));
    StageTimes times;  // CholmodFactor under the same default
    system.factorize(times);
    own.push_back(times.factorization);
    omp_set_max_active_levels(0);
    without_threads.push_back(wall_seconds_of([&] { cholmod.factorize(); }));
    state.SetIterationTime(as_it_comes.back());
  }
  state.counters["threads_wall_ms"] = 1e3 * median(as_it_comes);
  state.counters["no_threads_wall_ms"] = 1e3 * median(without_threads);
  state.counters["cholmod_factor_wall_ms"] = 1e3 * median(own);
  state.counters["ratio"] = median(as_it_comes) / median(without_threads);
}

/// Peak of the whole process: run it alone, as --benchmark_filter=Memory.
void memory(benchmark::State& state) {
  Run run("net-corners", static_cast<int>(state.range(0)), FactorChoice::kAuto);
  for (auto _ : state) {
    run.step();
    state.SetIterationTime(run.last());
  }
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const double megabytes = static_cast<double>(usage.ru_maxrss) / 1024;
  state.counters["MB"] = megabytes;
  state.counters["limit"] = 4096;
  if (!run.ok()) return state.SkipWithError("a step failed");
  if (megabytes >= 4096) state.SkipWithError("too much memory");
}

void stages(benchmark::State& state, const std::string& scene, int n) {
  Run run(scene, n, FactorChoice::kAuto);
  for (auto _ : state) {
    run.step();
    state.SetIterationTime(run.last());
  }
  if (!run.ok()) return state.SkipWithError("a step failed");
  run.count_work(state);
  run.count_stages(state);
}

struct Case {
  const char* scene;
  int n, steps;
  double limit;  ///< of step / bare factorisation
};
constexpr Case kCases[] = {{"chain", 1000, 60, 6},        {"chain", 10000, 20, 6},
                           {"bridge-hinge", 1000, 60, 6}, {"net-corners", 40, 30, 1.6},
                           {"net-corners", 80, 10, 1.4},  {"net-corners", 160, 4, 1.3}};
constexpr std::pair<FactorChoice, const char*> kFactors[] = {{FactorChoice::kAuto, "auto"},
                                                             {FactorChoice::kMultifrontal, "multifrontal"},
                                                             {FactorChoice::kSupernodal, "supernodal"},
                                                             {FactorChoice::kSimplicial, "simplicial"}};

// First of all, while the peak of the process is its own.
BENCHMARK(memory)
    ->Name("Memory/net-corners")
    ->Arg(160)
    ->Iterations(3)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

const bool registered = [] {
  for (const Case& c : kCases) {
    const std::string size = std::string(c.scene) + "/" + std::to_string(c.n);
    for (const auto& [factor, name] : kFactors) {
      if (factor == FactorChoice::kSimplicial && c.limit < 6) continue;  // far behind on nets
      const FactorChoice choice = factor;
      benchmark::RegisterBenchmark(
          ("WholeStep/" + size + "/" + name).c_str(),
          [c, choice](benchmark::State& state) { whole_step(state, c.scene, c.n, choice, c.limit); })
          ->Iterations(c.steps)
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  }
  for (const auto& [scene, n, steps] : {std::tuple{"chain", 1000, 60}, std::tuple{"bridge-hinge", 1000, 60},
                                        std::tuple{"bridge-balls", 200, 60}, std::tuple{"net-flag", 20, 60},
                                        std::tuple{"net-corners", 40, 30}, std::tuple{"joint-grid", 40, 10}})
    benchmark::RegisterBenchmark(
        ("Stages/" + std::string(scene) + "/" + std::to_string(n)).c_str(),
        [scene = std::string(scene), n = n](benchmark::State& state) { stages(state, scene, n); })
        ->Iterations(steps)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  return true;
}();

BENCHMARK(linear)
    ->Name("Linear/chain")
    ->Arg(100)
    ->Iterations(400)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(linear)
    ->Name("Linear/chain")
    ->Arg(1000)
    ->Iterations(100)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(linear)
    ->Name("Linear/chain")
    ->Arg(10000)
    ->Iterations(20)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(linear)
    ->Name("Linear/chain")
    ->Arg(100000)
    ->Iterations(24)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(linear)
    ->Name("Linear/chain")
    ->Arg(300000)
    ->Iterations(12)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(openmp_trap)
    ->Name("OpenMpTrap/net-corners")
    ->Arg(80)
    ->Iterations(10)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
