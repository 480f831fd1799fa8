// Time of a step against the number of contacts: walls of bricks that stand, piles of mixed bodies at rest or
// nearly so, and nets draped over bumpy ground with a load on them, which are hardly dragged.  Times are
// medians of the processor time of all threads: contacts are found on all cores. (benchmarks/README)
#include <benchmark/benchmark.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "benchmarks/timing.h"
#include "scenes/builders/scene.h"
#include "scenes/files/state_file.h"
#include "solvers/simulator/simulator.h"

namespace {

using namespace taut;
using namespace taut::benchmarks;

constexpr double kStep = 1.0 / 240;  ///< [s]

struct Case {
  const char* scene;
  int n;
  double settling;  ///< [s]
  int steps;
  bool sleep = false;
  const char* from = nullptr;  ///< a state to settle from, in place of the start
};

std::map<std::string, double> parameters_of(const Case& c) {
  std::map<std::string, double> parameters{{"n", c.n}};
  if (c.scene == std::string("net-drag")) parameters["speed"] = 0.01;
  return parameters;
}

/// Steps of a scene after it has settled, or with `sleep` after it fell asleep besides.
void contacts(benchmark::State& state, const Case& c) {
  Scene scene = build_scene(c.scene, parameters_of(c));
  scene.settings.sleep = c.sleep;
  if (c.from) load_state_file(scene.world, std::string(TAUT_SOURCE_DIR "/benchmarks/states/") + c.from);
  Simulator simulator(scene.world, scene.settings);
  const double settled = scene.world.time() + c.settling;
  while (scene.world.time() < settled)
    if (!simulator.step(kStep).ok()) return state.SkipWithError(simulator.report().message.c_str());
  std::vector<double> times;
  double inexact = 0, points = 0, pivots = 0, newton = 0, analyses = 0, factorizations = 0, residual = 0,
         penetration = 0;
  for (auto _ : state) {
    const double start = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
    const StepReport& report = simulator.step(kStep);
    times.push_back(cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - start);
    state.SetIterationTime(times.back());
    if (!report.ok()) return state.SkipWithError(report.message.c_str());
    inexact += !report.exact();
    points += report.contacts, pivots += report.counts.pivots, newton += report.counts.contact_iterations;
    analyses += report.counts.analyses, factorizations += report.counts.factorizations;
    residual = std::max(residual, report.complementarity_residual);
    penetration = std::max(penetration, report.penetration);
  }
  const double steps = static_cast<double>(times.size());
  state.counters["bodies"] = scene.world.moving_body_count();
  state.counters["asleep"] = scene.world.asleep_count();
  state.counters["contacts"] = points / steps;
  state.counters["step_ms"] = 1e3 * median(times);
  state.counters["us_per_contact"] = points > 0 ? 1e6 * median(times) * steps / points : 0;
  state.counters["pivots"] = pivots / steps;
  state.counters["newton_steps"] = newton / steps;
  state.counters["analyses"] = analyses / steps;
  state.counters["factorizations"] = factorizations / steps;
  state.counters["inexact"] = inexact / steps;
  state.counters["residual"] = residual;
  state.counters["penetration_m"] = penetration;
}

constexpr Case kCases[] = {{"wall", 4, 0.5, 100},
                           {"wall", 8, 0.5, 60},
                           {"wall", 8, 1, 100, true},
                           {"wall", 16, 0.5, 20},
                           {"wall", 32, 0.25, 8},
                           {"wall", 32, 0.7, 100, true},
                           {"pile", 30, 3, 60},
                           {"pile", 100, 4, 40},
                           {"pile", 100, 5, 100, true},
                           {"pile", 300, 1.5, 20},
                           {"pile", 1000, 0.1, 20, false, "pile-1000.json"},
                           {"net-drag", 8, 0.5, 60},
                           {"net-drag", 20, 0.25, 20},
                           {"net-drag", 40, 0.1, 5},
                           {"net-drag", 100, 0.05, 5}};

const bool registered = [] {
  for (const Case& c : kCases)
    benchmark::RegisterBenchmark(
        ("Contacts/" + std::string(c.scene) + "/" + std::to_string(c.n) + (c.sleep ? "/asleep" : "")).c_str(),
        [c](benchmark::State& state) { contacts(state, c); })
        ->Iterations(c.steps)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
