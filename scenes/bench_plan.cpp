#include "scenes/bench_plan.h"

#include <algorithm>

namespace taut {
namespace {

struct SceneSize {
  const char* scene;
  int n;
  bool truck;
  double time;  ///< simulated [s]; 0: the scene's own
};

struct EngineMethod {
  const char* engine;
  const char* method;
  std::vector<double> rates;
};

// Sizes of the full run.  Times of large scenes are cut: what counts is the time per simulated second.
const std::vector<SceneSize> kFull = {
    {"pendulum-ball", 1, false, 0},
    {"pendulum-ball", 2, false, 0},
    {"pendulum-hinge", 2, false, 0},
    {"chain", 10, false, 0},
    {"chain", 100, false, 2},
    {"chain", 1000, false, 0.5},
    {"chain-heavy", 10, false, 0},
    {"chain-heavy", 100, false, 2},
    {"chain-heavy", 1000, false, 0.5},
    {"bridge-hinge", 10, false, 0},
    {"bridge-hinge", 50, false, 2},
    {"bridge-hinge", 200, false, 0.5},
    {"bridge-hinge", 1000, false, 0.25},
    {"bridge-hinge", 50, true, 2},
    {"bridge-hinge", 200, true, 0.5},
    {"bridge-balls", 10, false, 0},
    {"bridge-balls", 50, false, 2},
    {"bridge-balls", 200, false, 0.5},
    {"bridge-balls", 50, true, 2},
    {"bridge-balls", 200, true, 0.5},
    {"net-flag", 5, false, 0},
    {"net-flag", 10, false, 2},
    {"net-flag", 20, false, 0.5},
    {"net-flag", 40, false, 0.25},
    {"net-corners", 5, false, 0},
    {"net-corners", 10, false, 2},
    {"net-corners", 20, false, 0.5},
    {"net-corners", 40, false, 0.25},
};
const std::vector<SceneSize> kQuick = {
    {"pendulum-ball", 2, false, 2},  {"chain", 10, false, 1},        {"chain", 100, false, 0.5},
    {"bridge-hinge", 10, false, 1},  {"bridge-balls", 10, false, 1}, {"net-flag", 5, false, 1},
    {"net-corners", 10, false, 0.5},
};

// The settings that served each engine best on these scenes, and its plain ones.  60 Hz is the step of most
// games; what it costs in joint error and energy stands beside the time.
const std::vector<EngineMethod> kMethods = {
    {"taut", "rattle", {60, 240, 1000}},
    {"taut", "implicit", {60, 240}},
    {"taut", "fixed", {60, 240}},
    {"ode", "step:erp=0.8", {60, 240, 1000, 4000}},
    {"ode", "quick:iters=20,erp=0.8", {240}},
    {"ode", "quick:iters=100,erp=0.8", {4000}},
    {"bullet", "si:iters=10", {60, 240, 1000, 4000}},
    {"bullet", "mlcp:erp=0.8", {240}},
    {"bullet", "featherstone:rk4=1", {1000}},
    {"bullet", "featherstone", {4000}},
    {"mujoco", "newton:stiff=1", {240, 1000}},
    {"mujoco", "newton:free=1,stiff=1", {60, 240, 1000}},
    {"mujoco", "cg:stiff=1", {60, 240, 1000, 4000}},
    {"simbody", "rkm:acc=1e-3", {240}},
    {"simbody", "rkm:acc=1e-6", {240}},
    {"dart", "tree", {60, 240, 1000}},
    {"dart", "free", {240}},
    {"siconos", "moreau", {60, 240, 1000, 4000}},
    {"siconos", "moreau:blocks=0", {1000, 4000}},
    {"siconos", "projection", {240, 1000}},
};
const std::vector<EngineMethod> kQuickMethods = {
    {"taut", "rattle", {240}},
    {"ode", "step:erp=0.8", {240}},
    {"ode", "quick:iters=20,erp=0.8", {240}},
    {"bullet", "si:iters=10", {240}},
    {"bullet", "featherstone:rk4=1", {1000}},
    {"mujoco", "newton:stiff=1", {240}},
    {"mujoco", "newton:free=1,stiff=1", {240}},
    {"simbody", "rkm:acc=1e-3", {240}},
    {"dart", "tree", {240}},
    {"siconos", "moreau", {240}},
};

constexpr double kFullLimit = 20, kQuickLimit = 1;  ///< [s]

}  // namespace

std::string BenchRun::scene_label() const { return WorkRun{scene, n, truck}.label(); }

std::string WorkRun::label() const { return scene + ' ' + std::to_string(n) + (truck ? " truck" : ""); }

std::string BenchRun::engine_label() const {
  return engine + ' ' + method + ", " + std::to_string(static_cast<int>(rate)) + " Hz";
}

BenchRun reference_of(const BenchRun& run) {
  BenchRun reference = run;
  reference.engine = "taut";
  reference.method = "rattle4:tol=1e-12";
  reference.rate = 4000;
  reference.time = 0.5;
  return reference;
}

std::vector<BenchRun> bench_plan(bool quick, const std::vector<std::string>& engines) {
  std::vector<BenchRun> plan;
  for (const SceneSize& s : quick ? kQuick : kFull)
    for (const EngineMethod& m : quick ? kQuickMethods : kMethods)
      for (double rate : m.rates)
        if (std::find(engines.begin(), engines.end(), m.engine) != engines.end())
          plan.push_back(
              {s.scene, s.n, s.truck, m.engine, m.method, rate, s.time, quick ? kQuickLimit : kFullLimit});
  return plan;
}

std::vector<WorkRun> work_plan(WorkSizes sizes) {
  if (sizes == WorkSizes::kTwo) return {{"chain", 1000}, {"net-corners", 20}};
  if (sizes == WorkSizes::kSome)
    return {{"chain", 1000},       {"chain", 10000},    {"bridge-hinge", 1000},
            {"bridge-balls", 200}, {"net-flag", 40},    {"net-corners", 20},
            {"net-corners", 40},   {"net-corners", 80}, {"joint-grid", 40}};
  const std::vector<std::pair<const char*, std::vector<int>>> families = {
      {"chain", {10, 100, 1000, 10000, 100000}}, {"chain-heavy", {10, 100, 1000, 10000}},
      {"bridge-hinge", {10, 50, 200, 1000}},     {"bridge-balls", {10, 50, 200, 1000}},
      {"net-flag", {5, 10, 20, 40, 80}},         {"net-corners", {5, 10, 20, 40, 80, 160}},
      {"joint-grid", {10, 20, 40, 80}}};
  std::vector<WorkRun> plan;
  for (const auto& [scene, numbers] : families) {
    const bool bridge = std::string(scene).starts_with("bridge");
    for (const bool truck : {false, true})
      for (const int n : numbers)
        if (!truck || bridge) plan.push_back({scene, n, truck});
  }
  return plan;
}

double longest_time(const std::vector<BenchRun>& plan) {
  double time = 0;
  for (const BenchRun& run : plan) time += run.limit;
  return time;
}

}  // namespace taut
