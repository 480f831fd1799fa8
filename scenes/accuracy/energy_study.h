#pragma once

#include <string>
#include <vector>

namespace taut {

/// Energy of the double pendulum over very many steps, by one integrator.
struct EnergyRun {
  /// Least, mean and largest E − E₀ of as many steps one after the other, relative to the scene's scale.
  struct Window {
    double time, least, mean, most;  ///< [s] at its end
  };
  std::string method;
  double dt = 0;         ///< [s]
  long steps = 0;        ///< that were made
  double wall_time = 0;  ///< [s] in step()
  double max_gap = 0;    ///< [m], over all steps
  std::string failed;    ///< what the step that failed said; empty: none did
  std::vector<Window> windows;

  double largest() const;  ///< |E − E₀|
  /// Slope of the line that fits the means of the windows best, times the time of the run: how far energy has
  /// gone one way.
  double drift() const;
};

/// RATTLE of orders 2 and 4 and Runge–Kutta at force level (with position push) with steps of `dt` [s].
std::vector<EnergyRun> run_energy(long steps, double dt);

/// A Markdown table; windows as CSV; a gnuplot script that draws them into a folder.
std::string energy_table(const std::vector<EnergyRun>& runs);
std::string energy_csv(const std::vector<EnergyRun>& runs);
std::string energy_plots(const std::vector<EnergyRun>& runs, const std::string& folder);

}  // namespace taut
