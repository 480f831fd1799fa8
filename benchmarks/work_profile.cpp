// Where the work of a step goes, for one scene: fill and operations of the factor, its time beside that of a
// bare CHOLMOD, its rate beside that of DGEMM, time of a step and of its stages, joints, energy, memory.
// Prints one JSON object.  One thread and processor times, but for the gain of two threads.
#include <omp.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include "benchmarks/block_problem.h"
#include "benchmarks/one_blas_thread.h"
#include "benchmarks/timing.h"
#include "core/base/thread_pool.h"
#include "core/world/diagnostics.h"
#include "scenes/builders/scene.h"
#include "solvers/common/setting_checks.h"
#include "solvers/common/setting_names.h"
#include "solvers/linear/block_ordering.h"
#include "solvers/linear/multifrontal_factor.h"
#include "solvers/simulator/simulator.h"
#include "solvers/system/constraint_system.h"
#include "solvers/system/delassus_matrix.h"

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

void linearize(ConstraintSystem& system, const World& world) {
  if (system.uses_primal_system())
    throw std::invalid_argument("its bodies are factored instead of its joints");
  system.linearize(world.state());
  system.set_mass(world.state().poses);
}

/// Medians of the time of the wall of a factorisation by one thread over that by two, in turns; nothing where
/// the machine has one.
Json gain_of_two(const SymmetricMatrix& S, MultifrontalFactor& alone) {
  constexpr int kTimes = 9;
  if (std::thread::hardware_concurrency() < 2) return {};
  detail::LazyPool pool(2);
  MultifrontalFactor shared(&pool);
  shared.analyze(S);
  (void)shared.factorize(S);
  const auto seconds_of = [&](MultifrontalFactor& factor) {
    const double start = benchmarks::cpu_seconds(CLOCK_MONOTONIC);
    (void)factor.factorize(S);
    return benchmarks::cpu_seconds(CLOCK_MONOTONIC) - start;
  };
  std::vector<double> one, two;
  for (int i = 0; i < kTimes; ++i) {
    one.push_back(seconds_of(alone));
    two.push_back(seconds_of(shared));
  }
  return benchmarks::median(std::move(one)) / benchmarks::median(std::move(two));
}

Json factor_json(const World& world) {
  OrderMemory orders;
  ConstraintSystem system(world, FactorChoice::kMultifrontal, RankTuning::kStepping,
                          Rows::AxisRows::kIncluded, Springs::kLeftOut, {&orders});
  linearize(system, world);
  StageTimes times;
  system.factorize(times);
  MultifrontalFactor factor;
  factor.analyze(system.matrix());
  int failed = -1;
  const double seconds = median_time(9, [&] { failed = factor.factorize(system.matrix()); });
  const Json gain = gain_of_two(system.matrix(), factor);
  Json modelled;
  for (const int threads : {2, 4, 16, 64}) modelled[std::to_string(threads)] = factor.modelled_gain(threads);
  const double rate = dgemm_rate();
  omp_set_max_active_levels(0);  // the better of CHOLMOD's two faces, see step_benchmark
  double bare = std::numeric_limits<double>::infinity();
  for (const bool supernodal : {true, false}) {
    benchmarks::BareCholmod cholmod(system.matrix(), supernodal);
    bare = std::min(bare, median_time(5, [&] { cholmod.factorize(); }));
  }
  return {{"rows", system.row_count()},
          {"order", system.factor().ordering()},
          {"matrix_nonzeros", system.matrix().row_index.size()},
          {"factor_nonzeros", factor.nonzeros()},
          {"factor_flops", factor.flops()},
          {"factor_time_s", seconds},
          {"bare_cholmod_time_s", bare},
          {"factor_usable", failed < 0},
          {"flops_per_s", factor.flops() / seconds},
          {"dgemm_flops_per_s", rate},
          {"share_of_dgemm", factor.flops() / seconds / rate},
          {"gain_of_two_threads", gain},
          {"modelled_gain", modelled}};
}

/// The factor of S in this order, with a shift for scenes whose rows are dependent; the least of many times,
/// which other work on the machine disturbs less than the median.
Json ordered_factor_json(const ConstraintSystem& system, const BlockOrdering& ordering) {
  constexpr int kTimes = 25;
  constexpr double kShift = 1e-6;
  DelassusMatrix S(system.rows(), system.mass(), ordering, SymmetricMatrix::Triangle::kLower);
  S.assemble<InverseMassRoot>(system.rows(), system.jacobian(), system.mass_roots(), kShift);
  MultifrontalFactor factor;
  factor.analyze(S.matrix());
  int failed = -1;
  double seconds = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kTimes; ++i)
    seconds = std::min(seconds, benchmarks::cpu_seconds_of([&] { failed = factor.factorize(S.matrix()); }));
  return {{"order", ordering.method},
          {"factor_flops", factor.flops()},
          {"factor_time_s", seconds},
          {"factor_usable", failed < 0}};
}

/// The joints as the scene adds them, and in `shuffles` random orders: AMD of that numbering, and the order
/// that is chosen, with the time of the search.
Json orders_json(const World& world, int shuffles) {
  ConstraintSystem system(world, FactorChoice::kMultifrontal);
  linearize(system, world);
  const BlockGraph graph = joint_graph(system.rows(), system.mass());
  std::mt19937 random(1);
  std::vector<int> numbering(graph.block_size.size());
  std::iota(numbering.begin(), numbering.end(), 0);
  Json all = Json::array();
  for (int k = 0; k <= shuffles; ++k) {
    if (k > 0) std::shuffle(numbering.begin(), numbering.end(), random);
    const BlockGraph shuffled = renumbered(graph, numbering);
    BlockOrdering plain, chosen;
    const double plain_seconds = benchmarks::cpu_seconds_of([&] { plain = order_blocks(shuffled); });
    const double seconds = benchmarks::cpu_seconds_of([&] { chosen = cheapest_order(shuffled); });
    for (BlockOrdering* ordering : {&plain, &chosen})
      for (int& node : ordering->node_at) node = numbering[node];
    Json entry{{"numbering", k == 0 ? "as added" : "shuffled"}};
    entry["as_numbered"] = ordered_factor_json(system, plain);
    entry["as_numbered"]["order_time_s"] = plain_seconds;
    entry["chosen"] = ordered_factor_json(system, chosen);
    entry["chosen"]["order_time_s"] = seconds;
    all.push_back(entry);
  }
  return all;
}

/// The first `time` seconds of the scene in steps of 1 ms, or what takes no longer than `limit` seconds.
Json motion_json(Scene& scene, double time, double limit) {
  constexpr int kWarmUp = 3;
  Simulator simulator(scene.world);
  const double start = total_energy(scene.world, scene.world.state());
  const double scale = scene.energy_scale > 0 ? scene.energy_scale : std::max(1.0, std::abs(start));
  std::vector<double> steps;
  StageTimes sum;
  long substeps = 0, analyses = 0;
  double gap = 0, angle = 0, drift = 0, spent = 0;
  for (int i = 0; i <= kWarmUp || (i * kStep < time && spent < limit); ++i) {
    steps.push_back(benchmarks::cpu_seconds_of([&] { (void)simulator.step(kStep); }));
    spent += steps.back();
    const StepReport& r = simulator.report();
    if (!r.exact()) return {{"failed", r.message}};
    gap = std::max(gap, r.gap.metres);
    angle = std::max(angle, r.gap.radians);
    drift = std::max(drift, std::abs(total_energy(scene.world, scene.world.state()) - start) / scale);
    analyses += r.counts.analyses;
    if (i < kWarmUp) continue;
    sum += r.times;
    substeps += r.substeps;
  }
  const double count = static_cast<double>(steps.size()), per = 1.0 / static_cast<double>(substeps);
  steps.erase(steps.begin(), steps.begin() + kWarmUp);
  return {{"simulated_time_s", count * kStep},
          {"step_time_s", benchmarks::median(steps)},
          {"substeps_per_step", static_cast<double>(substeps) / static_cast<double>(steps.size())},
          {"analyses", analyses},
          {"max_joint_error_m", gap},
          {"max_joint_angle_error_rad", angle},
          {"energy_drift_rel", drift},
          {"stage_times_per_substep_s",
           {{"forces", sum.forces * per},
            {"positions", sum.positions * per},
            {"assembly", sum.assembly * per},
            {"factorization", sum.factorization * per},
            {"velocities", sum.velocities * per},
            {"total", sum.total * per}}}};
}

/// Median time of a step of the scene by each method for joints that make trees [s]; null where it refuses.
Json methods_json(const std::string& name, const std::map<std::string, double>& parameters, double limit) {
  constexpr int kLeastSteps = 3, kMostSteps = 200;  // the first is not counted
  Json times;
  for (const auto& [method, integrator] : kIntegratorNames) {
    if (integrator != Integrator::kRattle && !is_reduced(integrator)) continue;
    Scene scene = build_scene(name, parameters);
    Json& time = times[method];
    try {
      Simulator simulator(scene.world, {.integrator = integrator, .contacts = false, .threads = 1});
      std::vector<double> steps;
      double spent = 0;
      while (std::ssize(steps) < kLeastSteps || (std::ssize(steps) < kMostSteps && spent < limit)) {
        bool ok = false;
        steps.push_back(benchmarks::cpu_seconds_of([&] { ok = simulator.step(kStep).ok(); }));
        if (!ok) throw std::invalid_argument(simulator.report().message);
        spent += steps.back();
      }
      steps.erase(steps.begin());
      time = benchmarks::median(std::move(steps));
    } catch (const std::invalid_argument&) {
      time = nullptr;
    }
  }
  return times;
}

}  // namespace

int main(int argc, char** argv) {
  benchmarks::use_one_blas_thread(argv);
  CLI::App app("fill, operations, stages and memory of one scene; prints JSON");
  std::string name = "net-corners";
  int n = 10;
  std::string with;
  double time = 0.5, limit = 5;
  int shuffles = 0;
  bool methods = false;
  app.add_option("--scene", name, "a scene of the catalogue");
  app.add_option("--n", n, "its size; 0: it has none");
  app.add_option("--with", with, "a parameter of the scene to be 1");
  app.add_option("--time", time, "time to simulate [s]")->check(CLI::PositiveNumber);
  app.add_option("--limit", limit, "processor time of the steps [s]")->check(CLI::PositiveNumber);
  app.add_option("--shuffles", shuffles,
                 "instead: orders and factors of so many random numberings of joints");
  app.add_flag("--methods", methods, "instead: a step by rattle, by recursion and by Lagrange's equations");
  CLI11_PARSE(app, argc, argv);
  try {
    std::map<std::string, double> parameters;
    if (n > 0) parameters["n"] = n;
    if (!with.empty()) parameters[with] = 1;
    Scene scene = build_scene(name, parameters);
    Json out{{"scene", name}, {"n", n}, {"with", with}, {"bodies", scene.world.moving_body_count()}};
    if (shuffles > 0) {
      out["numberings"] = orders_json(scene.world, shuffles);
      std::cout << out.dump() << std::endl;
      return 0;
    }
    if (methods) {
      out["method_step_times_s"] = methods_json(name, parameters, limit);
      std::cout << out.dump() << std::endl;
      return 0;
    }
    out.update(motion_json(scene, time, limit));
    rusage usage{};  // before what is measured besides
    getrusage(RUSAGE_SELF, &usage);
    out["peak_memory_mb"] = static_cast<double>(usage.ru_maxrss) / 1024;
    out.update(factor_json(build_scene(name, parameters).world));
    std::cout << out.dump() << std::endl;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
