#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenes/accuracy/reference_run.h"

namespace taut {

/// Error of a reference case by one method at several steps.
struct ConvergenceRun {
  struct Point {
    double dt, error, wall_time;  ///< [s]; largest |position − reference| [m] over all times; [s]
    std::string failed;
  };
  std::string id, method;     ///< name of an integrator, or of a solver in place of the factor
  std::vector<Point> points;  ///< from the longest step to the shortest
  /// Slope of log error over log dt at the shortest three steps whose errors are neither large nor round-off;
  /// 0 if fewer than two are.
  double order() const;
};

/// Cases of a folder with positions at given times, by every integrator and by every iterative solver, at 64,
/// 32, …, ¼ of the step that their tolerances are for.  @param ids names of cases; those that are not there
/// are left out.
std::vector<ConvergenceRun> run_convergence(const std::filesystem::path& folder,
                                            const std::vector<std::string>& ids);

std::string convergence_table(const std::vector<ConvergenceRun>& runs);
std::string convergence_csv(const std::vector<ConvergenceRun>& runs);
/// A gnuplot script: error over dt, and error over wall time, one picture per case.
std::string convergence_plots(const std::vector<ConvergenceRun>& runs, const std::string& folder);

}  // namespace taut
