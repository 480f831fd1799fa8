// Where the work of a step goes, for one scene: fill and operations of the factor, its rate beside that of
// DGEMM, time per stage, memory.  Prints one JSON object.  One thread; processor times.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <vector>

#include "benchmarks/timing.h"
#include "scenes/scene.h"
#include "solvers/constraint_system.h"
#include "solvers/multifrontal_factor.h"
#include "solvers/simulator.h"

extern "C" void dgemm_(const char*, const char*, const int*, const int*, const int*, const double*,
                       const double*, const int*, const double*, const int*, const double*, double*,
                       const int*);

namespace {

using namespace taut;
using Json = nlohmann::ordered_json;

constexpr double kStep = 1e-3;  ///< [s]

template <typename Function>
double median_time(int times, Function&& function) {
  std::vector<double> taken;
  for (int i = 0; i < times; ++i) taken.push_back(benchmarks::cpu_seconds_of(function));
  return benchmarks::median(std::move(taken));
}

/// Operations per second of a square product of 1024.
double dgemm_rate() {
  const int n = 1024;
  const double one = 1, zero = 0;
  const std::vector<double> a(n * n, 1.5), b(n * n, 0.5);
  std::vector<double> c(n * n);
  const auto product = [&] {
    dgemm_("N", "N", &n, &n, &n, &one, a.data(), &n, b.data(), &n, &zero, c.data(), &n);
  };
  return 2.0 * n * n * n / median_time(5, product);
}

Json factor_json(const World& world) {
  ConstraintSystem system(world, FactorChoice::kMultifrontal);
  system.linearize(world.state());
  system.set_mass(world.state().poses);
  StageTimes times;
  system.factorize(times);
  MultifrontalFactor factor;
  factor.analyze(system.matrix());
  int failed = -1;
  const double seconds = median_time(9, [&] { failed = factor.factorize(system.matrix()); });
  const double rate = dgemm_rate();
  return {{"rows", system.row_count()},
          {"matrix_nonzeros", system.matrix().row_index.size()},
          {"factor_nonzeros", factor.nonzeros()},
          {"factor_flops", factor.flops()},
          {"factor_time_s", seconds},
          {"factor_usable", failed < 0},
          {"flops_per_s", factor.flops() / seconds},
          {"dgemm_flops_per_s", rate},
          {"share_of_dgemm", factor.flops() / seconds / rate}};
}

Json stages_json(World& world, int steps) {
  Simulator simulator(world);
  StageTimes sum;
  long substeps = 0;
  for (int i = 0; i < steps + 3; ++i) {
    const StepReport& r = simulator.step(kStep);
    if (!r.ok()) return {{"failed", r.message}};
    if (i < 3) continue;
    sum.forces += r.times.forces, sum.positions += r.times.positions, sum.assembly += r.times.assembly;
    sum.factorization += r.times.factorization, sum.velocities += r.times.velocities,
        sum.total += r.times.total;
    substeps += r.substeps;
  }
  const double per = 1.0 / static_cast<double>(substeps);
  return {{"forces", sum.forces * per},         {"positions", sum.positions * per},
          {"assembly", sum.assembly * per},     {"factorization", sum.factorization * per},
          {"velocities", sum.velocities * per}, {"total", sum.total * per}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("fill, operations, stages and memory of one scene; prints JSON");
  std::string name = "net-corners";
  int n = 10, steps = 10;
  app.add_option("--scene", name, "a scene of the catalogue");
  app.add_option("--n", n, "its size");
  app.add_option("--steps", steps, "steps of 1 ms to average the stages over");
  CLI11_PARSE(app, argc, argv);
  try {
    Scene scene = build_scene(name, {{"n", n}});
    Json out{{"scene", name}, {"n", n}, {"bodies", scene.world.moving_body_count()}};
    out.update(factor_json(scene.world));
    out["stage_times_per_substep_s"] = stages_json(scene.world, steps);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    out["peak_memory_mb"] = static_cast<double>(usage.ru_maxrss) / 1024;
    std::cout << out.dump() << std::endl;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
