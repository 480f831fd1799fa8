#pragma once

#include <string>
#include <vector>

#include "solvers/common/settings.h"

namespace taut {

/// A way to solve and integrate joints that the literature compares.
struct Method {
  std::string name;
  Settings settings;
};
/// Force-level solving with every cure for its drift, iterative and pairwise impulses, reduced coordinates,
/// and RATTLE.
std::vector<Method> compared_methods();

/// One mechanism by one method.
struct MethodRun {
  struct Sample {
    double time, gap, energy;  ///< [s], [m or rad] from the poses, E − E₀ relative to the scene's scale
  };
  std::string mechanism, method;
  double dt = 0;         ///< [s]
  double wall_time = 0;  ///< [s] in step() per simulated second
  double max_gap = 0;    ///< [m or rad], over all steps
  double max_drift = 0;  ///< |E − E₀| relative to the scene's scale
  double energy_end = 0;
  std::string failed;  ///< what the step that failed said; empty: none did
  std::vector<Sample> samples;
};

/// The double pendulum, a chain of ten links and a closed loop, by every method, with steps of `dt` for
/// `duration` [s].
std::vector<MethodRun> run_methods(double dt, double duration);

/// A Markdown table; curves as CSV; a gnuplot script that draws gap and energy over time, a picture per
/// mechanism, into a folder.
std::string methods_table(const std::vector<MethodRun>& runs);
std::string methods_csv(const std::vector<MethodRun>& runs);
std::string methods_plots(const std::vector<MethodRun>& runs, const std::string& folder);

}  // namespace taut
