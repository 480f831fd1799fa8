// Time of a step of a net with Coulomb friction in every joint beside that of the same net without.  Steps
// take turns in one loop; times are medians of thread CPU time.  (benchmarks/README)
#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <vector>

#include "benchmarks/timing.h"
#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"

namespace {

using namespace taut;
using namespace taut::benchmarks;

constexpr double kStep = 1.0 / 240;  ///< [s]

struct Case {
  int n;
  double friction;  ///< [N m]
  double duration;  ///< [s]
};

void friction(benchmark::State& state, const Case& c) {
  Scene rubbing = build_scene("net-friction", {{"n", c.n}, {"friction", c.friction}});
  Scene free = build_scene("net-corners", {{"n", c.n}});
  Simulator with(rubbing.world, rubbing.settings), without(free.world, free.settings);
  std::vector<double> times, free_times;
  double factorizations = 0, backsolves = 0, substeps = 0, free_substeps = 0, residual = 0, gap = 0;
  for (auto _ : state) {
    times.push_back(cpu_seconds_of([&] { with.step(kStep); }));
    free_times.push_back(cpu_seconds_of([&] { without.step(kStep); }));
    state.SetIterationTime(times.back());
    const StepReport& report = with.report();
    if (!report.exact()) return state.SkipWithError(report.message.c_str());
    if (!without.report().exact()) return state.SkipWithError(without.report().message.c_str());
    factorizations += report.counts.factorizations, backsolves += report.counts.backsolves;
    substeps += report.substeps, free_substeps += without.report().substeps;
    residual = std::max(residual, report.complementarity_residual);
    gap = std::max(gap, report.gap.metres);
  }
  const double steps = static_cast<double>(times.size());
  const auto late = [](std::vector<double> values) {
    return median({values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end()});
  };
  state.counters["step_ms"] = 1e3 * median(times);
  state.counters["free_ms"] = 1e3 * median(free_times);
  state.counters["ratio"] = median(times) / median(free_times);
  state.counters["late_ratio"] = late(times) / late(free_times);
  state.counters["factorizations"] = factorizations / steps;
  state.counters["backsolves"] = backsolves / steps;
  state.counters["substeps"] = substeps / steps;
  state.counters["free_substeps"] = free_substeps / steps;
  state.counters["residual"] = residual;
  state.counters["gap_m"] = gap;
}

constexpr Case kCases[] = {{12, 0.1, 1.5}, {12, 1, 1.5}, {20, 1, 1}, {20, 3, 1}, {40, 3, 0.2}};

const bool registered = [] {
  for (const Case& c : kCases)
    benchmark::RegisterBenchmark(
        ("Friction/" + std::to_string(c.n) + "/mNm:" + std::to_string(static_cast<int>(1e3 * c.friction)))
            .c_str(),
        [c](benchmark::State& state) { friction(state, c); })
        ->Iterations(static_cast<int>(c.duration / kStep + 0.5))
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
