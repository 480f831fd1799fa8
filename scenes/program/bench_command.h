#pragma once

#include <string>
#include <vector>

namespace taut {

/// What `taut bench` was asked for.
struct BenchOptions {
  std::string build_dir;  ///< where the benchmarks were built; empty: beside the program
  std::string only;       ///< scenes and *_benchmark programs with this in their name; empty: all
  std::vector<std::string> arguments;  ///< for the *_benchmark programs; with --friction more files
  bool quick = false;
  bool contact = false;   ///< only scenes with contact
  bool friction = false;  ///< only friction problems, in taut's solver and others
  bool work = false;      ///< only where the work of taut's own steps goes, for all sizes
  std::string results;    ///< folder for JSON, Markdown and plots; empty: bench/ in the build folder
  std::string compare;    ///< JSON of an earlier run
  double limit = 0;       ///< processor time of each run [s]; 0: that of the plan
  double factor = 1.5;    ///< a run of taut that takes so many times as long as then is a regression
};

/// `taut bench`: all scenes in all engines that were built, then every *_benchmark program (not with --quick,
/// --contact, --compare or a scene's name in `only`); with --contact only those with contact; with --work
/// only the scenes in taut alone; with --friction only friction problems.
/// @returns kExitSuccess, or kExitFailure if a run of taut or a program failed, there is nothing to run, a
/// file could not be written, or something has become slower by the factor.
int bench_command(const BenchOptions& options);

}  // namespace taut
