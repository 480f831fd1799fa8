#include "scenes/accuracy/method_study.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/world/diagnostics.h"
#include "scenes/builders/scene.h"
#include "scenes/recording/gap_meter.h"
#include "scenes/support/format.h"
#include "scenes/support/printable.h"
#include "solvers/common/setting_checks.h"
#include "solvers/common/stopwatch.h"
#include "solvers/simulator/simulator.h"

namespace taut {
namespace {

constexpr int kSamples = 100;
/// Relative energies beyond this are no motion of the mechanism any more.
constexpr double kRunaway = 1e3;

struct Mechanism {
  const char* label;
  const char* scene;
  int n;
};
constexpr Mechanism kMechanisms[] = {
    {"double pendulum", "pendulum-ball", 2}, {"chain of ten", "chain", 10}, {"closed loop", "n-four-bar", 2}};

MethodRun run(const Mechanism& mechanism, const Method& method, double dt, double duration) {
  MethodRun result;
  result.mechanism = mechanism.label;
  result.method = method.name;
  result.dt = dt;
  Scene scene = build_scene(mechanism.scene, {{"n", double(mechanism.n)}});
  if (const auto conflicts = setting_conflicts(method.settings, scene.world); !conflicts.empty()) {
    result.failed = conflicts.front().reason;
    return result;
  }
  Simulator simulator(scene.world, method.settings);
  GapMeter meter(scene.world);
  const double start = total_energy(scene.world, scene.world.state());
  const auto steps = static_cast<long>(std::lround(duration / dt)), stride = std::max(1L, steps / kSamples);
  double wall = 0;
  for (long i = 1; i <= steps; ++i) {
    {
      const Stopwatch watch(wall);
      if (!simulator.step(dt).exact()) result.failed = simulator.report().message;
    }
    if (!result.failed.empty()) break;
    const Gap gap = meter.largest(scene.world);
    const double open = std::max(gap.metres, gap.radians);
    result.energy_end = (total_energy(scene.world, scene.world.state()) - start) / scene.energy_scale;
    result.max_gap = std::max(result.max_gap, open);
    result.max_drift = std::max(result.max_drift, std::abs(result.energy_end));
    if (i % stride == 0) result.samples.push_back({scene.world.time(), open, result.energy_end});
    if (!(result.max_drift < kRunaway)) result.failed = "ran away";
  }
  result.wall_time = wall / std::max(scene.world.time(), dt);
  return result;
}

}  // namespace

std::vector<Method> compared_methods() {
  std::vector<Method> methods;
  const auto add = [&](std::string name, auto&& change) {
    Settings settings;
    settings.tension = TensionPolicy::kIgnore;  // one step is one step
    settings.max_rotation = 10;
    change(settings);
    methods.push_back({std::move(name), settings});
  };
  const auto force = [&](std::string name, Integrator integrator, DriftCure cure, double erp, double cfm) {
    add(std::move(name), [=](Settings& s) {
      s.integrator = integrator;
      s.drift_cure = cure;
      s.erp = erp;
      s.cfm = cfm;
    });
  };
  using enum DriftCure;
  force("force level, Euler", Integrator::kForceEuler, kNone, 0, 0);
  force("force level, Euler, Baumgarte 0.8", Integrator::kForceEuler, kBaumgarte, 0.8, 0);
  force("force level, Euler, Baumgarte 0.8 and CFM 1e-4", Integrator::kForceEuler, kBaumgarte, 0.8, 1e-4);
  force("force level, Euler, velocity impulse", Integrator::kForceEuler, kVelocityImpulse, 0.8, 0);
  force("force level, Euler, position push", Integrator::kForceEuler, kPositionPush, 0.8, 0);
  force("penalty springs, Euler", Integrator::kForceEuler, kPenalty, 0.8, 0);
  force("force level, Runge-Kutta", Integrator::kForceRungeKutta, kNone, 0, 0);
  force("force level, Runge-Kutta, position push", Integrator::kForceRungeKutta, kPositionPush, 0.8, 0);
  const auto iterative = [&](std::string name, Solver solver, int iterations, double relaxation = 1) {
    add(std::move(name), [=](Settings& s) {
      s.solver = solver;
      s.iterations = iterations;
      s.relaxation = relaxation;
    });
  };
  iterative("Gauss-Seidel impulses, 10 sweeps", Solver::kGaussSeidel, 10);
  iterative("Gauss-Seidel impulses, 50 sweeps, SOR 1.5", Solver::kGaussSeidel, 50, 1.5);
  iterative("pairwise impulses, 10 a joint", Solver::kPairwise, 10);
  iterative("pairwise impulses, 50 a joint", Solver::kPairwise, 50);
  add("recursion, Runge-Kutta", [](Settings& s) { s.integrator = Integrator::kRecursive; });
  add("recursion, midpoint", [](Settings& s) { s.integrator = Integrator::kRecursiveMidpoint; });
  add("Lagrange, Runge-Kutta", [](Settings& s) { s.integrator = Integrator::kLagrangian; });
  add("RATTLE", [](Settings&) {});
  add("RATTLE of order 4", [](Settings& s) { s.integrator = Integrator::kRattle4; });
  return methods;
}

std::vector<MethodRun> run_methods(double dt, double duration) {
  std::vector<MethodRun> runs;
  for (const Mechanism& mechanism : kMechanisms)
    for (const Method& method : compared_methods()) runs.push_back(run(mechanism, method, dt, duration));
  return runs;
}

std::string methods_table(const std::vector<MethodRun>& runs) {
  std::string text =
      "| mechanism | method | largest joint error [m or rad] | largest energy error | energy error at the "
      "end | "
      "s per simulated s | |\n|---|---|---|---|---|---|---|\n";
  for (const MethodRun& r : runs)
    text += "| " + r.mechanism + " | " + r.method +
            format(" | %.1e | %.1e | %+.1e | %.2g | ", r.max_gap, r.max_drift, r.energy_end, r.wall_time) +
            r.failed + " |\n";
  return text;
}

std::string methods_csv(const std::vector<MethodRun>& runs) {
  std::string text = "mechanism,method,time_s,joint_error,energy_error\n";
  for (const MethodRun& r : runs)
    for (const MethodRun::Sample& s : r.samples)
      text += r.mechanism + ",\"" + r.method + '"' + format(",%.6g,%.6g,%.6g\n", s.time, s.gap, s.energy);
  return text;
}

std::string methods_plots(const std::vector<MethodRun>& runs, const std::string& folder) {
  std::string script =
      "set terminal svg size 1100,760 dynamic background rgb 'white'\nunset logscale\nset format '%g'\nset "
      "grid\nset key at screen 0.99, screen 0.95 right top\nset rmargin at screen 0.66\nset logscale y\nset "
      "format y '%.0e'\n";
  std::map<std::string, std::string> gaps, energies;
  int index = 0;
  for (const MethodRun& r : runs) {
    script += format("$M%d << EOD\n", index);
    for (const MethodRun::Sample& s : r.samples)
      script +=
          format("%.6g %.6g %.6g\n", s.time, std::max(s.gap, 1e-16), std::max(std::abs(s.energy), 1e-16));
    script += "EOD\n";
    const auto curve = [&](std::string& plot, int column, const char* title) {
      plot +=
          (plot.empty() ? "plot " : ", ") + format("$M%d using 1:%d with lines lw 1.5 lt %d dt %d %s", index,
                                                   column, index % 16 + 1, index / 6 % 3 + 1, title);
    };
    curve(gaps[r.mechanism], 2, "notitle");
    curve(energies[r.mechanism], 3, ("title '" + r.method + "'").c_str());
    ++index;
  }
  for (const auto& [mechanism, plot] : gaps) {
    std::string file = mechanism;
    std::replace(file.begin(), file.end(), ' ', '-');
    script += "set output " + gnuplot_quoted(folder + "/methods-" + file + ".svg") +
              "\nset multiplot layout 2,1 title " + gnuplot_quoted(mechanism) +
              "\nset xlabel 'time [s]'\nset ylabel 'joint error [m or rad]'\n" + plot +
              "\nset ylabel '|energy error|, relative'\n" + energies[mechanism] + "\nunset multiplot\n";
  }
  return script;
}

}  // namespace taut
