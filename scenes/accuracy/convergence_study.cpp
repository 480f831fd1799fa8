#include "scenes/accuracy/convergence_study.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "scenes/support/format.h"
#include "scenes/support/printable.h"
#include "solvers/common/setting_names.h"

namespace taut {
namespace {

namespace fs = std::filesystem;

constexpr double kFractions[] = {64, 32, 16, 8, 4, 2, 1, 0.5, 0.25};
/// Errors above the first are no small ones, those below the second are round-off or the tolerance to which
/// joints are closed [m].
constexpr double kLarge = 0.03, kRoundOff = 1e-9;
/// Points that an order is taken from.
constexpr int kFitted = 3;

double position_error(const reference::CaseRun& run) {
  double error = -1;
  for (const reference::Measurement& m : run.quantities)
    if (m.time && !m.measured.empty() && m.name.find("position") != std::string::npos)
      error = std::max(error, m.error);
  return error;
}

/// Sweeps of the iterative solvers: enough for joints of the few bodies here, so that the step is what is
/// seen.
constexpr int kSweeps = 100;

/// Every integrator on the factor, and RATTLE's steps with each of the iterative solvers.
std::vector<std::pair<std::string, Settings>> studied_methods() {
  std::vector<std::pair<std::string, Settings>> methods;
  for (const auto& [name, integrator] : kIntegratorNames) {
    methods.push_back({name, {}});
    methods.back().second.integrator = integrator;
  }
  for (const auto& [name, solver] : kSolverNames) {
    if (solver == Solver::kDirect) continue;
    methods.push_back({name, {}});
    methods.back().second.solver = solver;
    methods.back().second.iterations = kSweeps;
  }
  return methods;
}

ConvergenceRun converge(const fs::path& file, const std::string& method, const Settings& settings) {
  ConvergenceRun result{.id = file.stem().string(), .method = method, .points = {}};
  for (double fraction : kFractions) {
    reference::RunPlan plan;
    plan.choose_integrator = false;
    plan.settings = settings;
    plan.settings.tension = TensionPolicy::kIgnore;  // one step is one step
    plan.settings.max_rotation = 10;
    plan.settings.drift_cure = DriftCure::kNone;  // a cure of first order would be all that is seen
    plan.settings.position_tolerance = 1e-12;
    plan.settings.velocity_tolerance = 1e-11;
    plan.step = fraction;
    const reference::CaseRun run = run_case(file, plan);
    result.points.push_back({run.dt, position_error(run), run.wall_time, run.failed});
  }
  return result;
}

}  // namespace

double ConvergenceRun::order() const {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (auto p = points.rbegin(); p != points.rend() && n < kFitted; ++p) {
    if (!p->failed.empty() || !(p->error > kRoundOff && p->error < kLarge)) continue;
    const double a = std::log(p->dt), b = std::log(p->error);
    n += 1, x += a, y += b, xx += a * a, xy += a * b;
  }
  return n < 2 ? 0 : (n * xy - x * y) / (n * xx - x * x);
}

std::vector<ConvergenceRun> run_convergence(const fs::path& folder, const std::vector<std::string>& ids) {
  std::vector<ConvergenceRun> runs;
  for (const std::string& id : ids) {
    const fs::path file = folder / (id + ".json");
    if (!fs::exists(file)) continue;
    for (const auto& [method, settings] : studied_methods()) runs.push_back(converge(file, method, settings));
  }
  return runs;
}

std::string convergence_table(const std::vector<ConvergenceRun>& runs) {
  std::string text = "| case | method | order |";
  for (double fraction : kFractions) text += format(" error at %g dt |", fraction);
  text += "\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const ConvergenceRun& r : runs) {
    text += "| " + r.id + " | " + r.method + (r.order() > 0 ? format(" | %.1f |", r.order()) : " | – |");
    for (const ConvergenceRun::Point& p : r.points)
      text += p.failed.empty() ? format(" %.1e |", p.error) : std::string(" failed |");
    text += '\n';
  }
  return text;
}

std::string convergence_csv(const std::vector<ConvergenceRun>& runs) {
  std::string text = "case,method,dt_s,position_error_m,wall_time_s,failed\n";
  for (const ConvergenceRun& r : runs)
    for (const ConvergenceRun::Point& p : r.points)
      text += r.id + ',' + r.method + format(",%.9g,%.6g,%.4g,", p.dt, p.error, p.wall_time) +
              (p.failed.empty() ? "" : '"' + p.failed + '"') + '\n';
  return text;
}

std::string convergence_plots(const std::vector<ConvergenceRun>& runs, const std::string& folder) {
  std::string script =
      "set terminal svg size 1180,420 dynamic background rgb 'white'\nset grid\nset logscale xy\nset format "
      "'%.0e'\n";
  std::map<std::string, std::string> errors, works;
  std::map<std::string, int> curves;  // of each case
  int index = 0;
  for (const ConvergenceRun& r : runs) {
    std::string points;
    for (const ConvergenceRun::Point& p : r.points)
      if (p.failed.empty() && p.error >= 0)
        points += format("%.9g %.6g %.6g\n", p.dt, std::max(p.error, 1e-16), p.wall_time);
    if (points.empty()) continue;
    script += format("$C%d << EOD\n", index) + points + "EOD\n";
    const int number = curves[r.id]++;
    const auto curve = [&](std::string& plot, const char* columns, const std::string& title) {
      plot += (plot.empty() ? "plot " : ", ") +
              format("$C%d using %s with linespoints pt 7 ps 0.5 lt %d dt %d %s", index, columns,
                     number % 8 + 1, number / 8 + 1, title.c_str());
    };
    curve(errors[r.id], "1:2", "notitle");
    curve(works[r.id], "3:2", "title '" + r.method + "'");
    ++index;
  }
  for (const auto& [id, plot] : errors)
    script += "set output " + gnuplot_quoted(folder + "/convergence-" + id + ".svg") +
              "\nset multiplot layout 1,2 title " + gnuplot_quoted(id) +
              " noenhanced\nset key off\nset xlabel 'dt [s]'\nset ylabel 'position error [m]'\n" + plot +
              "\nset key outside right top\nset xlabel 'time of the run [s]'\n" + works[id] +
              "\nunset multiplot\n";
  return script;
}

}  // namespace taut
