#include "scenes/accuracy/energy_study.h"

#include <algorithm>
#include <cmath>

#include "core/world/diagnostics.h"
#include "scenes/accuracy/method_study.h"
#include "scenes/builders/scene.h"
#include "scenes/recording/gap_meter.h"
#include "scenes/support/format.h"
#include "scenes/support/printable.h"
#include "solvers/common/stopwatch.h"
#include "solvers/simulator/simulator.h"

namespace taut {
namespace {

constexpr long kWindows = 500;
constexpr const char* kEnergyMethods[] = {"RATTLE", "RATTLE of order 4",
                                          "force level, Runge-Kutta, position push", "recursion, midpoint"};

EnergyRun run(const Method& method, long steps, double dt) {
  EnergyRun result;
  result.method = method.name;
  result.dt = dt;
  Scene scene = build_scene("pendulum-ball", {{"n", 2}});
  Simulator simulator(scene.world, method.settings);
  GapMeter meter(scene.world);
  const double start = total_energy(scene.world, scene.world.state());
  const long width = std::max(1L, steps / kWindows);
  EnergyRun::Window window{};
  for (long i = 0; i < steps; ++i) {
    {
      const Stopwatch watch(result.wall_time);
      if (!simulator.step(dt).exact()) result.failed = simulator.report().message;
    }
    if (!result.failed.empty()) break;
    ++result.steps;
    result.max_gap = std::max(result.max_gap, meter.largest(scene.world).metres);
    const double error = (total_energy(scene.world, scene.world.state()) - start) / scene.energy_scale;
    if (i % width == 0) window = {0, error, 0, error};
    window.least = std::min(window.least, error);
    window.most = std::max(window.most, error);
    window.mean += error / static_cast<double>(width);
    window.time = scene.world.time();
    if (i % width == width - 1) result.windows.push_back(window);
  }
  return result;
}

}  // namespace

double EnergyRun::largest() const {
  double most = 0;
  for (const Window& w : windows) most = std::max({most, std::abs(w.least), std::abs(w.most)});
  return most;
}

double EnergyRun::drift() const {
  double t = 0, e = 0, tt = 0, te = 0;
  const auto n = static_cast<double>(windows.size());
  for (const Window& w : windows) t += w.time / n, e += w.mean / n;
  for (const Window& w : windows) tt += (w.time - t) * (w.time - t), te += (w.time - t) * (w.mean - e);
  return tt > 0 ? te / tt * windows.back().time : 0;
}

std::vector<EnergyRun> run_energy(long steps, double dt) {
  std::vector<EnergyRun> runs;
  for (const Method& method : compared_methods())
    if (std::find(std::begin(kEnergyMethods), std::end(kEnergyMethods), method.name) !=
        std::end(kEnergyMethods))
      runs.push_back(run(method, steps, dt));
  return runs;
}

std::string energy_table(const std::vector<EnergyRun>& runs) {
  std::string text =
      "| method | steps | dt [s] | largest energy error | drift over the run | largest joint error [m] | "
      "time "
      "[s] | |\n|---|---|---|---|---|---|---|---|\n";
  for (const EnergyRun& r : runs)
    text += "| " + r.method +
            format(" | %ld | %g | %.1e | %+.1e | %.1e | %.1f | ", r.steps, r.dt, r.largest(), r.drift(),
                   r.max_gap, r.wall_time) +
            r.failed + " |\n";
  return text;
}

std::string energy_csv(const std::vector<EnergyRun>& runs) {
  std::string text = "method,time_s,least_energy_error,mean_energy_error,largest_energy_error\n";
  for (const EnergyRun& r : runs)
    for (const EnergyRun::Window& w : r.windows)
      text += '"' + r.method + '"' + format(",%.9g,%.6g,%.6g,%.6g\n", w.time, w.least, w.mean, w.most);
  return text;
}

std::string energy_plots(const std::vector<EnergyRun>& runs, const std::string& folder) {
  std::string script =
      "set terminal svg size 900,760 dynamic background rgb 'white'\nunset logscale\nset format '%g'\nset "
      "format y '%.1e'\nset grid\nset key off\nset lmargin 14\nset rmargin 4\nset xlabel 'time [s]'\nset "
      "ylabel "
      "'energy error, relative'\n";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    script += format("$E%zu << EOD\n", i);
    for (const EnergyRun::Window& w : runs[i].windows)
      script += format("%.9g %.6g %.6g %.6g\n", w.time, w.least, w.mean, w.most);
    script += "EOD\n";
  }
  script += "set output " + gnuplot_quoted(folder + "/energy-double-pendulum.svg") + "\n" +
            format("set multiplot layout %zu,1 title 'double pendulum: range and mean of %ld parts'\n",
                   runs.size(), kWindows);
  for (std::size_t i = 0; i < runs.size(); ++i)
    script += "set title '" + runs[i].method +
              format(
                  ", %ld steps of %g ms'\nplot $E%zu using 1:2:4 with filledcurves fs transparent solid 0.3 "
                  "lt %zu, $E%zu using 1:3 with lines lw 1.5 lt %zu\n",
                  runs[i].steps, 1e3 * runs[i].dt, i, i + 1, i, i + 1);
  return script + "unset multiplot\n";
}

}  // namespace taut
