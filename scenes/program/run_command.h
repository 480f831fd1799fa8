#pragma once

#include <array>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenes/builders/scene.h"
#include "scenes/export/exports.h"
#include "scenes/program/live_run.h"
#include "scenes/program/number_options.h"

namespace taut {

/// What the shell gets to see.
enum ExitStatus { kExitSuccess = 0, kExitFailure = 1, kExitUsage = 2, kExitSignal = 128 };

/// What `taut run` is asked for.
struct RunOptions {
  std::string scene;  ///< name of a builder, or a scene file
  std::map<std::string, double> parameters;
  std::optional<double> dt, time;     ///< [s]; the scene's own if not given
  std::optional<std::int64_t> steps;  ///< in place of time
  std::optional<Integrator> integrator;
  std::optional<TensionPolicy> tension;
  std::optional<DriftCure> drift_cure;
  std::optional<FactorChoice> factor;
  std::optional<Solver> solver;
  std::optional<int> iterations;
  std::optional<int> threads;
  std::array<std::optional<double>, std::size(kNumberOptions)> numbers;  ///< as kNumberOptions
  /// Also if the scene does not say so.
  bool sleep = false, merge_fixed_joints = false, locate_plastic_impacts = false;
  std::string report_file, csv_file, poses_file, record_file;  ///< empty: none
  std::string stages_folder;                ///< for the friction problems of its stages; empty: none
  std::string from_file, save_file;         ///< the state to start from, and where it goes to; empty: none
  std::optional<double> poses_interval;     ///< [s]; 0 or not given: every step
  ExportFiles exports;                      ///< made from the recording; its csv is not used
  std::optional<double> frames_per_second;  ///< of the recording, 60 if not given; 0: every step
  LiveOptions live;                         ///< where it can be watched and driven
  bool quiet = false, verbose = false;
  std::string program = "taut";    ///< as it was called, for how_to_see()
  std::vector<std::string> words;  ///< what was typed after `taut run`, for how_to_see(); may be empty
};

/// Runs a scene and writes what was asked for.
/// @returns kExitSuccess, kExitFailure if the run ended early or an output could not be written, or
/// kExitSignal + the signal that stopped it.
/// @throws std::invalid_argument for bad options, before anything is run.
int run_command(const RunOptions& options);

/// Number of steps that the options ask of a scene whose dt is set: round(time / dt).
/// @throws std::invalid_argument for both a time and a number of steps, or values out of range.
std::int64_t step_count(const RunOptions& options, const Scene& scene);

}  // namespace taut
