#include "scenes/bench/bench_plan.h"

#include <algorithm>

namespace taut {
namespace {

struct SceneSize {
  const char* scene;
  int n;
  const char* with;  ///< BenchRun::with
  double time;       ///< simulated [s]; 0: the scene's own
  BenchQuality quality = BenchQuality::kJoints;
};

struct EngineMethod {
  const char* engine;
  const char* method;
  std::vector<double> rates;
};

// Sizes of the full run.  Times of large scenes are cut: what counts is the time per simulated second.
const std::vector<SceneSize> kFull = {
    {"pendulum-ball", 1, "", 0},
    {"pendulum-ball", 2, "", 0},
    {"pendulum-hinge", 2, "", 0},
    {"chain", 10, "", 0},
    {"chain", 100, "", 2},
    {"chain", 1000, "", 0.5},
    {"chain-heavy", 10, "", 0},
    {"chain-heavy", 100, "", 2},
    {"chain-heavy", 1000, "", 0.5},
    {"bridge-hinge", 10, "", 0},
    {"bridge-hinge", 50, "", 2},
    {"bridge-hinge", 200, "", 0.5},
    {"bridge-hinge", 1000, "", 0.25},
    {"bridge-hinge", 50, "truck", 2},
    {"bridge-hinge", 200, "truck", 0.5},
    {"bridge-balls", 10, "", 0},
    {"bridge-balls", 50, "", 2},
    {"bridge-balls", 200, "", 0.5},
    {"bridge-balls", 50, "truck", 2},
    {"bridge-balls", 200, "truck", 0.5},
    {"net-flag", 5, "", 0},
    {"net-flag", 10, "", 2},
    {"net-flag", 20, "", 0.5},
    {"net-flag", 40, "", 0.25},
    {"net-corners", 5, "", 0},
    {"net-corners", 10, "", 2},
    {"net-corners", 20, "", 0.5},
    {"net-corners", 40, "", 0.25},
};
const std::vector<SceneSize> kQuick = {
    {"pendulum-ball", 2, "", 2},  {"chain", 10, "", 1},        {"chain", 100, "", 0.5},
    {"bridge-hinge", 10, "", 1},  {"bridge-balls", 10, "", 1}, {"net-flag", 5, "", 1},
    {"net-corners", 10, "", 0.5},
};

const std::vector<SceneSize> kContact = {
    {"stack", 20, "", 5, BenchQuality::kStands},
    {"stack", 20, "top_heavy", 5, BenchQuality::kStands},
    {"card-house", 3, "", 5, BenchQuality::kStands},
    {"wall", 5, "", 5, BenchQuality::kStands},
    {"wall", 10, "", 5, BenchQuality::kStands},
    {"chain-over-cylinder", 24, "", 5, BenchQuality::kStands},
    {"pile", 30, "", 4, BenchQuality::kRests},
    {"pile", 100, "", 4, BenchQuality::kRests},
    {"net-catch", 10, "", 1, BenchQuality::kCarries},
    {"net-catch", 20, "", 0.8, BenchQuality::kCarries},
};
const std::vector<SceneSize> kQuickContact = {{"stack", 10, "", 1, BenchQuality::kStands},
                                              {"stack", 10, "top_heavy", 1, BenchQuality::kStands},
                                              {"pile", 10, "", 2, BenchQuality::kRests},
                                              {"net-catch", 5, "", 0.5, BenchQuality::kCarries}};

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

// Not all engines are given shapes here; these are.
const std::vector<EngineMethod> kContactMethods = {
    {"taut", "rattle", {60, 240, 1000}},
    {"taut", "implicit", {60}},
    {"ode", "step:cfm=1e-7", {240, 1000}},
    {"ode", "step:cfm=1e-7,erp=0.8", {240}},
    {"ode", "quick:iters=20", {240}},
    {"ode", "quick:iters=100", {240, 1000}},
    {"ode", "quick:iters=100,erp=0.8", {1000}},
    {"bullet", "si:iters=10", {60, 240, 1000}},
    {"bullet", "si:iters=100", {240, 1000}},
    {"bullet", "mlcp", {240}},
    {"bullet", "mlcp:erp=0.8", {240}},
    {"mujoco", "newton", {240, 1000}},
    {"mujoco", "newton:stiff=1", {240, 1000}},
    {"mujoco", "newton:free=1,stiff=1", {240, 1000}},
    {"mujoco", "newton:stiff=1,elliptic=1", {1000}},
    {"mujoco", "newton:stiff=1,noslip=10", {1000}},
    {"mujoco", "cg:stiff=1", {240}},
};
const std::vector<EngineMethod> kQuickContactMethods = {
    {"taut", "rattle", {240}},
    {"ode", "quick:iters=100", {240}},
    {"bullet", "si:iters=10", {240}},
    {"mujoco", "newton:stiff=1", {240}},
};

constexpr double kFullLimit = 20, kQuickLimit = 1;  ///< [s]

}  // namespace

std::string BenchRun::scene_label() const { return WorkRun{scene, n, with}.label(); }

std::string WorkRun::label() const {
  return scene + ' ' + std::to_string(n) + (with.empty() ? "" : ' ' + with);
}

std::string BenchRun::engine_label() const {
  return engine + ' ' + method + ", " + std::to_string(static_cast<int>(rate)) + " Hz";
}

std::string name_of(BenchQuality quality) {
  switch (quality) {
    case BenchQuality::kJoints:
      return "joints";
    case BenchQuality::kCarries:
      return "carries";
    case BenchQuality::kRests:
      return "rests";
    case BenchQuality::kStands:
      return "stands";
  }
  return "";
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
  const auto add = [&](const std::vector<SceneSize>& scenes, const std::vector<EngineMethod>& methods) {
    for (const SceneSize& s : scenes)
      for (const EngineMethod& m : methods)
        for (double rate : m.rates)
          if (std::find(engines.begin(), engines.end(), m.engine) != engines.end())
            plan.push_back({s.scene, s.n, s.with, m.engine, m.method, rate, s.time,
                            quick ? kQuickLimit : kFullLimit, s.quality});
  };
  add(quick ? kQuick : kFull, quick ? kQuickMethods : kMethods);
  add(quick ? kQuickContact : kContact, quick ? kQuickContactMethods : kContactMethods);
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
    for (const char* with : {"", "truck"})
      for (const int n : numbers)
        if (!*with || bridge) plan.push_back({scene, n, with});
  }
  return plan;
}

double longest_time(const std::vector<BenchRun>& plan) {
  double time = 0;
  for (const BenchRun& run : plan) time += run.limit;
  return time;
}

}  // namespace taut
